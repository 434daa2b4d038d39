// Stochastic progressive photon mapping: its radii, its consistency, its state.
#include "core/render/archive.h"
#include "integrators/photon_field.h"
#include "integrators/sppm_radius.h"
#include "tests/render/measure.h"
#include "tests/statistics.h"
#include <numbers>
#include <sstream>

using namespace chiaro;
using namespace chiaro::test;
using doctest::Approx;

namespace {

constexpr double pi64 = std::numbers::pi;

std::unique_ptr<const Scene> room() {
    SceneDesc s;
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 1), shapes::add(s, shapes::diffuse("grey", {.7f, .6f, .5f})));
    shapes::add(s, "wall", plate({0, 1, -1}, {0, 0, 1}, 1), shapes::add(s, shapes::diffuse("red", {.8f, .3f, .2f})));
    shapes::add(s, "ball", shapes::sphere(.3, 3), shapes::add(s, shapes::glass("glass", 1.5f)), shapes::translation({.2, .4, 0}));
    shapes::add(s, "lamp", square(.3), shapes::add(s, shapes::lamp("lamp", Spectrum(8))),
                shapes::translation({.2, 1.8, .4}) * rotation({1, 0, 0}, pi64 / 2));
    return compiled(std::move(s));
}
const CameraDesc view = perspective({.1, .4, 2}, {0, -.3, 0}, .75);

} // namespace

