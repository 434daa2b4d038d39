// Faults of closures: lobes, Fresnel, refraction, absorption, against closed forms and quadratures of the scattering equations.
#include "materials/bsdf.h"
#include "tests/planted/trial.h"
#include <numbers>

namespace chiaro::test {

namespace {

constexpr double pi64 = std::numbers::pi;

Vec3 slanted(double degrees, float side = 1) {
    const double a = degrees * pi64 / 180;
    return {float(std::sin(a)), 0, side * float(std::cos(a))};
}
constexpr BsdfParameters solidGlass{.roughness = 0, .transmission = 1, .thin = false};
Bsdf flat(const BsdfParameters& p, const Vec3& wo, float front = 1) { return Bsdf(p, {0, 0, front}, {0, 0, front}, wo); }
const DeltaBranch* branch(const DeltaBranches& all, Event e) {
    for (const DeltaBranch& b : all)
        if (b.event == e) return &b;
    return nullptr;
}

// A ray that enters a solid and leaves it through a parallel face goes on as it came.
void throughSlab(Trial& t) {
    for (const double degrees : {10., 45., 70.}) {
        const Vec3 wo = slanted(degrees);
        const DeltaBranches entering = flat(solidGlass, wo).deltaSplit();
        const DeltaBranch* in = branch(entering, Event::ST);
        if (!in) return t.exact(0, 1, 0);
        const DeltaBranches leaving = flat(solidGlass, -in->wi, -1).deltaSplit();
        const DeltaBranch* out = branch(leaving, Event::ST);
        t.exact(out ? double(length(out->wi + wo)) : 1, 0, 1e-6);
    }
}
void denseSide(Trial& t) { // reflectance of glass seen from within (C2)
    for (const auto& [degrees, reflectance] : {std::pair{20., .041728518}, {41., .37975127}, {41.8, .89077192}, {42., 1.}, {70., 1.}}) {
        const DeltaBranches all = flat(solidGlass, slanted(degrees, -1)).deltaSplit();
        const DeltaBranch* mirror = branch(all, Event::SR);
        t.exact(mirror ? double(mirror->weight[1]) : 0, reflectance, 1e-3);
    }
}
void insideGlass(Trial& t) { // radiance in a furnace full of glass is n squared (C14)
    SceneDesc s;
    const int glass = shapes::add(s, shapes::glass("glass", 1.5f));
    shapes::add(s, "ball", shapes::sphere(1, 4), glass);
    s.environment = uniformSky(1);
    t.equal(*compiled(std::move(s)), perspective({0.2, 0.1, 0.3}, {1, 0.3, 0}, 0.8), {32, 32}, 2.25, "path:rr-depth=64", 1e-3);
}
void absorption(Trial& t) { // three metres of a gel whose colour is meant for two (C13)
    SceneDesc s;
    MaterialDesc gel = shapes::glass("gel", 1);
    gel.attenuationDistance = 2;
    gel.attenuationColor = {.5f, .25f, .8f};
    const int material = shapes::add(s, gel), lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
    shapes::add(s, "slab", shapes::box({10, 1.5, 10}), material, shapes::translation({0, 1.5, 0}));
    shapes::add(s, "lamp", plate({0, -1, 0}, {0, 1, 0}, 10), lamp);
    const double expected = luminance(Rgb<double>(.3535533906, .125, .7155417528));
    t.equal(*compiled(std::move(s)), probe({0, 3, 0}, {0, -1, 0}, 2), {8, 8}, expected, "path", 1e-4);
}
// A plate of the material under a uniform sky of radiance 1 shows its directional albedo.
void furnace(Trial& t, MaterialDesc m, double mu, double albedo, double floor) {
    SceneDesc s;
    m.doubleSided = true;
    const int material = shapes::add(s, std::move(m));
    shapes::add(s, "plate", plate({0, 0, 0}, {0, 1, 0}, 0.1), material);
    s.environment = uniformSky(1);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {std::sqrt(1 - mu * mu), -mu, 0}), {16, 16}, albedo, "path", floor);
}
void roughMetal(Trial& t) { // alpha 0.25, height-correlated Smith (D4)
    MaterialDesc metal = shapes::metal("metal", Spectrum(1), 0.5f);
    metal.compensated = false;
    for (const auto& [mu, albedo] : {std::pair{1., .915812}, {.5, .857263}, {.2, .848160}}) furnace(t, metal, mu, albedo, 1e-4);
}
void whiteCoat(Trial& t) { // a white base under a coat loses and gains nothing (D8)
    MaterialDesc m;
    m.metallic = 0;
    m.roughness = 0.5f;
    for (const double mu : {1., .5, .2}) furnace(t, m, mu, 1, 3e-3);
}
void lambert(Trial& t) { // D1
    furnace(t, shapes::diffuse("matt", Spectrum(0.5f)), 0.7, 0.5, 1e-4);
}

const Check slabCheck{"into and out of a slab (C8)", throughSlab, 1}, denseCheck{"Fresnel from within (C2)", denseSide, 1},
    insideCheck{"furnace inside glass (C14)", insideGlass, 256}, absorptionCheck{"absorption in a slab (C13)", absorption, 64},
    metalCheck{"albedo of a rough metal (D4)", roughMetal, 1024}, coatCheck{"white base under a coat (D8)", whiteCoat, 1024},
    lambertCheck{"Lambert under a uniform sky (D1)", lambert, 1024};

const PlantedRow rows[] = {
    {Fault::etaSquaredMissing, 6, "radiance not scaled by eta squared on refraction", insideCheck},
    {Fault::etaRatioWhenLeaving, 29, "index ratio of entering used when leaving", slabCheck},
    {Fault::totalReflectionMissing, 30, "Fresnel of the thin side used from within", denseCheck},
    {Fault::absorptionPerBounce, 31, "absorption a passage, whatever its length", absorptionCheck},
    {Fault::alphaIsRoughness, 32, "roughness not squared", metalCheck},
    {Fault::visiblePdfByNormals, 33, "visible normals sampled, density of all normals", metalCheck},
    {Fault::glossyBias, 0, "1 % too much in the glossy lobe", metalCheck},
    {Fault::coatAdded, 34, "coat added without taking from the base", coatCheck},
    {Fault::diffuseBias, 0, "1 % too much in the diffuse lobe", lambertCheck},
};

} // namespace

std::span<const PlantedRow> plantedMaterials() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-materials") {
    TEST_CASE("each planted fault of a closure is caught") { chiaro::test::catchAll(chiaro::test::plantedMaterials()); }
} // TEST_SUITE
