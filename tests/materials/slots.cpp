// Every texture slot of the further lobes: which channel, under which transfer function, times which factor.
#include "core/render/error.h"
#include "materials/bsdf.h"
#include "materials/closure_table.h"
#include "materials/possible_events.h"
#include "materials/surface_parameters.h"
#include <array>
#include <cstring>
#include <doctest/doctest.h>

using namespace chiaro;
using doctest::Approx;

namespace {

constexpr float b51 = 51 / 255.f, b102 = 102 / 255.f, b153 = 153 / 255.f, b204 = 204 / 255.f;
float decoded(float srgb) { return std::pow((srgb + 0.055f) / 1.055f, 2.4f); }

// Every slot holds the same texel: red 51, green 102, blue 153, alpha 204 of 255.
std::unique_ptr<const Scene> compiled(MaterialDesc m) {
    SceneDesc desc;
    ImageDesc image{"texel", 1, 1, 4, PixelType::u8, std::vector<std::byte>(4)};
    const std::array<uint8_t, 4> rgba{51, 102, 153, 204};
    std::memcpy(image.pixels.data(), rgba.data(), 4);
    desc.images.push_back(image);
    desc.textures.push_back({0});
    desc.materials = {std::move(m)};
    PrimitiveDesc p;
    p.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    p.uv[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    p.indices = {0, 1, 2, 0, 2, 3};
    p.material = 0;
    desc.meshes.push_back({"quad", {p}});
    desc.instances.push_back({0, {}, "quad"});
    Diagnostics notes;
    return Scene::compile(std::move(desc), notes, {}, nullptr, ClosureTable::make);
}
SurfacePoint at() {
    SurfacePoint s{};
    s.ng = s.ns = {0, 0, 1};
    s.dpdu = {1, 0, 0}, s.dpdv = {0, -1, 0};
    return s;
}
MaterialDesc dielectric() {
    MaterialDesc m;
    m.metallic = 0;
    return m;
}

} // namespace

TEST_SUITE("slots") {
    TEST_CASE("clearcoat R, its roughness G, its own normal") {
        MaterialDesc m = dielectric();
        m.clearcoat = 0.5f, m.clearcoatRoughness = 0.8f;
        m.clearcoatTexture.texture = m.clearcoatRoughnessTexture.texture = 0;
        BsdfParameters p = surfaceParameters(*compiled(m), at());
        CHECK(p.clearcoat == Approx(0.5 * double(b51)).epsilon(1e-5));
        CHECK(p.clearcoatRoughness == Approx(0.8 * double(b102)).epsilon(1e-5));
        CHECK(lengthSquared(p.clearcoatNormal) == 0); // that of the surface below
        m.clearcoatNormalTexture.texture = 0;
        m.clearcoatNormalScale = 0.5f;
        p = surfaceParameters(*compiled(m), at());
        const Vec3 n = normalize(Vec3{(2 * b51 - 1) * 0.5f, (2 * b102 - 1) * 0.5f, 2 * b153 - 1});
        CHECK(length(p.clearcoatNormal - n) < 1e-4f);
        m.clearcoatNormalTexture.texture = -1;
        m.normalTexture.texture = 0; // of the base alone: the coat lies smooth over it
        p = surfaceParameters(*compiled(m), at());
        CHECK(p.clearcoatNormal == Vec3{0, 0, 1});
    }
    TEST_CASE("sheen colour sRGB, its roughness A") {
        MaterialDesc m = dielectric();
        m.sheenColor = {1, 0.5f, 0.25f}, m.sheenRoughness = 0.6f;
        m.sheenColorTexture.texture = m.sheenRoughnessTexture.texture = 0;
        const BsdfParameters p = surfaceParameters(*compiled(m), at());
        CHECK(p.sheenColor[0] == Approx(double(decoded(b51))).epsilon(1e-3));
        CHECK(p.sheenColor[2] == Approx(0.25 * double(decoded(b153))).epsilon(1e-3));
        CHECK(p.sheenRoughness == Approx(0.6 * double(b204)).epsilon(1e-5));
    }
    TEST_CASE("anisotropy: direction RG, strength B, turned counter-clockwise") {
        MaterialDesc m = dielectric();
        m.anisotropy = 0.5f;
        BsdfParameters p = surfaceParameters(*compiled(m), at());
        CHECK(p.anisotropy == 0.5f);
        CHECK(length(normalize(p.tangent) - Vec3{1, 0, 0}) < 1e-6f);
        m.anisotropyRotation = pi / 2;
        p = surfaceParameters(*compiled(m), at());
        CHECK(length(normalize(p.tangent) - Vec3{0, 1, 0}) < 1e-5f);
        m.anisotropyRotation = 0;
        m.anisotropyTexture.texture = 0;
        p = surfaceParameters(*compiled(m), at());
        CHECK(p.anisotropy == Approx(0.5 * double(b153)).epsilon(1e-5));
        CHECK(length(normalize(p.tangent) - normalize(Vec3{2 * b51 - 1, 2 * b102 - 1, 0})) < 1e-4f);
    }
    TEST_CASE("iridescence R, thickness G between its ends, the maximum without a texture") {
        MaterialDesc m = dielectric();
        m.iridescence = 0.8f, m.iridescenceMin = 200, m.iridescenceMax = 700;
        CHECK(surfaceParameters(*compiled(m), at()).filmThickness == 700);
        m.iridescenceTexture.texture = m.iridescenceThicknessTexture.texture = 0;
        const BsdfParameters p = surfaceParameters(*compiled(m), at());
        CHECK(p.iridescence == Approx(0.8 * double(b51)).epsilon(1e-5));
        CHECK(p.filmThickness == Approx(200 + 500 * double(b102)).epsilon(1e-5));
    }
    TEST_CASE("diffuse transmission A, its colour sRGB") {
        MaterialDesc m = dielectric();
        m.diffuseTransmission = 0.5f;
        m.diffuseTransmissionTexture.texture = m.diffuseTransmissionColorTexture.texture = 0;
        const BsdfParameters p = surfaceParameters(*compiled(m), at());
        CHECK(p.diffuseTransmission == Approx(0.5 * double(b204)).epsilon(1e-5));
        CHECK(p.diffuseTransmissionColor[1] == Approx(double(decoded(b102))).epsilon(1e-3));
    }
    TEST_CASE("specular-glossiness: RGB sRGB is the reflectance, A the glossiness, metallic and index have no say") {
        MaterialDesc m; // metallic 1
        m.specularGlossiness = true;
        m.baseColor = Spectrum(0.5f);
        m.specularColor = {1, 0.5f, 0.5f};
        m.glossiness = 0.5f;
        m.specularGlossinessTexture.texture = 0;
        m.ior = 2;
        const BsdfParameters p = surfaceParameters(*compiled(m), at());
        const float most = 0.5f * decoded(b153);
        CHECK(p.specularColor[2] == Approx(double(most)).epsilon(1e-3));
        CHECK(p.baseColor[0] == Approx(0.5 * (1 - double(most))).epsilon(1e-3));
        CHECK(p.roughness == Approx(1 - 0.5 * double(b204)).epsilon(1e-5));
        CHECK(p.metallic == 0);
        const Bsdf b(p, {0, 0, 1}, {0, 0, 1}, {0, 0, 1});
        CHECK(b.smooth());
        CHECK((possibleEvents(m) & letter(Event::DR)) != 0);
    }
    TEST_CASE("dispersion: the wavelength that a path has picked decides the index; thin panes have none") {
        MaterialDesc m = dielectric();
        m.roughness = 0, m.transmission = 1, m.volume = true, m.dispersion = 2;
        const auto solid = compiled(m);
        Wavelengths none, blue{475};
        const Vec3 wo{0.6f, 0, 0.8f};
        CHECK(shade(*solid, at(), wo, {}, none).deltaSplit().n == 4);
        const DeltaBranches one = shade(*solid, at(), wo, {}, blue).deltaSplit();
        REQUIRE(one.n == 2);
        CHECK(-one.b[1].wi.x == Approx(0.6 / (1.5 + 0.05 * 0.8042)).epsilon(1e-3));
        m.volume = false;
        CHECK(shade(*compiled(m), at(), wo, {}, none).deltaSplit().n == 2);
    }
    TEST_CASE("events: what a material can do is what is foreseen") {
        MaterialDesc leaf = dielectric(), coat = dielectric(), cloth = dielectric();
        leaf.specular = 0, leaf.diffuseTransmission = 1;
        coat.specular = 0, coat.clearcoat = 1;
        cloth.specular = 0, cloth.sheenColor = Spectrum(1);
        CHECK(possibleEvents(leaf) == letter(Event::DT));
        CHECK(possibleEvents(coat) == (letter(Event::DR) | letter(Event::SR)));
        CHECK(possibleEvents(cloth) == (letter(Event::DR) | letter(Event::GR)));
    }
}
