// Scenes that ask the wide path tracer for all that it can do, and for all that it leaves to the scalar closure.
#pragma once
#include "scenes/builtin.h"
#include "tests/render/measure.h"

namespace chiaro::test {

inline PathClasses asked(const char* paths, const char* split, uint32_t maxDepth = unlimitedDepth) {
    return PathClasses::make({.paths = paths, .split = split, .maxDepth = maxDepth, .within = {}, .without = {}});
}
inline SceneDesc builtin(const char* name) { return findBuiltin(name)->make(); }

// All that lanes leave to the scalar closure, and all that they do: textures, normal maps, rough, absorbing and dispersive glass, vertex
// colours, cut-outs, moving and mirrored instances, textured lamps, every punctual light.
inline MaterialDesc plain(const char* name, const Spectrum& color, float roughness) {
    MaterialDesc m;
    m.name = name;
    m.baseColor = color;
    m.metallic = 0;
    m.roughness = roughness;
    return m;
}
inline int chequer(SceneDesc& d, uint8_t alpha) {
    std::vector<uint8_t> texels;
    for (int i = 0; i < 64; ++i) {
        const bool light = (i ^ i >> 3) & 1;
        for (const uint8_t t :
             {uint8_t(light ? 230 : 40), uint8_t(light ? 200 : 90), uint8_t(light ? 120 : 160), light ? uint8_t(255) : alpha})
            texels.push_back(t);
    }
    return addTexture(d, 8, 8, 4, texels);
}
inline SceneDesc everything(bool moves) {
    SceneDesc d;
    const int texture = chequer(d, 0), grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.6f, 0.5f, 0.4f)));
    MaterialDesc textured = plain("textured", Spectrum(0.9f), 0.4f), bumpy = plain("bumpy", Spectrum(0.7f), 0.5f),
                 leaf = shapes::diffuse("leaf", Spectrum(0.8f)), rough = plain("rough glass", Spectrum(0.9f), 0.4f),
                 solid = plain("solid", Spectrum(0.8f, 0.9f, 1), 0), varied = plain("varied", Spectrum(0.5f), 1),
                 sign = shapes::lamp("sign", Spectrum(4)), metal = shapes::metal("metal", Spectrum(0.9f, 0.7f, 0.4f), 0.3f);
    textured.baseColorTexture.texture = leaf.baseColorTexture.texture = bumpy.normalTexture.texture =
        varied.metallicRoughnessTexture.texture = sign.emissionTexture.texture = texture;
    leaf.alphaMode = AlphaMode::mask;
    leaf.doubleSided = true;
    rough.transmission = solid.transmission = 1;
    solid.volume = true;
    solid.attenuationDistance = 0.5f;
    solid.attenuationColor = Spectrum(0.9f, 0.5f, 0.3f);
    rough.volume = true;
    const int ids[] = {shapes::add(d, textured), shapes::add(d, bumpy),  shapes::add(d, leaf), shapes::add(d, rough),
                       shapes::add(d, solid),    shapes::add(d, varied), shapes::add(d, sign), shapes::add(d, metal)};
    shapes::add(d, "room", shapes::insideOut(shapes::box({2, 2, 2})), grey);
    for (int i = 0; i < 8; ++i)
        shapes::add(d, "thing", i % 2 ? shapes::sphere(0.4, 3) : square(0.45), ids[i],
                    shapes::translation({-1.5 + i % 4, i < 4 ? -0.8 : 0.7, -1}));
    PrimitiveDesc coloured = shapes::sphere(0.35, 2);
    for (std::size_t i = 0; i < coloured.positions.size(); ++i) coloured.colors.push_back({i % 2 ? 1.f : 0.2f, 0.5f, 0.9f, 1});
    shapes::add(d, "coloured", std::move(coloured), grey, shapes::translation({1.2, -1.4, 0.3}));
    MaterialDesc flint = plain("flint", Spectrum(1), 0);
    flint.transmission = flint.dispersion = 1;
    flint.volume = true;
    shapes::add(d, "prism", shapes::sphere(0.35, 3), shapes::add(d, flint), shapes::translation({0.4, -1.5, -0.4}));
    const Affine places[] = {shapes::translation({-1.2, -1.5, 0}), shapes::translation({-0.3, -1.6, 0.4}) * scaling(-1, 0.5, 1.5)};
    addInstances(d, shapes::sphere(0.35, 3), ids[7], places);
    addInstances(d, shapes::box({0.2, 0.1, 0.2}), shapes::add(d, shapes::lamp("lamps", Spectrum(3, 2, 1))), places);
    if (moves) {
        d.shutter = {0, 1};
        d.instances.back().motion = {d.instances.back().toWorld, shapes::translation({0.5, 0.3, 0}) * d.instances.back().toWorld};
    }
    for (const PunctualKind kind : {PunctualKind::point, PunctualKind::directional, PunctualKind::spot}) {
        PunctualDesc l;
        l.kind = kind;
        l.intensity = Spectrum(2);
        l.toWorld = shapes::translation({0, 0, 1.5});
        d.lights.push_back(l);
    }
    shapes::addCamera(d, "main", 0.9, shapes::translation({0, 0, 1.9}));
    return d;
}
inline SceneDesc underSky(TextureFilter filter) {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.6f))),
              mirror = shapes::add(d, shapes::metal("metal", Spectrum(0.9f), 0.1f));
    shapes::add(d, "ground", plate({0, -1, 0}, {0, 1, 0}, 4), grey);
    shapes::add(d, "ball", shapes::sphere(0.8, 4), mirror);
    const int lamp = shapes::add(d, shapes::lamp("lamp", Spectrum(5)));
    shapes::add(d, "lamp", plate({1.5, 1, 0}, {-1, -1, 0}, 0.3), lamp);
    d.environment = environment(
        16, 8, [](int x, int y) { return Spectrum(x == 3 && y == 2 ? 40.f : 0.2f, 0.3f, 0.1f * float(y)); }, filter);
    d.environment->rotate = 0.7f;
    shapes::addCamera(d, "main", 0.9, shapes::translation({0, 0.3, 4}));
    return d;
}

} // namespace chiaro::test
