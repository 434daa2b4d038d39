// The density estimate by itself, on photons whose density is known: its kernels, what it is off by at edges and where light is curved,
// and which photons belong to a point.
#include "integrators/photon_map.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;
using doctest::Approx;

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr PhotonKernel kernels[] = {PhotonKernel::constant, PhotonKernel::cone, PhotonKernel::epanechnikov};

// A white diffuse floor in the plane y = 0, looked at from above: radiance is illuminance / pi.
struct Floor {
    Floor() {
        SceneDesc s;
        const int white = shapes::add(s, shapes::diffuse("white", Spectrum(1)));
        shapes::add(s, "floor", shapes::quad({-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}), white);
        scene = compiled(std::move(s));
    }
    // Illuminance that the map shows at a point of the floor.
    double at(const PhotonMap& map, double x, double z, Gathered* found = nullptr) const {
        const Ray ray = rayFrom({float(x), 1, float(z)}, {0, -1, 0});
        const Hit hit = scene->intersect(ray);
        const SurfacePoint p = scene->point(hit, ray);
        Wavelengths lambda;
        const Bsdf bsdf = shade(*scene, p, {0, 1, 0}, {}, lambda);
        const FilmLayout layout{1, 1, {0, 0, 1, 1}, {}, false};
        Outputs out(layout);
        const GatherResult result = map.add(classes, {p, bsdf, classes.eye(), Spectrum(1)}, out);
        CHECK(out.total()[1] == Approx(double(result.added[1])).epsilon(1e-5));
        if (found) *found = result.found;
        return double(out.total()[1]) * pi64;
    }
    std::unique_ptr<const Scene> scene;
    PathClasses classes;
    Executor run{1};
};

Photon photonAt(const PathClasses& classes, const Vec3& p, float flux, const Vec3& normal = {0, 1, 0}, const Vec3& wi = {0, 1, 0}) {
    return {p, Spectrum(flux), packDirection(wi), classes.light(LightKind::area), packNormal(normal)};
}
// Illuminance 1 on the square [-1, 1]^2, by independent uniform photons.
PhotonList uniform(const Floor& floor, int n, uint64_t seed) {
    PhotonList photons;
    for (int i = 0; i < n; ++i) {
        Sampler u(seed, SamplerKind::independent, Stream::light, uint64_t(i), 0);
        const Point2 p = u.get2D();
        photons.push_back(photonAt(floor.classes, {2 * p.x - 1, 0, 2 * p.y - 1}, 4));
    }
    return photons;
}
// Illuminance e(x, z), by a fine lattice of photons with a share of the flux each: no noise.
template <class E> PhotonMap lattice(const Floor& floor, double half, int n, float radius, PhotonKernel kernel, E e) {
    PhotonList photons;
    const double cell = 2 * half / n;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double x = -half + (i + .5) * cell, z = -half + (j + .5) * cell;
            if (const double v = e(x, z); v > 0)
                photons.push_back(photonAt(floor.classes, {float(x), 0, float(z)}, float(v * cell * cell)));
        }
    return {PhotonStore(floor.run, std::move(photons), radius), 1, radius, {kernel, 0}};
}

} // namespace

