// The fingerprint of a scene: it follows content, not names.
#include "tests/scene_kit.h"
#include <cstring>
#include <doctest/doctest.h>
#include <functional>
#include <map>

using namespace chiaro;
using namespace chiaro::test;

namespace {

SceneDesc base() {
    SceneDesc d;
    d.name = "scene.glb";
    const uint8_t texels[] = {10, 20, 30, 40, 50, 60};
    addTexture(d, 2, 1, 3, texels);
    addTexture(d, 1, 2, 3, texels);
    MaterialDesc m = shapes::diffuse("grey", Spectrum(0.5f));
    m.volume = true;
    m.attenuationDistance = 2;
    shapes::add(d, m);
    shapes::add(d, shapes::lamp("lamp", Spectrum(2)));
    PrimitiveDesc p = shapes::sphere(1, 1);
    for (std::size_t i = 0; i < p.positions.size(); ++i) {
        p.tangents.push_back({1, 0, 0, 1});
        p.colors.push_back({1, 0.5f, 0.25f, 1});
        p.uv[1].push_back({0.5f, float(i)});
    }
    p.uv[0] = p.uv[1];
    shapes::add(d, "once", p, 0);
    const Affine places[] = {shapes::translation({3, 0, 0}), shapes::translation({-3, 0, 0})};
    addInstances(d, square(1), 1, places);
    d.lights.push_back({"spot", PunctualKind::spot, Spectrum(3), 10, 0.1, 0.5, {}});
    d.environment = environment(2, 1, [](int x, int) { return Spectrum(float(x + 1)); });
    shapes::addCamera(d, "main", 1, {});
    return d;
}
uint64_t hashOf(const std::function<void(SceneDesc&)>& change) {
    SceneDesc d = base();
    change(d);
    return compiled(std::move(d))->hash();
}
using Change = std::pair<std::string, std::function<void(SceneDesc&)>>;

std::vector<Change> materialChanges() {
    const auto m = [](std::string name, std::function<void(MaterialDesc&)> f) {
        return Change{name, [f](SceneDesc& d) { f(d.materials[0]); }};
    };
    std::vector<Change> all = {
        m("baseColor", [](auto& x) { x.baseColor[1] = 0.6f; }),
        m("alpha", [](auto& x) { x.alpha = 0.9f; }),
        m("metallic", [](auto& x) { x.metallic = 0.3f; }),
        m("roughness", [](auto& x) { x.roughness = 0.3f; }),
        m("normalScale", [](auto& x) { x.normalScale = 0.5f; }),
        m("emission", [](auto& x) { x.emission[2] = 1; }),
        m("alphaMode mask", [](auto& x) { x.alphaMode = AlphaMode::mask; }),
        m("alphaMode blend", [](auto& x) { x.alphaMode = AlphaMode::blend; }),
        m("alphaCutoff", [](auto& x) { x.alphaCutoff = 0.4f; }),
        m("doubleSided", [](auto& x) { x.doubleSided = !x.doubleSided; }),
        m("unlit", [](auto& x) { x.unlit = true; }),
        m("ior", [](auto& x) { x.ior = 1.4f; }),
        m("specular", [](auto& x) { x.specular = 0.4f; }),
        m("specularColor", [](auto& x) { x.specularColor[0] = 0.4f; }),
        m("transmission", [](auto& x) { x.transmission = 0.4f; }),
        m("volume", [](auto& x) { x.volume = false; }),
        m("attenuationDistance", [](auto& x) { x.attenuationDistance = 3; }),
        m("attenuationColor", [](auto& x) { x.attenuationColor[2] = 0.1f; }),
        m("clearcoat", [](auto& x) { x.clearcoat = 0.1f; }),
        m("clearcoatRoughness", [](auto& x) { x.clearcoatRoughness = 0.1f; }),
        m("clearcoatNormalScale", [](auto& x) { x.clearcoatNormalScale = 0.1f; }),
        m("sheenColor", [](auto& x) { x.sheenColor[1] = 0.1f; }),
        m("sheenRoughness", [](auto& x) { x.sheenRoughness = 0.1f; }),
        m("anisotropy", [](auto& x) { x.anisotropy = 0.1f; }),
        m("anisotropyRotation", [](auto& x) { x.anisotropyRotation = 0.1f; }),
        m("iridescence", [](auto& x) { x.iridescence = 0.1f; }),
        m("iridescenceIor", [](auto& x) { x.iridescenceIor = 1.4f; }),
        m("iridescenceMin", [](auto& x) { x.iridescenceMin = 110; }),
        m("iridescenceMax", [](auto& x) { x.iridescenceMax = 110; }),
        m("dispersion", [](auto& x) { x.dispersion = 0.1f; }),
        m("diffuseTransmission", [](auto& x) { x.diffuseTransmission = 0.1f; }),
        m("diffuseTransmissionColor", [](auto& x) { x.diffuseTransmissionColor[1] = 0.1f; }),
        m("specularGlossiness", [](auto& x) { x.specularGlossiness = true; }),
        m("glossiness", [](auto& x) { x.glossiness = 0.1f; }),
        m("compensated", [](auto& x) { x.compensated = false; }),
    };
    const std::pair<const char*, TextureSlot MaterialDesc::*> slots[] = {
        {"baseColorTexture", &MaterialDesc::baseColorTexture},
        {"metallicRoughnessTexture", &MaterialDesc::metallicRoughnessTexture},
        {"normalTexture", &MaterialDesc::normalTexture},
        {"emissionTexture", &MaterialDesc::emissionTexture},
        {"specularTexture", &MaterialDesc::specularTexture},
        {"specularColorTexture", &MaterialDesc::specularColorTexture},
        {"transmissionTexture", &MaterialDesc::transmissionTexture},
        {"clearcoatTexture", &MaterialDesc::clearcoatTexture},
        {"clearcoatRoughnessTexture", &MaterialDesc::clearcoatRoughnessTexture},
        {"clearcoatNormalTexture", &MaterialDesc::clearcoatNormalTexture},
        {"sheenColorTexture", &MaterialDesc::sheenColorTexture},
        {"sheenRoughnessTexture", &MaterialDesc::sheenRoughnessTexture},
        {"anisotropyTexture", &MaterialDesc::anisotropyTexture},
        {"iridescenceTexture", &MaterialDesc::iridescenceTexture},
        {"iridescenceThicknessTexture", &MaterialDesc::iridescenceThicknessTexture},
        {"diffuseTransmissionTexture", &MaterialDesc::diffuseTransmissionTexture},
        {"diffuseTransmissionColorTexture", &MaterialDesc::diffuseTransmissionColorTexture},
        {"specularGlossinessTexture", &MaterialDesc::specularGlossinessTexture}};
    for (const auto& [name, slot] : slots) {
        all.push_back(m(name, [slot = slot](auto& x) { (x.*slot).texture = 0; }));
        all.push_back(m(name, [slot = slot](auto& x) { (x.*slot).uvSet = 1; }));
        all.push_back(m(name, [slot = slot](auto& x) { (x.*slot).transform[1][2] = 0.5f; }));
    }
    return all;
}
std::vector<Change> geometryChanges() {
    const auto p = [](std::string name, std::function<void(PrimitiveDesc&)> f) {
        return Change{name, [f](SceneDesc& d) { f(d.meshes[0].primitives[0]); }};
    };
    return {p("position", [](auto& x) { x.positions[3].y *= 0.999f; }),
            p("normal",
              [](auto& x) {
                  x.normals[3] = {1, 0, 0};
              }),
            p("no normals", [](auto& x) { x.normals.clear(); }),
            p("tangent", [](auto& x) { x.tangents[3].w = -1; }),
            p("uv 0", [](auto& x) { x.uv[0][3].x = 7; }),
            p("uv 1", [](auto& x) { x.uv[1][3].y = 7; }),
            p("color", [](auto& x) { x.colors[3].w = 0.5f; }),
            p("winding", [](auto& x) { std::swap(x.indices[0], x.indices[1]); }),
            p("fewer triangles", [](auto& x) { x.indices.resize(x.indices.size() - 3); }),
            p("material", [](auto& x) { x.material = 1; }),
            {"node", [](SceneDesc& d) { d.instances[0].toWorld.m[1][3] = 0.25; }},
            {"instance", [](SceneDesc& d) { d.instances[2].toWorld.m[1][3] = 0.25; }},
            {"one instance more", [](SceneDesc& d) { d.instances.push_back(d.instances[1]); }},
            {"one instance less", [](SceneDesc& d) { d.instances.pop_back(); }},
            {"everything moved", [](SceneDesc& d) {
                 for (InstanceDesc& i : d.instances) i.toWorld.m[0][3] += 5;
             }}};
}
std::vector<Change> otherChanges() {
    return {{"texel", [](SceneDesc& d) { d.images[0].pixels[4] = std::byte(51); }},
            {"shape of a picture", [](SceneDesc& d) { std::swap(d.images[0].width, d.images[0].height); }},
            {"wrapS", [](SceneDesc& d) { d.textures[0].wrapS = Wrap::clamp; }},
            {"wrapT", [](SceneDesc& d) { d.textures[0].wrapT = Wrap::mirror; }},
            {"filter", [](SceneDesc& d) { d.textures[0].filter = TextureFilter::nearest; }},
            {"image of a texture", [](SceneDesc& d) { d.textures[0].image = 1; }},
            {"light kind", [](SceneDesc& d) { d.lights[0].kind = PunctualKind::point; }},
            {"light intensity", [](SceneDesc& d) { d.lights[0].intensity[1] = 4; }},
            {"light range", [](SceneDesc& d) { d.lights[0].range = 11; }},
            {"inner cone", [](SceneDesc& d) { d.lights[0].innerCone = 0.2; }},
            {"outer cone", [](SceneDesc& d) { d.lights[0].outerCone = 0.6; }},
            {"light place", [](SceneDesc& d) { d.lights[0].toWorld.m[2][3] = 1; }},
            {"second light", [](SceneDesc& d) { d.lights.push_back(d.lights[0]); }},
            {"no light", [](SceneDesc& d) { d.lights.clear(); }},
            {"sky texel", [](SceneDesc& d) { d.environment = environment(2, 1, [](int, int) { return Spectrum(2); }); }},
            {"sky shape", [](SceneDesc& d) { d.environment = environment(1, 2, [](int, int y) { return Spectrum(float(y + 1)); }); }},
            {"sky rotation", [](SceneDesc& d) { d.environment->rotate = 1; }},
            {"sky scale", [](SceneDesc& d) { d.environment->scale = 2; }},
            {"no sky", [](SceneDesc& d) { d.environment.reset(); }}};
}

} // namespace

TEST_SUITE("scene-hash") {

    TEST_CASE("every field of content changes it, each in its own way") {
        std::map<uint64_t, std::string> seen = {{hashOf([](SceneDesc&) {}), "nothing"}};
        for (const auto& list : {materialChanges(), geometryChanges(), otherChanges()})
            for (const auto& [name, change] : list) {
                const auto [place, fresh] = seen.insert({hashOf(change), name});
                CAPTURE(name);
                CAPTURE(place->second);
                CHECK(fresh);
            }
    }

    TEST_CASE("names do not change it, nor compiling again") {
        const uint64_t plain = hashOf([](SceneDesc&) {});
        CHECK(plain == hashOf([](SceneDesc&) {}));
        CHECK(plain == hashOf([](SceneDesc& d) {
                  d.name = "other.gltf";
                  for (auto& x : d.materials) x.name += "!";
                  for (auto& x : d.meshes) x.name += "!";
                  for (auto& x : d.instances) x.name += "!";
                  for (auto& x : d.images) x.name += "!";
                  for (auto& x : d.lights) x.name += "!";
                  for (auto& x : d.cameras) x.name += "!";
                  d.environment->image.name = "sky.hdr";
              }));
    }
}
