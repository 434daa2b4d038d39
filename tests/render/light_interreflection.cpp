// Light tracing of interreflection with known answers: a sphere with a port (F2), plates between mirrors, concentric spheres, a dome (F6),
// as a whole and by masks (L D+ E and what is without it).
#include "tests/render/measure.h"

using namespace chiaro;
using namespace chiaro::test;

namespace {

Settings settings(uint32_t spp) { return {8, 8, spp, {}, 2, 0, SamplerKind::sobol, FilterKind::box}; }

// As measure(), on the paths of an expression.
Measured measureOn(const Scene& scene, CameraDesc camera, const char* paths, uint32_t spp) {
    return overReplicates([&](int r) {
        Settings one = settings(std::max(1u, spp / replicates));
        one.seed = uint64_t(r) + 7;
        Bench bench(scene, camera, one);
        bench.classes = PathClasses::make({.paths = paths, .split = "", .within = "", .without = ""});
        FilmLayout layout = bench.layout();
        layout.splats = true;
        Film film(layout);
        bench.render(film, "light");
        CHECK(film.dropped() == 0);
        return film.meanLuminance().value;
    });
}

} // namespace

TEST_SUITE("light-interreflection") {
    TEST_CASE("a glowing sphere with a black port (F2)") {
        PortedSphere sphere = portedSphere(4);
        const auto scene = compiled(std::move(sphere.scene));
        const CameraDesc camera = probe({0.1, -0.97, 0.15}, {0.1, -1, 0.1}, .5, .2);
        checkEqual(measure(*scene, camera, settings(2048), "light"), sphere.radiance, 0.1, 1e-3);
        checkEqual(measureOn(*scene, camera, "L D+ E", 2048), sphere.radiance - 1, 0.1, 1e-3);
        checkEqual(measureOn(*scene, camera, "L D E", 8192), .9 * (1 - sphere.open), 0.1, 1e-3);
    }

    TEST_CASE("infinite parallel plates, built of diffuse plates between mirrors (F6: A18)") {
        SceneDesc s;
        const int lamp = shapes::add(s, shapes::lamp("plate 1", Spectrum(1), Spectrum(0.5f))),
                  other = shapes::add(s, shapes::diffuse("plate 2", Spectrum(0.8f)));
        const int mirror = shapes::add(s, shapes::metal("mirror", Spectrum(1), 0));
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1}) shapes::add(s, "face", cubeFace(axis, side), axis != 1 ? mirror : side == 1 ? lamp : other);
        const auto scene = compiled(std::move(s));
        const CameraDesc up = probe({.1, .5, .05}, {0, 1, 0}, .3, .3), down = probe({.1, -.5, .05}, {0, -1, 0}, .3, .3);
        checkEqual(measure(*scene, up, settings(2048), "light"), 5. / 3, 0.05);
        checkEqual(measure(*scene, down, settings(2048), "light"), 4. / 3, 0.05);
        checkEqual(measureOn(*scene, down, "L S* D E", 2048), .8, 0.06); // all that plate 1 sends falls on plate 2
    }

    TEST_CASE("concentric spheres (F6: A19)") {
        for (const auto& [inner, outer] : {std::pair{1.0, .2}, {10. / 9, 2. / 9}}) {
            const bool black = inner == 1.0;
            CAPTURE(black);
            SceneDesc s;
            shapes::add(s, "inner", shapes::sphere(0.5, 4),
                        shapes::add(s, shapes::lamp("inner", Spectrum(1), Spectrum(black ? 0.f : 0.5f))));
            shapes::add(s, "outer", shapes::insideOut(shapes::sphere(1, 5)), shapes::add(s, shapes::diffuse("outer", Spectrum(0.5f))));
            const auto scene = compiled(std::move(s));
            checkEqual(measure(*scene, probe({0, -.99, 0}, {0, -1, 0}, .3, .2), settings(2048), "light"), outer, 0.15, 3e-3);
            checkEqual(measure(*scene, probe({0, -.5, 0}, {0, 1, 0}, .2, .2), settings(2048), "light"), inner, 0.05, 2e-3);
        }
    }

    TEST_CASE("a hemisphere closed by an emissive lid (F6: A20)") {
        SceneDesc s;
        shapes::add(s, "dome", upperDome(5), shapes::add(s, shapes::diffuse("dome", Spectrum(0.5f))));
        shapes::add(s, "lid", plate({0, 0, 0}, {0, 1, 0}, 1.1), shapes::add(s, shapes::lamp("lid", Spectrum(1), Spectrum(0.5f))));
        const auto scene = compiled(std::move(s));
        checkEqual(measure(*scene, probe({.2, 0, .1}, {0, -1, 0}, .3, .3), settings(2048), "light"), 1.2, 0.05, 2e-3);
        checkEqual(measure(*scene, probe({.05, .97, .04}, {0, 1, 0}, .3, .2), settings(4096), "light"), .4, 0.1, 3e-3);
    }
} // TEST_SUITE