TEST_SUITE("photon-density") {
    TEST_CASE("uniform photons: a fixed radius and k - 1 of the k nearest are unbiased, with the variance they must have (G2)") {
        const Floor floor;
        constexpr int n = 4000, sets = 600;
        const double density = n / 4.0; // photons per square metre
        for (const PhotonKernel kernel : kernels)
            for (const uint32_t k : {0u, 20u, 50u, 100u}) {
                CAPTURE(int(kernel));
                CAPTURE(k);
                const float radius = k == 0 ? .1f : .7f;
                stats::Moments m, byK;
                for (int s = 0; s < sets; ++s) {
                    const PhotonMap map(PhotonStore(floor.run, uniform(floor, n, uint64_t(s)), .1f), n, radius, {kernel, k});
                    Gathered found;
                    const double e = floor.at(map, 0, 0, &found);
                    m.add(e);
                    if (k > 0) byK.add(e * k / (k - 1.0));
                    if (kernel == PhotonKernel::constant) CHECK(double(found.density) / density == Approx(e).epsilon(1e-4));
                    if (k > 0) CHECK(found.count == float(k - 1));
                }
                INFO("mean " << m.mean << " +- " << m.error());
                CHECK(std::fabs(m.mean - 1) < 5 * m.error());
                // Of Poisson counts in a disc, and of the gamma distribution of its area; cone and Epanechnikov weigh unevenly.
                const double uneven = kernel == PhotonKernel::constant ? 1 : kernel == PhotonKernel::cone ? 1.5 : 4. / 3;
                const double expected = k == 0 ? uneven / (density * pi64 * .01) : 1 / (k - 2.0);
                const double variance = m.error() * m.error() * sets;
                if (k == 0 || kernel == PhotonKernel::constant) CHECK(variance == Approx(expected).epsilon(0.3));
                if (k > 0) CHECK(byK.mean == Approx(k / (k - 1.0)).epsilon(5 * byK.error()));
            }
    }
    TEST_CASE("fewer than k within the greatest radius: those over it, unbiased too") {
        const Floor floor;
        constexpr int n = 400, sets = 3000;
        stats::Moments m;
        for (int s = 0; s < sets; ++s) // 3.14 on average
            m.add(floor.at(PhotonMap(PhotonStore(floor.run, uniform(floor, n, uint64_t(s)), .1f), n, .1f, {PhotonKernel::constant, 4}), 0,
                           0));
        INFO("mean " << m.mean << " +- " << m.error());
        CHECK(std::fabs(m.mean - 1) < 5 * m.error());
    }
    TEST_CASE("beside an edge the disc keeps its share (G3)") {
        const Floor floor;
        const float r = .2f;
        const PhotonMap map = lattice(floor, 1, 2000, r, PhotonKernel::constant, [](double, double) { return 1.0; });
        const double a[] = {0, .25, .5, 1}, kept[] = {.5, .6574812, .8044989, 1};
        for (int i = 0; i < 4; ++i) {
            CHECK(floor.at(map, 1 - a[i] * double(r), .1) == Approx(kept[i]).epsilon(5e-3));
            CHECK(kept[i] == Approx(1 - (std::acos(a[i]) - a[i] * std::sqrt(1 - a[i] * a[i])) / pi64).epsilon(1e-6));
        }
        CHECK(floor.at(map, 1, 1) == Approx(.25).epsilon(5e-3));
    }
    TEST_CASE("where illuminance is curved: c r^2 times its Laplacian, c = 1/8, 0.075, 1/12 (G4)") {
        const Floor floor;
        const double c[] = {1. / 8, .075, 1. / 12};
        for (int i = 0; i < 3; ++i)
            for (const float r : {.1f, .2f}) {
                const PhotonMap map =
                    lattice(floor, .3, 1200, r, kernels[i], [](double x, double z) { return 1 + 5 * x * x + 3 * z * z + x; });
                const double laplacian = 2 * 5 + 2 * 3, bias = c[i] * double(r) * double(r) * laplacian;
                CHECK(floor.at(map, 0, 0) - 1 == Approx(bias).epsilon(0.01).scale(0.02));
            }
    }
    TEST_CASE("the typical radius holds as many photons as it says") {
        const Floor floor;
        for (const int n : {2000, 60000}) {
            const auto photons = uniform(floor, n, 5);
            CHECK(double(typicalRadius(photons, 50, .5)) == Approx(std::sqrt(50 * 4 / (pi64 * n))).epsilon(0.15));
        }
        CHECK(typicalRadius({}, 50, .5) == 0);
    }
    TEST_CASE("photons of the other side of a wall, of another wall and below are not counted; those that come from below are dark") {
        const Floor floor;
        const auto map = [&](const Photon& photon) { return PhotonMap(PhotonStore(floor.run, {photon}, .1f), 1, .1f, DensityPlan{}); };
        const double whole = 1 / (pi64 * .01);
        const PathClasses& c = floor.classes;
        CHECK(floor.at(map(photonAt(c, {.03f, 0, 0}, 1)), 0, 0) == Approx(whole).epsilon(1e-5));
        CHECK(floor.at(map(photonAt(c, {.03f, 0, 0}, 1, {0, 1, 0}, {.6f, .8f, 0})), 0, 0) == Approx(whole).epsilon(1e-5));
        CHECK(floor.at(map(photonAt(c, {.11f, 0, 0}, 1)), 0, 0) == 0);
        CHECK(floor.at(map(photonAt(c, {.03f, -.001f, 0}, 1, {0, -1, 0}, {0, -1, 0})), 0, 0) == 0); // the far side of a thin wall
        CHECK(floor.at(map(photonAt(c, {.03f, .02f, 0}, 1, {1, 0, 0}, {.8f, .6f, 0})), 0, 0) == 0); // a wall that stands on the floor
        CHECK(floor.at(map(photonAt(c, {.03f, .04f, 0}, 1)), 0, 0) == 0);                           // a shelf above it
    }
} // TEST_SUITE
