#include "core/scene/scene_hash.h"
#include <initializer_list>
#include <memory>
#include <xxhash.h>

namespace chiaro {
namespace {

class Hasher {
public:
    Hasher() : state_(XXH3_createState(), XXH3_freeState) { XXH3_64bits_reset(state_.get()); }
    template <class T> void values(const std::vector<T>& v) {
        number(double(v.size()));
        XXH3_64bits_update(state_.get(), v.data(), v.size() * sizeof(T));
    }
    void number(double v) { XXH3_64bits_update(state_.get(), &v, sizeof v); }
    void numbers(std::initializer_list<double> all) {
        for (const double v : all) number(v);
    }
    void spectrum(const Spectrum& s) { numbers({s[0], s[1], s[2]}); }
    void affine(const Affine& a) {
        for (const auto& row : a.m)
            for (const double v : row) number(v);
    }
    void slot(const TextureSlot& s) {
        numbers({double(s.texture), double(s.uvSet)});
        for (const auto& row : s.transform)
            for (const float v : row) number(v);
    }
    uint64_t digest() const { return XXH3_64bits_digest(state_.get()); }

private:
    std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

void add(Hasher& h, const MaterialDesc& m) {
    h.spectrum(m.baseColor);
    h.spectrum(m.emission);
    h.spectrum(m.specularColor);
    h.spectrum(m.attenuationColor);
    h.numbers({m.alpha, m.metallic, m.roughness, m.normalScale, double(m.alphaMode), m.alphaCutoff, double(m.doubleSided), double(m.unlit),
               m.ior, m.specular, m.transmission, double(m.volume), m.attenuationDistance});
    for (const TextureSlot* s : {&m.baseColorTexture, &m.metallicRoughnessTexture, &m.normalTexture, &m.emissionTexture, &m.specularTexture,
                                 &m.specularColorTexture, &m.transmissionTexture})
        h.slot(*s);
}

void add(Hasher& h, const Geometry& g) {
    h.values(g.positions);
    h.values(g.indices);
    h.values(g.normals);
    h.values(g.tangents);
    for (const auto& uv : g.uv) h.values(uv);
    h.values(g.colors);
    h.number(g.material);
}

void add(Hasher& h, const PunctualDesc& l) {
    h.spectrum(l.intensity);
    h.numbers({double(l.kind), l.range, l.innerCone, l.outerCone});
    h.affine(l.toWorld);
    for (const Affine& m : l.motion) h.affine(m);
}

} // namespace

uint64_t sceneHash(const Scene& scene, std::span<const Geometry> geometries, std::span<const Instance> instances, const SceneDesc& desc) {
    Hasher h;
    for (const Geometry& g : geometries) add(h, g);
    bool moves = false;
    for (const Instance& i : instances) {
        for (const auto& row : i.toWorld.m)
            for (const float v : row) h.number(v);
        h.number(i.firstGeometry);
        if (i.motion == Hit::none) continue;
        for (const Motion::Key& k : scene.motion(i.motion).keys()) h.affine(Motion::compose(k));
        moves = true;
    }
    for (const MaterialDesc& m : scene.materials()) add(h, m);
    for (const ImageDesc& i : scene.textures().images()) {
        h.numbers({double(i.width), double(i.height), double(i.channels), double(i.type)});
        h.values(i.pixels);
    }
    for (const TextureDesc& t : scene.textures().textures())
        h.numbers({double(t.image), double(t.wrapS), double(t.wrapT), double(t.filter)});
    for (const PunctualDesc& l : desc.lights) {
        add(h, l);
        moves |= !l.motion.empty();
    }
    if (moves) h.numbers({double(desc.shutter.open), double(desc.shutter.close)});
    if (desc.environment) {
        h.values(desc.environment->image.pixels);
        h.numbers(
            {double(desc.environment->image.width), double(desc.environment->filter), desc.environment->rotate, desc.environment->scale});
    }
    const Vec3d c = scene.centre();
    h.numbers({c.x, c.y, c.z});
    return h.digest();
}

} // namespace chiaro
