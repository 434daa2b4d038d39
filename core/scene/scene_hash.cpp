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
    void bytes(std::span<const std::byte> b) { XXH3_64bits_update(state_.get(), b.data(), b.size()); }
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

// What lies above and behind the base. Only where some of it is there: a scene of plain materials keeps the name that it had before these
// were known.
std::vector<double> layers(const MaterialDesc& m) {
    std::vector<double> v{m.clearcoat,
                          m.clearcoatRoughness,
                          m.clearcoatNormalScale,
                          m.sheenRoughness,
                          m.anisotropy,
                          m.anisotropyRotation,
                          m.iridescence,
                          m.iridescenceIor,
                          m.iridescenceMin,
                          m.iridescenceMax,
                          m.dispersion,
                          m.diffuseTransmission,
                          double(m.specularGlossiness),
                          double(m.compensated),
                          m.glossiness};
    for (const Spectrum* s : {&m.sheenColor, &m.diffuseTransmissionColor}) v.insert(v.end(), {(*s)[0], (*s)[1], (*s)[2]});
    for (const TextureSlot* s : {&m.clearcoatTexture, &m.clearcoatRoughnessTexture, &m.clearcoatNormalTexture, &m.sheenColorTexture,
                                 &m.sheenRoughnessTexture, &m.anisotropyTexture, &m.iridescenceTexture, &m.iridescenceThicknessTexture,
                                 &m.diffuseTransmissionTexture, &m.diffuseTransmissionColorTexture, &m.specularGlossinessTexture}) {
        v.insert(v.end(), {double(s->texture), double(s->uvSet)});
        for (const auto& row : s->transform) v.insert(v.end(), std::begin(row), std::end(row));
    }
    return v;
}

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
    static const std::vector<double> none = layers({});
    if (const std::vector<double> v = layers(m); v != none) h.values(v);
}

void add(Hasher& h, const Geometry& g) {
    h.values(g.positions);
    h.values(g.indices);
    h.values(g.normals);
    h.values(g.tangents);
    for (int k = 0; k < uvSets; ++k)
        if (k < 2 || !g.uv[k].empty()) h.values(g.uv[k]);
    h.values(g.colors);
    h.number(g.material);
    for (const ShapeDesc& s : g.steps) {
        h.values(s.positions);
        h.values(s.normals);
        h.values(s.tangents);
    }
}

// As the picture came, row by row.
void add(Hasher& h, const TexelStore& image) {
    const MipLevel& base = image.levels(Transfer::linear)[0];
    h.numbers({double(base.width), double(base.height), double(image.channels()), double(image.type())});
    std::vector<std::byte> row;
    image.row(0, row);
    h.number(double(row.size()) * base.height);
    for (uint32_t y = 0; y < base.height; ++y) {
        image.row(y, row);
        h.bytes(row);
    }
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
    bool moves = false;
    for (const Geometry& g : geometries) {
        add(h, g);
        moves |= g.deforms();
    }
    for (const Instance& i : instances) {
        for (const auto& row : i.toWorld.m)
            for (const float v : row) h.number(v);
        h.number(i.firstGeometry);
        if (i.motion == Hit::none) continue;
        for (const Motion::Key& k : scene.motion(i.motion).keys()) h.affine(Motion::compose(k));
        moves = true;
    }
    for (const MaterialDesc& m : scene.materials()) add(h, m);
    for (const TexelStore& i : scene.textures().images()) add(h, i);
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
