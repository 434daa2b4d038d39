// Faults of photons: their flux, and what is made of their density.
#include "integrators/photon_map.h"
#include "integrators/photon_trace.h"
#include "tests/planted/trial.h"
#include <numbers>

namespace chiaro::test {

namespace {

constexpr double pi64 = std::numbers::pi;

// A bulb in a closed room: what falls on the walls at first is all its light (G1).
void storedFlux(Trial& t) {
    SceneDesc s;
    PrimitiveDesc shell = shapes::insideOut(shapes::sphere(1, 2));
    shell.normals.clear();
    shapes::add(s, "wall", std::move(shell), shapes::add(s, shapes::diffuse("wall", Spectrum(.5f))));
    PunctualDesc bulb;
    bulb.intensity = Spectrum(2);
    s.lights.push_back(bulb);
    const auto scene = compiled(std::move(s));
    const Bench bench(*scene, perspective({0, 0, 0}, {0, 0, -1}, 1), {4, 4, 1});
    PhotonRequest request;
    request.paths = t.spp();
    request.kinds = {.direct = true, .caustic = false, .indirect = false};
    double sum = 0;
    for (const Photon& photon : tracePhotons(bench.job, request).photons) sum += double(luminance(photon.flux));
    t.exact(sum / double(request.paths), 8 * pi64, 1e-5 * 8 * pi64);
}

// A closed ball that glows: radiance is 1 + rho after one scattering, 1 / (1 - rho) after all.
std::unique_ptr<const Scene> glowingBall() {
    SceneDesc s;
    PrimitiveDesc shell = shapes::insideOut(shapes::sphere(1, 3));
    shell.normals.clear();
    shapes::add(s, "wall", std::move(shell), shapes::add(s, shapes::lamp("wall", Spectrum(1), Spectrum(.5f))));
    return compiled(std::move(s));
}
void directOnce(Trial& t) {
    Settings how{8, 8};
    how.maxDepth = 1;
    t.equal(*glowingBall(), perspective({.1, .2, .3}, {-.4, .1, -.5}, 1.2), how, 1.5, "photon:gather=0,count=4k", 5e-3);
}
// A glass plate between a lamp as wide as the floor and the floor: what it lets through, seen from between them. Light is L S+ D alone.
void causticOnce(Trial& t) {
    SceneDesc s;
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, .5), shapes::add(s, shapes::diffuse("floor", Spectrum(.5f))));
    MaterialDesc pane;
    pane.metallic = 0;
    pane.roughness = 0;
    pane.transmission = 1;
    shapes::add(s, "pane", plate({0, .5, 0}, {0, 1, 0}, 1), shapes::add(s, pane));
    PunctualDesc sun;
    sun.kind = PunctualKind::directional;
    sun.intensity = Spectrum(float(pi64));
    sun.toWorld = shapes::lookAt({0, 1, 0}, {0, 0, 0}, {0, 0, 1});
    s.lights.push_back(sun);
    // R = 2 F / (1 + F) of a pane, F = 0.04: 1 - R comes through; light that went up and down again is
    // beyond depth 3.
    Settings how{8, 8};
    how.maxDepth = 2;
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}, .25, .2), how, .5 * (1 - .08 / 1.04),
            "photon:gather=0,count=64k,caustic-count=64k,radius=0.05,caustic-radius=0.05,kernel=constant", 5e-3);
}
// Uniform photons about a point: the k-nearest estimate is their density.
void evenDensity(Trial& t) {
    SceneDesc s;
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 2), shapes::add(s, shapes::diffuse("white", Spectrum(1))));
    const auto scene = compiled(std::move(s));
    const Ray ray = rayFrom({0, 1, 0}, {0, -1, 0});
    const SurfacePoint at = scene->point(scene->intersect(ray), ray);
    Wavelengths lambda;
    const Bsdf bsdf = shade(*scene, at, {0, 1, 0}, {}, lambda);
    const PathClasses classes;
    const Executor run(1);
    constexpr int n = 1000;
    double sum = 0;
    for (uint32_t set = 0; set < t.spp(); ++set) {
        PhotonList photons;
        for (uint32_t i = 0; i < n; ++i) {
            Sampler u(set, SamplerKind::independent, Stream::light, i, 0);
            const Point2 p = u.get2D();
            photons.push_back({{2 * p.x - 1, 0, 2 * p.y - 1},
                               Spectrum(4),
                               packDirection({0, 1, 0}),
                               classes.light(LightKind::area),
                               packNormal({0, 1, 0})});
        }
        const FilmLayout layout{1, 1, {0, 0, 1, 1}, {}, false};
        Outputs out(layout);
        PhotonMap(PhotonStore(run, std::move(photons), .1f), n, 1, {PhotonKernel::constant, 20})
            .add(classes, {at, bsdf, classes.eye(), Spectrum(1)}, out);
        sum += double(out.total()[1]) * pi64;
    }
    // 1 / (k - 2) is the variance of one.
    t.exact(sum / t.spp(), 1, 5 / std::sqrt(18. * t.spp()));
}
// The mean radius of 16 iterations.
void radii(Trial& t) {
    const auto scene = glowingBall();
    Bench bench(*scene, perspective({.1, .2, .3}, {-.4, .1, -.5}, 1.2), {4, 4, 16});
    FilmLayout layout = bench.layout();
    layout.photons = true;
    Film film(layout);
    bench.render(film, "sppm:radius=0.2,count=1k");
    double mean = 0, area = 1;
    for (int i = 1; i <= 16; ++i) {
        mean += .2 * std::sqrt(area) / 16;
        area *= (i + 2. / 3) / (i + 1); // G5
    }
    t.exact(double(film.gathered({1, 1}).radius), mean, 1e-4 * mean);
}

const Check directCheck{"glowing ball, direct light alone (F1)", directOnce, 64}, causticCheck{"the sun through a pane", causticOnce, 64},
    densityCheck{"uniform photons, 20 nearest (G2)", evenDensity, 1024}, radiusCheck{"radii of progressive photon mapping (G5)", radii, 16};
const Check fluxCheck{"flux of a bulb's photons (G1)", storedFlux, 256};

const PlantedRow rows[] = {
    {Fault::photonPowerBias, 35, "photons carry one per cent too much", fluxCheck},
    {Fault::photonDensityBias, 36, "k photons counted over the disc of the k-th", densityCheck},
    {Fault::photonDirectTwice, 0, "photons that were not yet scattered kept beside shadow rays", directCheck},
    {Fault::photonCausticTwice, 0, "caustic photons in the global map too", causticCheck},
    {Fault::photonRadiusFixed, 0, "the discs do not shrink", radiusCheck},
};

} // namespace

std::span<const PlantedRow> plantedPhotons() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-photons") {
    TEST_CASE("each planted fault of photons is caught") { chiaro::test::catchAll(chiaro::test::plantedPhotons()); }
} // TEST_SUITE
