// What patches say of their materials: reflectance of coats, metals, glass and textures, light of lamps, shares of masks.
#include "core/math/warp.h"
#include "materials/bsdf.h"
#include "tests/render/patches_kit.h"

using namespace chiaro;
using namespace chiaro::test;
using namespace chiaro::radiosity;

namespace {

MaterialDesc plastic(float roughness) {
    MaterialDesc m = shapes::diffuse("plastic", Spectrum(.8f, .4f, .2f));
    m.specular = 1;
    m.roughness = roughness;
    return m;
}
SceneDesc floorOf(const MaterialDesc& m) {
    SceneDesc d;
    shapes::add(d, "floor", plate({0, 0, 0}, {0, 1, 0}, .5), shapes::add(d, m));
    d.environment = uniformSky(1);
    d.materials[0].doubleSided = false;
    return d;
}
// The front of a square of this material, as one patch.
Patch patchOf(const SceneDesc& d) {
    const auto scene = compiled(d);
    const Bare bare(*scene);
    const Patches p = patchesOf(bare, 10);
    REQUIRE(p.size() == 2); // the sky lights both sides
    CHECK(bool(p[0].reflectance == p[1].reflectance));
    return p[0];
}
void checkColor(const Spectrum& found, const Spectrum& expected, double tolerance) {
    for (std::size_t i = 0; i < 3; ++i) CHECK(double(found[i]) == doctest::Approx(double(expected[i])).epsilon(tolerance));
}

// Diffuse light from everywhere, scattered diffusely: the integral of the closure itself over both directions.
Spectrum byQuadrature(const MaterialDesc& m) {
    const auto scene = compiled(floorOf(m));
    const Ray ray = rayFrom(local(*scene, {.1, 1, .1}), {0, -1, 0});
    const SurfacePoint at = scene->point(scene->intersect(ray), ray);
    Rgb<double> sum(0);
    const uint32_t n = 1 << 14;
    Wavelengths lambda;
    for (uint32_t k = 0; k < n; ++k) {
        Sampler s(1, SamplerKind::sobol, Stream::prepass, 0, k);
        const Frame f = Frame::about(at.ng);
        const Vec3 wo = f.toWorld(cosineHemisphere(s.get2D())), wi = f.toWorld(cosineHemisphere(s.get2D()));
        for (const BsdfTerm& t : shade(*scene, at, wo, {}, lambda).evaluate(wi, Terms::apart))
            if (t.event == Event::DR) sum += Rgb<double>(t.f[0], t.f[1], t.f[2]) * (std::numbers::pi / n);
    }
    return {float(sum[0]), float(sum[1]), float(sum[2])};
}

} // namespace

