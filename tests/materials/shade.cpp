// From material and textures to the closure: channels and transfer functions, normal maps, back faces, absorption of solids.
#include "core/render/error.h"
#include "materials/bsdf.h"
#include "materials/closure_table.h"
#include <cstring>
#include <doctest/doctest.h>

using namespace chiaro;
using doctest::Approx;

namespace {

// A compiled scene with one quad in z = 0 for each material; each image is one texel.
struct Build {
    SceneDesc desc;
    int texture(std::array<uint8_t, 4> rgba) {
        ImageDesc image{"texel", 1, 1, 4, PixelType::u8, std::vector<std::byte>(4)};
        std::memcpy(image.pixels.data(), rgba.data(), 4);
        desc.images.push_back(image);
        desc.textures.push_back({int(desc.images.size()) - 1});
        return int(desc.textures.size()) - 1;
    }
    std::unique_ptr<const Scene> compile(const std::vector<MaterialDesc>& materials) {
        desc.materials = materials;
        for (std::size_t m = 0; m < materials.size(); ++m) {
            PrimitiveDesc p;
            p.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
            p.uv[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
            p.indices = {0, 1, 2, 0, 2, 3};
            p.material = int(m);
            desc.meshes.push_back({"quad", {p}});
            desc.instances.push_back({int(m), {}, "quad"});
        }
        Diagnostics notes;
        return Scene::compile(std::move(desc), notes, {}, nullptr, ClosureTable::make);
    }
};

SurfacePoint at(uint32_t material) {
    SurfacePoint s{};
    s.ng = s.ns = {0, 0, 1};
    s.material = material;
    return s;
}
Bsdf shaded(const Scene& scene, const SurfacePoint& s, const Vec3& wo = {0, 0, 1}) {
    Wavelengths lambda;
    return shade(scene, s, wo, {}, lambda);
}
MaterialDesc diffuse() {
    MaterialDesc m;
    m.metallic = 0;
    m.specular = 0;
    return m;
}

} // namespace

TEST_SUITE("shade") {
    TEST_CASE("base colour is factor, sRGB texture and vertex colour; unlit scatters nothing") {
        Build build;
        MaterialDesc m = diffuse(), unlit = diffuse();
        m.baseColor = {0.5f, 1, 1};
        m.baseColorTexture.texture = build.texture({188, 255, 128, 255});
        unlit.unlit = true;
        const auto scene = build.compile({m, unlit});
        SurfacePoint s = at(0);
        s.color = {1, 0.25f, 1, 1};
        const Spectrum f = shaded(*scene, s).evaluate({0, 0.6f, 0.8f}).f() * pi;
        CHECK(double(f[0]) == Approx(.5 * .5028864580).epsilon(1e-4));
        CHECK(double(f[1]) == Approx(.25).epsilon(1e-5));
        CHECK(double(f[2]) == Approx(.2158605001).epsilon(1e-4));
        const Bsdf none = shaded(*scene, at(1));
        CHECK(!none.smooth());
        CHECK(none.deltaSplit().n == 0);
        CHECK(!none.sample(0.3f, {0.3f, 0.3f}));
    }
    TEST_CASE("channels: metallic B, roughness G, specular A, transmission R") {
        Build build;
        MaterialDesc metal, lambert, pane;
        metal.baseColor = {.8f, .4f, .2f};
        metal.metallicRoughnessTexture.texture = build.texture({0, 128, 255, 0}); // roughness .502, metallic 1
        lambert.metallic = 0;
        lambert.specularTexture.texture = build.texture({255, 255, 255, 0});
        pane.metallic = 0, pane.roughness = 0, pane.transmission = 1;
        pane.transmissionTexture.texture = build.texture({255, 0, 0, 0});
        const auto scene = build.compile({metal, lambert, pane});
        const BsdfParameters same{.baseColor = metal.baseColor, .metallic = 1, .roughness = 128 / 255.f};
        const Vec3 wi{0.6f, 0, 0.8f};
        CHECK(double(shaded(*scene, at(0)).evaluate(wi).f()[1]) ==
              Approx(double(Bsdf(same, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}).evaluate(wi).f()[1])).epsilon(1e-4));
        CHECK(double(shaded(*scene, at(1)).evaluate(wi).f()[1]) == Approx(1 / std::numbers::pi).epsilon(1e-5));
        const DeltaBranches through = shaded(*scene, at(2)).deltaSplit();
        REQUIRE(through.n == 2);
        CHECK(through.b[1].event == Event::ST);
        CHECK(double(through.b[0].weight[0]) == Approx(1.0 / 13).epsilon(1e-5));
    }
    TEST_CASE("normal maps: byte values, tangents of the file and of the UVs, scale") {
        Build build;
        MaterialDesc right = diffuse(), up = diffuse(), half = diffuse(), flat = diffuse();
        right.normalTexture.texture = build.texture({218, 128, 218, 255});
        up.normalTexture.texture = build.texture({128, 218, 218, 255});
        half.normalTexture = right.normalTexture;
        half.normalScale = 0.5f;
        flat.normalTexture.texture = build.texture({128, 128, 255, 255});
        const auto scene = build.compile({right, up, half, flat});
        const auto normal = [&](uint32_t material, bool file, float sign, const Vec3& wo = {0, 0, 1}) {
            SurfacePoint s = at(material);
            s.dpdu = {2, 0.3f, 0}, s.dpdv = {0, -2, 0}; // v runs down the picture: up is -dpdv
            if (file) s.tangent = {0, 1, 0}, s.tangentSign = sign;
            return shaded(*scene, s, wo).normal();
        };
        const float c45 = std::sqrt(0.5f);
        CHECK(length(normal(0, true, 1) - Vec3{0, c45, c45}) < 5e-3f);
        CHECK(length(normal(1, true, 1) - Vec3{-c45, 0, c45}) < 5e-3f); // cross(n, t) = -x
        CHECK(length(normal(1, true, -1) - Vec3{c45, 0, c45}) < 5e-3f);
        const Vec3 t = normalize(Vec3{2, 0.3f, 0});
        CHECK(length(normal(0, false, 1) - Vec3{t.x * c45, t.y * c45, c45}) < 5e-3f);
        CHECK(dot(normal(1, false, 1), Vec3{0, 1, 0}) > 0.69f); // green leans up the picture
        CHECK(length(normal(2, true, 1) - normalize(Vec3{0, 0.5f, 1})) < 5e-3f);
        CHECK(double(normal(3, true, 1).y) == Approx(.00392157).epsilon(1e-3));
        CHECK(length(normal(0, true, 1, {0, 0, -1}) + Vec3{0, c45, c45}) < 5e-3f); // from behind: turned
    }
    TEST_CASE("mirrored UVs turn the bitangent, not the meaning of green") {
        Build build;
        MaterialDesc up = diffuse();
        up.normalTexture.texture = build.texture({128, 218, 218, 255});
        const auto scene = build.compile({up});
        SurfacePoint s = at(0);
        s.dpdu = {-1, 0, 0}, s.dpdv = {0, -1, 0};
        CHECK(shaded(*scene, s).normal().y > 0.69f);
    }
    TEST_CASE("absorption: c^(x/d) behind the back face, from either end") {
        MaterialDesc glass;
        glass.metallic = 0, glass.transmission = 1, glass.volume = true;
        glass.attenuationColor = {.5f, .25f, .8f};
        glass.attenuationDistance = 2;
        const auto scene = Build().compile({glass, diffuse()});
        const SurfacePoint s = at(0), wall = at(1);
        const Vec3 in{0, 0.6f, -0.8f}, out{0, 0.6f, 0.8f};
        const double expected[] = {.3535533906, .125, .7155417528};
        const Spectrum t = segmentTransmittance(*scene, &s, in, &wall, 3), back = segmentTransmittance(*scene, &wall, out, &s, 3);
        for (std::size_t i = 0; i < 3; ++i) CHECK(double(t[i]) == Approx(expected[i]).epsilon(1e-6));
        CHECK(segmentTransmittance(*scene, &s, out, &wall, 3) == Spectrum(1));
        CHECK(segmentTransmittance(*scene, nullptr, in, nullptr, 3) == Spectrum(1));
        SurfacePoint under = at(0); // light arriving at a solid's inside, met from below
        CHECK(segmentTransmittance(*scene, &wall, -in, &under, 3) == t);
        CHECK(back == t);
        CHECK(segmentTransmittance(*scene, nullptr, in, &wall, 3) == Spectrum(1));
    }
}
