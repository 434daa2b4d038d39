// Faults of film and samples: where a pixel lies, whether pixels are independent, whether the order of sums shows.
#include "tests/planted/trial.h"
#include "tests/statistics.h"

namespace chiaro::test {

namespace {

std::unique_ptr<const Scene> lampOverFloor() {
    SceneDesc s;
    const int wall = shapes::add(s, shapes::diffuse("floor", Spectrum(0.8f))), lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 2), wall);
    shapes::add(s, "lamp", shapes::quad({-.5, 1, -.5}, {.5, 1, -.5}, {.5, 1, .5}, {-.5, 1, .5}), lamp);
    return compiled(std::move(s));
}
CameraDesc onFloor(const Scene& scene) {
    CameraDesc camera = probe({0, 0, 0}, {0, -1, 0});
    const Vec3d c = scene.centre();
    camera.toWorld.m[0][3] -= c.x;
    camera.toWorld.m[1][3] -= c.y;
    camera.toWorld.m[2][3] -= c.z;
    return camera;
}

// The border between light and dark falls between two pixels: one is 1, the other 0 (H1).
void pixelEdge(Trial& t) {
    SceneDesc s;
    const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
    shapes::add(s, "half", shapes::quad({-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}), lamp);
    shapes::add(s, "low half", shapes::quad({-1, -1, 0}, {0, -1, 0}, {0, 0, 0}, {-1, 0, 0}), lamp);
    const auto scene = compiled(std::move(s));
    Settings how{2, 2};
    for (const uint32_t x : {0u, 1u}) {
        how.crop = {x, 0, x + 1, 2};
        t.equal(*scene, probe({0, 0, 0}, {0, 0, -1}, 1, 0.5), how, x == 0 ? 1 : 0);
    }
}

// Of pixels with one expectation, the variance of the picture's mean is that of a pixel over their number.
void independence(Trial& t) {
    const auto scene = lampOverFloor();
    const CameraDesc camera = onFloor(*scene);
    constexpr int seeds = 64;
    Settings how{8, 8, 4};
    std::vector<stats::Moments> pixels(64);
    stats::Moments means;
    for (int r = 0; r < seeds; ++r) {
        how.seed = uint64_t(r);
        const Rendering picture = rendered(*scene, camera, how);
        double sum = 0;
        for (uint32_t i = 0; i < 64; ++i) {
            const double v = double(luminance(picture.film->mean({i % 8, i / 8})));
            pixels[i].add(v);
            sum += v;
        }
        means.add(sum / 64);
    }
    double variance = 0;
    for (const stats::Moments& m : pixels) variance += m.variance() / 64;
    t.likely(stats::chiSquareP((seeds - 1) * means.variance() * 64 / variance, seeds - 1), uint64_t(seeds) * 64 * how.spp);
}

// The same samples in one film, and in two that are merged the other way round (M8).
void order(Trial& t) {
    const auto scene = lampOverFloor();
    const CameraDesc camera = onFloor(*scene);
    Bench bench(*scene, camera, {8, 8, 16});
    Film whole(bench.layout()), first(bench.layout()), last(bench.layout());
    const IntegratorChoice path = chooseIntegrator("path");
    const auto integrator = path.entry->make(path.options);
    integrator->prepare(bench.job);
    integrator->render(bench.job, {0, 16, nullptr}, whole);
    integrator->render(bench.job, {0, 6, nullptr}, first);
    integrator->render(bench.job, {6, 16, nullptr}, last);
    last.merge(first);
    t.exact(samePicture(whole, last) ? 1 : 0, 1, 0);
}

const Check edgeCheck{"border between pixels (H1)", pixelEdge, 1024}, independenceCheck{"variance against 1/N", independence, 1},
    orderCheck{"merged in another order (M8)", order, 1};

const PlantedRow rows[] = {
    {Fault::pixelCorner, 38, "half a pixel missing in the raster position", edgeCheck},
    {Fault::seedsShared, 39, "all pixels share their random numbers", independenceCheck},
    {Fault::sumsInFloat, 40, "sums in single precision", orderCheck},
};

} // namespace

std::span<const PlantedRow> plantedFilm() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-film") {
    TEST_CASE("each planted fault of film and samples is caught") { chiaro::test::catchAll(chiaro::test::plantedFilm()); }
} // TEST_SUITE
