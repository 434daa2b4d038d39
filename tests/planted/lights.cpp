// Faults of lamps, sky and their sampling, against closed forms of direct light (Lambert's polygon formula, inverse squares, KHR ramps).
#include "tests/io/gltf_builder.h"
#include "tests/planted/trial.h"
#include <numbers>

namespace chiaro::test {

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr float rho = 0.8f;
constexpr Settings window{16, 16};

SceneDesc receiverOnly(const Vec3d& at, const Vec3d& normal) {
    SceneDesc s;
    const int wall = shapes::add(s, shapes::diffuse("receiver", Spectrum(rho)));
    shapes::add(s, "receiver", plate(at, normal, 0.01), wall);
    return s;
}
// A square lamp one metre above the origin, shining down.
void addLamp(SceneDesc& s, double half, float radiance) {
    const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(radiance)));
    shapes::add(s, "lamp", shapes::quad({-half, 1, -half}, {half, 1, -half}, {half, 1, half}, {-half, 1, half}), lamp);
}

void squareLamp(Trial& t) {
    for (const auto& [at, irradiance] : {std::pair{Vec3d{0, 0, 0}, .7522746885}, {Vec3d{1, 0, 1}, .1243532338}}) {
        SceneDesc s = receiverOnly(at, {0, 1, 0});
        addLamp(s, 0.5, 1);
        const auto scene = compiled(std::move(s));
        for (const char* how : {"path", "path:mis=off"}) t.equal(*scene, probe(at, {0, -1, 0}), window, rho * irradiance / pi64, how);
    }
}
void smallLamp(Trial& t) {
    SceneDesc s = receiverOnly({0, 0, 0}, {0, 1, 0});
    addLamp(s, 0.05, 1000);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), window, rho * 9.966782906 / pi64);
}
void lampBack(Trial& t) {
    SceneDesc s = receiverOnly({0, 2, 0}, {0, -1, 0});
    addLamp(s, 0.5, 1);
    const auto scene = compiled(std::move(s));
    t.equal(*scene, probe({0, 2, 0}, {0, 1, 0}), window, 0);
    t.equal(*scene, probe({0, 1, 0}, {0, -1, 0}), window, 0);
}
void fourLamps(Trial& t) {
    SceneDesc s = receiverOnly({0, 0, 0}, {0, 1, 0});
    for (int i = 0; i < 4; ++i) {
        PunctualDesc l;
        l.intensity = Spectrum(0.25f);
        l.toWorld = shapes::translation({0, 1, 0});
        s.lights.push_back(l);
    }
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), window, rho / pi64, "path", 1e-4);
}
void pointLamp(Trial& t) {
    SceneDesc s = receiverOnly({0, 0, 0}, {0, 1, 0});
    PunctualDesc l;
    l.toWorld = shapes::translation({0, 1, 0});
    s.lights.push_back(l);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), window, rho / pi64, "path", 1e-4);
}
void spotLamp(Trial& t) {
    for (const auto& [degrees, share] : {std::pair{0., 1.}, {25., .6524510}, {30., .3315081}, {35., .0935347}}) {
        const double a = degrees * pi64 / 180;
        const Vec3d at{std::sin(a), 0, -std::cos(a)};
        SceneDesc s = receiverOnly(at, -at);
        PunctualDesc l; // at the origin, along -z
        l.kind = PunctualKind::spot;
        l.innerCone = 20 * pi64 / 180;
        l.outerCone = 40 * pi64 / 180;
        s.lights.push_back(l);
        t.equal(*compiled(std::move(s)), probe(at, at), window, rho * share / pi64, "path", 1e-3);
    }
}
void emissiveStrength(Trial& t) {
    const Folder folder("planted");
    Builder b = Builder::triangle({{"material", 0}});
    b.add("materials",
          {{"emissiveFactor", {1, 0.5, 0.25}}, {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}}}}});
    b.root["extensionsUsed"] = {"KHR_materials_emissive_strength"};
    const SceneDesc s = b.read(folder);
    const double expected[] = {5, 2.5, 1.25};
    for (std::size_t i = 0; i < 3; ++i) t.exact(double(s.materials[0].emission[i]), expected[i], 1e-6);
}
// A sky of many equal texels, by light samples alone: the irradiance of a uniform sky is pi.
void skySampling(Trial& t) {
    SceneDesc s = receiverOnly({0, 0, 0}, {0, 1, 0});
    s.environment = environment(16, 8, [](int, int) { return Spectrum(1); });
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), window, rho, "path:mis=off");
}
// Parallel rays into the sky show one texel: the picture's centre lies along +x, u grows towards +z, row 0 is up.
void skyTexels(Trial& t) {
    SceneDesc s = receiverOnly({0, -100, 0}, {0, 1, 0});
    s.environment = environment(8, 4, [](int x, int y) { return Spectrum(float(1 + x + 8 * y)); });
    const auto scene = compiled(std::move(s));
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 8; ++column)
            for (const double within : {0.25, 0.75}) {
                const double phi = ((column + within) / 8 - 0.5) * 2 * pi64, theta = (row + within) / 4 * pi64;
                const Vec3d d{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
                t.equal(*scene, probe({0, 0, 0}, d), {2, 2}, 1 + column + 8 * row);
            }
}

const Check squareLampCheck{"square lamp, two places (B1)", squareLamp, 1024}, smallLampCheck{"small lamp (B10)", smallLamp, 1024},
    lampBackCheck{"lamp from behind", lampBack, 64}, fourLampsCheck{"four lamps are one (B15)", fourLamps, 64},
    pointLampCheck{"point lamp (B6)", pointLamp, 64}, spotCheck{"spot lamp (B7)", spotLamp, 64},
    strengthCheck{"emissive factor x strength (B10)", emissiveStrength, 1}, skyCheck{"uniform sky, light samples (E1)", skySampling, 256},
    texelCheck{"sky, texel by texel (E4)", skyTexels, 1};

const PlantedRow rows[] = {
    {Fault::lightPdfNotConverted, 1, "area pdf of a lamp not converted to solid angle", squareLampCheck},
    {Fault::receiverCosineMissing, 2, "cosine at the receiver missing", squareLampCheck},
    {Fault::lampCosineMissing, 3, "cosine at the lamp missing", smallLampCheck},
    {Fault::lampTwoSided, 3, "lamps shine from both sides", lampBackCheck},
    {Fault::lightPowerBias, 0, "1 % too much light from lamps that are sampled", squareLampCheck},
    {Fault::skySineMissing, 12, "sky sampled with the density of equal texels", skyCheck},
    {Fault::skyHalfTexel, 13, "sky shifted by half a texel", texelCheck},
    {Fault::skyQuarterTurn, 13, "sky turned by 90 degrees", texelCheck},
    {Fault::lightChoiceForgotten, 15, "probability of choosing the lamp forgotten", fourLampsCheck},
    {Fault::spotHalfAngle, 16, "cone angles of a spot taken as full angles", spotCheck},
    {Fault::candelaAsLumen, 17, "intensity of a point lamp divided by 4 pi", pointLampCheck},
    {Fault::emissiveStrengthIgnored, 18, "KHR_materials_emissive_strength ignored", strengthCheck},
};

} // namespace

std::span<const PlantedRow> plantedLights() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-lights") {
    TEST_CASE("each planted fault of a light is caught") { chiaro::test::catchAll(chiaro::test::plantedLights()); }
} // TEST_SUITE
