// Where the samples of a pixel lie, and what must not change a picture of `whitted`: seeds, threads, batches, passes (H5, H7).
#include "integrators/whitted_adaptive.h"
#include "scenes/builtin.h"
#include "tests/render/whitted_kit.h"

using namespace chiaro;
using namespace chiaro::test;

namespace {

// One pixel of a plane that glows with 1 left of `edge` (in pixels from its left side) and is black on the right.
std::unique_ptr<const Scene> edgeAt(double edge) {
    SceneDesc s;
    const int lit = shapes::add(s, shapes::lamp("lit", Spectrum(1))), dark = shapes::add(s, shapes::diffuse("dark", Spectrum(0)));
    const double x = edge - .5;
    shapes::add(s, "lit", shapes::quad({-50, -50, 0}, {x, -50, 0}, {x, 50, 0}, {-50, 50, 0}), lit);
    shapes::add(s, "dark", shapes::quad({x, -50, 0}, {50, -50, 0}, {50, 50, 0}, {x, 50, 0}), dark);
    return compiled(std::move(s));
}
CameraDesc onePixel() { return probe({0, 0, 0}, {0, 0, -1}, 1, .5); }

struct Spread {
    double mean = 0, variance = 0;
};
// Over seeds.
Spread over(const std::string& integrator, uint32_t spp) {
    const auto scene = edgeAt(.3);
    const CameraDesc camera = moved(*scene, onePixel());
    Spread s;
    constexpr int n = 2000;
    for (int seed = 0; seed < n; ++seed) {
        Settings how{1, 1, spp};
        how.seed = uint64_t(seed);
        how.sampler = SamplerKind::independent;
        const double v = rendered(*scene, camera, how, integrator).mean[0];
        s.mean += v / n;
        s.variance += v * v / n;
    }
    s.variance -= s.mean * s.mean;
    return s;
}

Rendering picture(const Scene& scene, const std::string& integrator, Settings how = {40, 40, 4}) {
    return rendered(scene, scene.cameras()[0], how, integrator);
}

} // namespace

