// Closures that share what their material is everywhere are those that make it themselves, to the last bit; so is what is evaluated
// without the densities of the reverse.
#include "materials/closure_table.h"
#include "core/render/error.h"
#include "materials/surface_parameters.h"
#include "tests/materials/closures.h"
#include <cstring>
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

const Vec3 bent = surface.toWorld(normalize(Vec3{0.2f, 0.15f, 1}));
// Above, grazing, below; in the world.
const Vec3 ways[] = {surface.toWorld(normalize(Vec3{0.3f, 0.4f, 0.9f})), surface.toWorld(normalize(Vec3{-0.9f, 0.3f, 0.06f})),
                     surface.toWorld(normalize(Vec3{-0.2f, 0.7f, -0.5f}))};

bool same(const Spectrum& a, const Spectrum& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// reverse: the densities of the reverse too.
bool same(const BsdfValue& a, const BsdfValue& b, bool reverse) {
    bool alike = a.n == b.n && a.pdfW == b.pdfW && (!reverse || a.pdfReverseW == b.pdfReverseW);
    for (int i = 0; i < std::min(a.n, b.n); ++i) alike = alike && same(a.terms[i].f, b.terms[i].f) && a.terms[i].event == b.terms[i].event;
    return alike;
}
bool same(const std::optional<BsdfSample>& a, const std::optional<BsdfSample>& b, bool reverse) {
    if (!a || !b) return a.has_value() == b.has_value();
    return a->wi == b->wi && same(a->weight, b->weight) && a->pdfW == b->pdfW && (!reverse || a->pdfReverseW == b->pdfReverseW) &&
           a->delta == b->delta && a->event == b->event && a->lambda.hero == b->lambda.hero;
}
bool same(const DeltaBranches& a, const DeltaBranches& b) {
    bool alike = a.n == b.n;
    for (int i = 0; i < std::min(a.n, b.n); ++i)
        alike = alike && a.b[i].wi == b.b[i].wi && same(a.b[i].weight, b.b[i].weight) && a.b[i].event == b.b[i].event;
    return alike;
}
bool same(const Bsdf& a, const Bsdf& b, bool reverse) {
    bool alike = same(a.albedo(), b.albedo()) && same(a.diffuseAlbedo(), b.diffuseAlbedo()) && a.smooth() == b.smooth() &&
                 same(a.deltaSplit(), b.deltaSplit());
    for (const Vec3& wi : ways)
        for (const Terms terms : {Terms::together, Terms::apart})
            alike = alike && same(a.evaluate(wi, terms), b.evaluate(wi, terms), reverse);
    for (const float u : {0.02f, 0.3f, 0.6f, 0.98f}) alike = alike && same(a.sample(u, {0.3f, u}), b.sample(u, {0.3f, u}), reverse);
    return alike;
}

MaterialDesc described(const BsdfParameters& p) {
    MaterialDesc m;
    m.baseColor = p.baseColor;
    m.metallic = p.metallic;
    m.roughness = p.roughness;
    m.ior = p.ior;
    m.specular = p.specular;
    m.specularColor = p.specularColor;
    m.transmission = p.transmission;
    m.volume = !p.thin;
    m.clearcoat = p.clearcoat;
    m.clearcoatRoughness = p.clearcoatRoughness;
    m.sheenColor = p.sheenColor;
    m.sheenRoughness = p.sheenRoughness;
    m.anisotropy = p.anisotropy;
    m.iridescence = p.iridescence;
    m.iridescenceIor = p.filmIor;
    m.iridescenceMax = p.filmThickness;
    m.dispersion = p.dispersion;
    m.diffuseTransmission = p.diffuseTransmission;
    m.diffuseTransmissionColor = p.diffuseTransmissionColor;
    return m;
}

// Of a triangle of each material.
SceneDesc drawn(SceneDesc desc) {
    MeshDesc mesh{"triangles", {}};
    for (std::size_t i = 0; i < desc.materials.size(); ++i) {
        PrimitiveDesc triangle;
        triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        triangle.indices = {0, 1, 2};
        triangle.material = int(i);
        mesh.primitives.push_back(triangle);
    }
    desc.meshes.push_back(mesh);
    desc.instances.push_back({0, {}, "triangles"});
    return desc;
}
std::unique_ptr<const Scene> sceneOf(SceneDesc desc) {
    Diagnostics notes;
    return Scene::compile(drawn(std::move(desc)), notes, {}, nullptr, ClosureTable::make);
}

} // namespace