TEST_SUITE("patches-surface") {
    TEST_CASE("the diffuse share of diffuse, coated, metallic and transmitting surfaces") {
        checkColor(patchOf(floorOf(shapes::diffuse("grey", {.8f, .4f, .2f}))).reflectance, {.8f, .4f, .2f}, 1e-6);
        for (const float roughness : {0.f, .3f, 1.f}) {
            const MaterialDesc m = plastic(roughness);
            const Spectrum found = patchOf(floorOf(m)).reflectance;
            checkColor(found, byQuadrature(m), 2e-3);
            CHECK(found[0] < .8f);
        }
        MaterialDesc m = shapes::diffuse("half", {.8f, .4f, .2f});
        m.metallic = .25f;
        m.ior = 1; // no coat
        checkColor(patchOf(floorOf(m)).reflectance, Spectrum(.8f, .4f, .2f) * .75f, 1e-5);
        m.metallic = 0;
        m.transmission = .5f;
        checkColor(patchOf(floorOf(m)).reflectance, Spectrum(.8f, .4f, .2f) * .5f, 1e-5);
        CHECK(black(patchOf(floorOf(shapes::metal("gold", {1, .8f, .3f}, .2f))).reflectance));
        CHECK(black(patchOf(floorOf(shapes::glass("glass", 1.5f))).reflectance));
    }
    TEST_CASE("white reflects all but a rounding") { CHECK(patchOf(floorOf(shapes::diffuse("white", Spectrum(1)))).reflectance[0] < 1); }
    TEST_CASE("textures are averaged over each patch, vertex colours too") {
        SceneDesc d = floorOf(shapes::diffuse("chess", Spectrum(1)));
        const uint8_t texels[] = {255, 255, 255, 0, 0, 0, 0, 0, 0, 255, 255, 255};
        d.materials[0].baseColorTexture.texture = addTexture(d, 2, 2, 3, texels, {.filter = TextureFilter::nearest});
        checkColor(patchOf(d).reflectance, Spectrum(.5f), 1e-3);
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches four = patchesOf(bare, .5f);
        double sum = 0;
        int white = 0;
        for (const Patch& p : four.all()) {
            if (p.normal.y < 0) continue;
            sum += double(p.reflectance[0]) / 4;
            white += p.reflectance[0] > .99f;
            CHECK((p.reflectance[0] > .99f || p.reflectance[0] < .01f));
        }
        CHECK(sum == doctest::Approx(.5).epsilon(1e-5));
        CHECK(white == 2);
        // sRGB 188 is a half: the mean is taken of light, not of code values.
        const uint8_t ramp[] = {255, 255, 255, 188, 188, 188, 188, 188, 188, 0, 0, 0};
        SceneDesc linear = floorOf(shapes::diffuse("grey", Spectrum(1)));
        linear.materials[0].baseColorTexture.texture = addTexture(linear, 2, 2, 3, ramp, {.filter = TextureFilter::nearest});
        checkColor(patchOf(linear).reflectance, Spectrum(.5f), 5e-3);
        SceneDesc coloured = floorOf(shapes::diffuse("white", Spectrum(1)));
        coloured.meshes[0].primitives[0].colors = {{1, 0, 0, 1}, {1, 0, 0, 1}, {0, 0, 1, 1}, {0, 0, 1, 1}};
        checkColor(patchOf(coloured).reflectance, {.5f, 1e-30f, .5f}, 5e-3);
    }
    TEST_CASE("lamps shine from their front, from both sides where they are double-sided, by their texture's mean") {
        SceneDesc d;
        shapes::add(d, "lamp", plate({0, 0, 0}, {0, 1, 0}, .5), shapes::add(d, shapes::lamp("lamp", {3, 2, 1})));
        shapes::add(d, "walls", shapes::insideOut(shapes::box({2, 2, 2})), shapes::add(d, shapes::diffuse("grey", Spectrum(.5f))));
        const auto sides = [](const SceneDesc& desc) {
            const auto scene = compiled(desc);
            const Bare bare(*scene);
            const Patches p = patchesOf(bare, 10);
            const auto own = ofPart(p, 0);
            REQUIRE(own.size() == 2); // light comes back to it from below
            return std::pair(p[own[0]], p[own[1]]);
        };
        auto [front, back] = sides(d);
        checkColor(front.emission, Spectrum(3, 2, 1) * pi, 1e-5);
        CHECK(black(back.emission));
        SceneDesc both = d;
        both.materials[0].doubleSided = true;
        checkColor(sides(both).second.emission, Spectrum(3, 2, 1) * pi, 1e-5);
        const uint8_t texels[] = {255, 255, 255, 0, 0, 0};
        SceneDesc striped = d;
        striped.materials[0].emissionTexture.texture = addTexture(striped, 2, 1, 3, texels, {.filter = TextureFilter::nearest});
        checkColor(sides(striped).first.emission, Spectrum(3, 2, 1) * (pi / 2), 1e-3);
    }
    TEST_CASE("a mask leaves a share of the patch, and what it leaves keeps its colour") {
        SceneDesc d = floorOf(shapes::diffuse("leaf", Spectrum(1)));
        d.materials[0].alphaMode = AlphaMode::mask;
        const uint8_t texels[] = {188, 188, 188, 255, 188, 188, 188, 255, 255, 255, 255, 0, 188, 188, 188, 255}; // a quarter is cut away
        d.materials[0].baseColorTexture.texture = addTexture(d, 2, 2, 4, texels, {.filter = TextureFilter::nearest});
        const Patch p = patchOf(d);
        CHECK(p.coverage == doctest::Approx(.75).epsilon(1e-3));
        CHECK(p.area == doctest::Approx(.75).epsilon(1e-3));
        checkColor(p.reflectance, Spectrum(.5f), 5e-3);
        d.materials[0].alpha = 0; // nothing left: the patch counts next to nothing, and breaks nothing
        const Patch gone = patchOf(d);
        CHECK(gone.area > 0);
        CHECK(gone.area < .05f);
        CHECK(black(gone.reflectance));
    }
    TEST_CASE("it says what takes no part") {
        SceneDesc d = floorOf(shapes::diffuse("grey", Spectrum(.5f)));
        shapes::add(d, "mirror", plate({0, 1, 0}, {0, 1, 0}, .5), shapes::add(d, shapes::metal("mirror", Spectrum(.9f), 0)));
        shapes::add(d, "pane", plate({0, 2, 0}, {0, 1, 0}, .5), shapes::add(d, shapes::glass("pane", 1.5f)));
        shapes::add(d, "table", plate({0, 3, 0}, {0, 1, 0}, .5), shapes::add(d, plastic(.4f)));
        const auto scene = compiled(d);
        const Bare bare(*scene);
        patchesOf(bare, 10);
        REQUIRE(bare.notes.warnings().size() == 1);
        CHECK(bare.notes.warnings()[0].find("2 (\"mirror\", \"pane\") block light") != std::string::npos);
        bool told = false;
        for (const auto& f : bare.notes.facts()) told = told || f.message.find("\"plastic\"") != std::string::npos;
        CHECK(told);
    }
} // TEST_SUITE