TEST_SUITE("whitted-pixels") {

    TEST_CASE("an edge at .3 of a pixel by each pattern of 16 (H5, H7)") {
        const Spread centre = over("whitted:aa=centre", 1), grid = over("whitted:aa=grid", 16), jitter = over("whitted:aa=jitter", 16),
                     poisson = over("whitted:aa=poisson", 16), random = over("whitted", 16);
        CHECK(centre.mean == 0);
        CHECK(centre.variance == 0);
        CHECK(grid.mean == doctest::Approx(.25));
        CHECK(grid.variance < 1e-12);
        CHECK(jitter.mean == doctest::Approx(.3).epsilon(.02));
        CHECK(jitter.variance == doctest::Approx(.0025).epsilon(.15));
        CHECK(poisson.mean == doctest::Approx(.3).epsilon(.02));
        CHECK(poisson.variance < .006);
        CHECK(random.mean == doctest::Approx(.3).epsilon(.03));
        CHECK(random.variance == doctest::Approx(.013125).epsilon(.15));
    }

    TEST_CASE("adaptive: all samples where the picture changes, the first ones elsewhere; the same at every cut into passes") {
        const auto scene = edgeAt(.3);
        Settings how{16, 4, 64};
        CameraDesc camera = moved(*scene, onePixel());
        camera.xmag = 8;
        camera.ymag = 2;
        const std::string adaptive = "whitted:aa=adaptive,aa-samples=64";
        const Rendering r = rendered(*scene, camera, how, adaptive);
        for (uint32_t x = 0; x < 16; ++x) {
            CAPTURE(x);
            const bool besideTheEdge = x >= 6 && x <= 8;
            CHECK(r.film->count({x, 1}) == (besideTheEdge ? 64 : AdaptivePasses::firstSamples(64)));
            if (x != 7) CHECK(r.film->mean({x, 1})[0] == (x < 7 ? 1 : 0));
        }
        CHECK(r.film->mean({7, 1})[0] == doctest::Approx(.8).epsilon(.05));
        // One by one.
        Bench bench(*scene, camera, how);
        Film film(bench.layout());
        const IntegratorChoice choice = chooseIntegrator(adaptive);
        const auto integrator = choice.entry->make(choice.options);
        integrator->prepare(bench.job);
        for (uint32_t i = 0; i < 64; ++i) integrator->render(bench.job, {i, i + 1}, film);
        CHECK(samePicture(*r.film, film));
    }

    TEST_CASE("no variance where nothing is drawn: any seed, any number of samples") {
        for (const char* name : {"@cornell", "@cornell-spheres"}) {
            CAPTURE(name);
            const auto scene = compiled(findBuiltin(name)->make());
            for (const char* how : {"whitted:aa=centre", "whitted:aa=grid,aa-samples=4", "whitted:aa=adaptive,aa-samples=8"}) {
                CAPTURE(how);
                CHECK(chooseIntegrator(how).entry->traits(chooseIntegrator(how).options).deterministic);
                Settings s{24, 24, 8};
                const Rendering first = picture(*scene, how, s);
                s.seed = 77;
                CHECK(samePicture(*first.film, *picture(*scene, how, s).film));
            }
            const Rendering one = picture(*scene, "whitted:aa=centre", {24, 24, 1}),
                            four = picture(*scene, "whitted:aa=centre", {24, 24, 4});
            for (uint32_t i = 0; i < 24 * 24; ++i) CHECK(one.film->mean({i % 24, i / 24}) == four.film->mean({i % 24, i / 24}));
        }
    }

    TEST_CASE("one, two and five threads, batches of one and of 256: the same bits") {
        const auto scene = compiled(findBuiltin("@cornell-spheres")->make());
        for (const char* how : {"whitted", "whitted:area=sample", "whitted:aa=poisson"}) {
            CAPTURE(how);
            Settings s{40, 40, 4};
            const Rendering one = picture(*scene, how, s);
            for (const unsigned threads : {2u, 5u}) {
                s.threads = threads;
                CHECK(samePicture(*one.film, *picture(*scene, how, s).film));
            }
            s.threads = 1;
            Bench bench(*scene, scene->cameras()[0], s);
            FilmLayout layout = bench.layout();
            layout.costs = true; // the loop hands over one sample at a time
            Film alone(layout);
            bench.render(alone, how);
            CHECK(samePicture(*one.film, alone));
            double rays = 0, depth = 0;
            for (uint32_t i = 0; i < 40 * 40; ++i) {
                rays += double(alone.cost({i % 40, i / 40}).rays) / 1600;
                depth = std::max(depth, double(alone.cost({i % 40, i / 40}).depth));
            }
            CHECK(rays > 2);
            CHECK(depth > 4);
        }
    }

    TEST_CASE("a smaller weight only takes away what it says") {
        const auto scene = compiled(findBuiltin("@cornell-spheres")->make());
        const Rendering whole = picture(*scene, "whitted:aa=centre,min-weight=0", {32, 32, 1}),
                        cut = picture(*scene, "whitted:aa=centre,min-weight=.01", {32, 32, 1});
        for (uint32_t i = 0; i < 32 * 32; ++i) {
            const Pixel p{i % 32, i / 32};
            for (std::size_t c = 0; c < 3; ++c) {
                CHECK(cut.film->mean(p)[c] <= whole.film->mean(p)[c] * 1.00001f + 1e-6f);
                CHECK(whole.film->mean(p)[c] - cut.film->mean(p)[c] <= .01f * 18.4f * 8); // w L_max, a handful of leaves
            }
        }
    }

    TEST_CASE("options that cannot be are refused") {
        for (const auto& [text, part] : {std::pair{"whitted:aa=grid,aa-samples=10", "give 9 or 16"},
                                         {"whitted:area=middle", "none of centre, sample"},
                                         {"whitted:aa-samples=5000", "out of range"},
                                         {"whitted:min-wieght=1", "did you mean min-weight?"}}) {
            CAPTURE(text);
            try {
                const IntegratorChoice choice = chooseIntegrator(text);
                choice.entry->make(choice.options);
                CHECK(false);
            } catch (const Error& e) {
                CHECK(e.code == Exit::usage);
                CHECK(std::string(e.what()).find(part) != std::string::npos);
            }
        }
    }

} // TEST_SUITE