TEST_SUITE("closure-table") {
    TEST_CASE("a shared closure is its own, from every side, both ways") {
        for (const ClosureCase& c : closures) {
            CAPTURE(c.name);
            const ClosureRecord record(c.parameters);
            int off = 0;
            for (const Transport transport : {Transport::radiance, Transport::importance})
                for (const Vec3& ns : {surface.z, bent})
                    for (const Vec3& wo : ways) {
                        const Bsdf shared(record, surface.z, ns, wo, transport, Densities::both),
                            own(c.parameters, surface.z, ns, wo, transport),
                            forward(c.parameters, surface.z, ns, wo, transport, Densities::forward);
                        off += !same(shared, own, true) + !same(forward, own, false);
                    }
            CHECK(off == 0);
        }
    }
    TEST_CASE("shade() shares where nothing varies, and only there") {
        SceneDesc desc;
        for (const ClosureCase& c : closures) desc.materials.push_back(described(c.parameters));
        desc.images.push_back({"texel", 1, 1, 4, PixelType::u8, std::vector<std::byte>(4, std::byte{100})});
        desc.textures.push_back({0});
        MaterialDesc textured;
        textured.metallicRoughnessTexture.texture = 0;
        desc.materials.push_back(textured);
        const auto scene = sceneOf(std::move(desc));
        const ClosureTable& table = *ClosureTable::of(*scene);
        SurfacePoint s;
        s.ng = surface.z;
        s.ns = bent;
        s.tangent = surface.x;
        for (s.material = 0; s.material < scene->materials().size(); ++s.material) { // the last is glTF's default, drawn nowhere
            const MaterialDesc& m = scene->material(s.material);
            CAPTURE(s.material);
            const bool varies = m.anisotropy > 0 || m.metallicRoughnessTexture.texture >= 0 || s.material + 1 == scene->materials().size();
            for (const Vec4& color : {Vec4{1, 1, 1, 0.5f}, Vec4{1, 0.7f, 1, 1}})
                for (const float hero : {0.f, 550.f}) {
                    s.color = color;
                    Wavelengths lambda{hero};
                    const bool shares = !varies && color.y == 1 && !(hero > 0 && m.dispersion > 0);
                    CHECK((table.find(s, lambda) != nullptr) == shares);
                    if (hero > 0 && m.dispersion > 0) continue; // of another index
                    CHECK(same(shade(*scene, s, ways[0], {}, lambda), Bsdf(surfaceParameters(*scene, s), s.ng, s.ns, ways[0]), true));
                }
        }
    }
    TEST_CASE("made with its scene, counted with it, and where it does not fit said there") {
        SceneDesc desc;
        desc.materials.push_back(described(closures[0].parameters));
        desc = drawn(std::move(desc));
        Diagnostics notes;
        const auto with = Scene::compile(desc, notes, {}, nullptr, ClosureTable::make), without = Scene::compile(desc, notes);
        REQUIRE(ClosureTable::of(*with));
        CHECK(ClosureTable::of(*without) == nullptr);
        CHECK(with->counts().bytes.materials == without->counts().bytes.materials + with->table()->bytes());
        CHECK(with->counts().bytes.materials <= forecast({.materials = 2}).kept.materials); // glTF's default is the second
        SurfacePoint s;
        s.ng = s.ns = surface.z;
        Wavelengths lambda;
        CHECK(same(shade(*with, s, ways[0], {}, lambda), shade(*without, s, ways[0], {}, lambda), true));
        const Scene::MakeTable full = [](const Scene&) -> std::unique_ptr<const SceneTable> { throw std::bad_alloc(); };
        CHECK_THROWS_AS(Scene::compile(desc, notes, {}, nullptr, full), std::bad_alloc);
    }
    TEST_CASE("an inside that dims is known") {
        for (const bool dims : {false, true}) {
            SceneDesc desc;
            MaterialDesc glass;
            glass.metallic = 0;
            glass.transmission = 1;
            glass.volume = true;
            if (dims) glass.attenuationDistance = 1;
            desc.materials.push_back(glass);
            const auto scene = sceneOf(std::move(desc));
            CHECK(ClosureTable::of(*scene)->absorbs() == dims);
        }
    }
}