TEST_SUITE("sppm") {
    TEST_CASE("the radii of the global schedule, alpha 2/3 (G5)") {
        CHECK(progressiveArea(0, 2. / 3) == Approx(1));
        CHECK(progressiveArea(9, 2. / 3) == Approx(.5085158).epsilon(1e-7));
        CHECK(progressiveArea(99, 2. / 3) == Approx(.2383888).epsilon(1e-7));
        CHECK(progressiveArea(999, 2. / 3) == Approx(.1107609).epsilon(1e-6));
        double product = 1, mean = 0, at1000 = 0;
        for (int i = 1; i <= 100000; ++i) {
            mean += product;
            if (i == 1000) at1000 = mean / i;
            product *= (i + 2. / 3) / (i + 1);
            if (i == 63) CHECK(progressiveArea(63, 2. / 3) == Approx(product).epsilon(1e-10));
        }
        // The bias of the mean picture goes with the mean area: N^(-1/3).
        CHECK(std::log10(mean / 100000 / at1000) / 2 == Approx(-1. / 3).epsilon(0.03));
    }
    TEST_CASE("pixels of their own statistics shrink as much on even light, but for the first iteration: all its photons are new") {
        PixelStatistics pixel{1, 0};
        pixel.add(0, .667f);
        CHECK(pixel.radius2 == 1);
        // Hachisuka and Jensen's example: of 10 + 6 photons 10 + 4 are kept.
        PixelStatistics one{2, 10};
        one.add(6, 2.f / 3);
        CHECK(double(one.kept) == Approx(14));
        CHECK(double(one.radius2) == Approx(2 * 14. / 16));
        stats::Moments areas;
        for (int s = 0; s < 50; ++s) {
            PixelStatistics p{1, 0};
            for (int i = 0; i < 100; ++i) { // Poisson numbers about 200 r^2
                Sampler u(uint64_t(s), SamplerKind::independent, Stream::chain, uint64_t(i), 0);
                double limit = std::exp(-200 * double(p.radius2)), product = 1;
                int found = -1;
                for (; product > limit; ++found) product *= 1 - double(u.get1D());
                p.add(float(found), 2.f / 3);
            }
            areas.add(double(p.radius2));
        }
        CHECK(areas.mean == Approx(.2383888 * 2 / 3).epsilon(0.05));
    }
    TEST_CASE("the radii of a render are those, in either schedule") {
        const auto scene = room();
        for (const char* schedule : {"global", "pixel"}) {
            Bench bench(*scene, view, {8, 8, 16, {}, 2});
            FilmLayout layout = bench.layout();
            layout.photons = true;
            Film film(layout);
            bench.render(film, std::string("sppm:radius=0.3,count=2k,schedule=") + schedule);
            double mean = 0;
            for (int i = 0; i < 16; ++i) mean += .3 * std::sqrt(progressiveArea(uint64_t(i), 2. / 3)) / 16;
            if (std::string(schedule) == "global")
                CHECK(double(film.gathered({4, 6}).radius) == Approx(mean).epsilon(1e-4));
            else
                CHECK(double(film.gathered({4, 6}).radius) == Approx(mean).epsilon(0.1));
        }
    }
    TEST_CASE("the same bits for any number of threads, in one run or in several, saved and continued") {
        const auto scene = room();
        for (const std::string name : {"sppm", "sppm:schedule=pixel"}) {
            CAPTURE(name);
            Settings how{19, 14, 6, {2, 1, 18, 13}, 1, 7, SamplerKind::sobol, FilterKind::blackmanHarris};
            const Rendering one = rendered(*scene, view, how, name);
            how.threads = 3;
            CHECK(samePicture(*one.film, *rendered(*scene, view, how, name).film));

            // Three iterations in passes of 1 and 2, kept, and three more by a fresh integrator.
            Bench bench(*scene, view, how);
            const IntegratorChoice choice = chooseIntegrator(name);
            Film film(bench.layout());
            const auto first = choice.entry->make(choice.options);
            chiaro::render(bench.job, *first, film, {3, infinity}, bench.stop);
            std::stringstream file;
            Writer writer(file);
            first->save(writer);
            const auto second = choice.entry->make(choice.options);
            second->prepare(bench.job);
            std::istringstream from(file.str());
            Reader reader(from, "sppm.chk", file.str().size());
            second->load(bench.job, reader);
            second->render(bench.job, {3, 6, nullptr}, film);
            film.setDone(6);
            CHECK(samePicture(*one.film, film));

            const auto other = chooseIntegrator("sppm:schedule=" + std::string(name == "sppm" ? "pixel" : "global"));
            const auto third = other.entry->make(other.options);
            third->prepare(bench.job);
            std::istringstream wrong(file.str());
            Reader bad(wrong, "sppm.chk", file.str().size());
            CHECK_THROWS_AS(third->load(bench.job, bad), Error);
        }
    }
    TEST_CASE("nothing grows over 1,000 iterations: the bytes of photons, cells and pixels") {
        const auto scene = room();
        for (const char* schedule : {"global", "pixel"}) {
            CAPTURE(schedule);
            Bench bench(*scene, view, {8, 8, 1000, {}, 2});
            const IntegratorChoice choice = chooseIntegrator(std::string("sppm:count=500,schedule=") + schedule);
            const auto integrator = choice.entry->make(choice.options);
            const auto& source = dynamic_cast<const PhotonSource&>(*integrator);
            integrator->prepare(bench.job);
            Film film(bench.layout());
            const auto saved = [&] {
                std::stringstream file;
                Writer writer(file);
                integrator->save(writer);
                return file.str().size();
            };
            uint32_t done = 0;
            std::size_t most = 0, state = 0;
            for (const uint32_t end : {1u, 10u, 100u, 1000u}) {
                integrator->render(bench.job, {done, end, nullptr}, film);
                done = end;
                // 32 bytes a photon; a cell for every two of them, or where a table of all cells is small, that.
                std::size_t photons = 0, maps = 0;
                for (const PhotonMapView& map : source.photonMaps()) photons += map.photons.size(), ++maps;
                CHECK(source.photonBytes() <= 40 * photons + maps * 4 * 4097 + 64 * sizeof(PixelStatistics));
                if (end == 1) most = photons, state = saved();
                CHECK(double(photons) == Approx(double(most)).epsilon(0.25)); // of 500 paths each time
                CHECK(saved() == state);
            }
        }
    }
}
