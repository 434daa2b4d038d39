// The tile loop: no bit of a picture depends on the width of batches, the number of threads, the cut of passes or where a render was
// resumed; one sample can be made again exactly.
#include "tests/scene_kit.h"
#include <doctest/doctest.h>
#include <map>
#include <mutex>
#include <tuple>

using namespace chiaro;
using namespace chiaro::test;

namespace {

SceneDesc room() {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.6f, 0.5f, 0.4f))),
              lamp = shapes::add(d, shapes::lamp("lamp", Spectrum(9)));
    shapes::add(d, "room", shapes::insideOut(shapes::box({2, 2, 2})), grey);
    shapes::add(d, "lamp", square(0.5), lamp, shapes::translation({0, 1.9, 0}) * rotation({1, 0, 0}, std::numbers::pi / 2));
    const Affine places[] = {shapes::translation({0.7, -1, 0}), shapes::translation({-0.8, -0.5, -0.6}) * scaling(1, 2, 1)};
    addInstances(d, shapes::sphere(0.5, 2), grey, places);
    shapes::addCamera(d, "main", 0.9, shapes::translation({0, 0, 1.9}));
    return d;
}
const Scene& theRoom() {
    static const auto scene = compiled(room());
    return *scene;
}
Settings small() {
    Settings s;
    s.width = 37;
    s.height = 21;
    s.spp = 6;
    s.filter = FilterKind::blackmanHarris;
    return s;
}
// Path tracing through forEachBatch with batches of another width, in the passes given by their ends.
std::unique_ptr<Film> batched(const Settings& s, uint32_t width, const std::vector<uint32_t>& ends, const SampleMask* mask = nullptr) {
    Bench bench(theRoom(), theRoom().cameras()[0], s);
    const IntegratorChoice choice = chooseIntegrator("path");
    const auto integrator = choice.entry->make(choice.options);
    const auto& path = dynamic_cast<const CameraIntegrator&>(*integrator);
    integrator->prepare(bench.job);
    auto film = std::make_unique<Film>(bench.layout());
    Starts starts = path.starts(bench.job);
    starts.width = width;
    uint32_t begin = 0;
    for (const uint32_t end : ends) {
        const Pass pass{begin, end, mask};
        forEachBatch(
            bench.job, pass, *film, [&](std::span<PathStart> p, std::span<Outputs> o) { path.radianceWide(bench.job, p, o); }, starts);
        begin = end;
    }
    return film;
}

} // namespace

TEST_SUITE("batch") {

    TEST_CASE("the same bits for any width, number of threads and cut of passes") {
        const auto reference = batched(small(), 256, {6});
        CHECK(luminance(meanOf(*reference)) > 0.05f);
        for (const unsigned threads : {1u, 2u, 5u})
            for (const uint32_t width : {0u, 1u, 7u, 16u, 256u, 100'000u})
                for (const std::vector<uint32_t>& ends : {std::vector<uint32_t>{6}, {1, 2, 4, 6}, {5, 6}}) {
                    Settings s = small();
                    s.threads = threads;
                    CAPTURE(threads);
                    CAPTURE(width);
                    CHECK(samePicture(*reference, *batched(s, width, ends)));
                }
    }

    TEST_CASE("passes that overlap take no sample twice; a film is continued where each pixel stands") {
        const auto reference = batched(small(), 64, {6});
        Bench bench(theRoom(), theRoom().cameras()[0], small());
        const IntegratorChoice choice = chooseIntegrator("path");
        const auto integrator = choice.entry->make(choice.options);
        Film film(bench.layout());
        // A stop in the middle of a pass: some tiles are done, the others not.
        StopToken& stop = bench.stop;
        std::atomic<int> batches{0};
        const auto& path = dynamic_cast<const CameraIntegrator&>(*integrator);
        forEachBatch(bench.job, {0, 4, nullptr}, film, [&](std::span<PathStart> p, std::span<Outputs> o) {
            path.radianceWide(bench.job, p, o);
            if (++batches == 9) stop.request();
        });
        CHECK(film.next({0, 0}) == 4);
        CHECK(film.next({36, 20}) == 0);
        Bench again(theRoom(), theRoom().cameras()[0], small());
        integrator->render(again.job, {0, 4, nullptr}, film);
        integrator->render(again.job, {2, 6, nullptr}, film);
        CHECK(samePicture(*reference, film));
    }

    TEST_CASE("films of disjoint sample ranges, merged, and crops are parts of the one picture") {
        const auto reference = batched(small(), 64, {6});
        Bench bench(theRoom(), theRoom().cameras()[0], small());
        const IntegratorChoice choice = chooseIntegrator("path");
        const auto integrator = choice.entry->make(choice.options);
        Film a(bench.layout()), b(bench.layout());
        integrator->render(bench.job, {0, 3, nullptr}, a);
        integrator->render(bench.job, {3, 6, nullptr}, b);
        b.merge(a);
        CHECK(samePicture(*reference, b));
        Settings s = small();
        s.crop = {11, 3, 30, 20};
        const auto part = batched(s, 256, {6});
        int wrong = 0;
        for (uint32_t y = 3; y < 20; ++y)
            for (uint32_t x = 11; x < 30; ++x) wrong += !(part->mean({x, y}) == reference->mean({x, y}));
        CHECK(wrong == 0);
    }

    TEST_CASE("a mask takes its pixels and leaves the others") {
        const Rect crop{0, 0, 37, 21};
        std::vector<bool> active;
        for (uint32_t y = 0; y < 21; ++y)
            for (uint32_t x = 0; x < 37; ++x) active.push_back((x + y) % 3 == 0);
        const SampleMask mask(crop, active);
        const auto reference = batched(small(), 256, {6}), masked = batched(small(), 16, {4, 6}, &mask);
        int wrong = 0;
        for (uint32_t y = 0; y < 21; ++y)
            for (uint32_t x = 0; x < 37; ++x) {
                const bool on = (x + y) % 3 == 0;
                wrong += masked->count({x, y}) != (on ? 6 : 0) || (on && !(masked->mean({x, y}) == reference->mean({x, y})));
            }
        CHECK(wrong == 0);
    }

    TEST_CASE("startPixel makes exactly the sample that the tile loop made") {
        Settings s = small();
        s.width = 20;
        s.height = 18;
        Bench bench(theRoom(), theRoom().cameras()[0], s);
        const IntegratorChoice choice = chooseIntegrator("path");
        const auto integrator = choice.entry->make(choice.options);
        const auto& path = dynamic_cast<const CameraIntegrator&>(*integrator);
        std::map<std::tuple<uint32_t, uint32_t, uint32_t>, std::pair<Ray, Spectrum>> made;
        Film film(bench.layout());
        forEachBatch(bench.job, {0, 4, nullptr}, film, [&](std::span<PathStart> p, std::span<Outputs> o) {
            std::vector<Ray> rays;
            for (const PathStart& start : p) rays.push_back(start.ray);
            path.radianceWide(bench.job, p, o);
            for (std::size_t i = 0; i < p.size(); ++i) made[{p[i].pixel.x, p[i].pixel.y, p[i].sample}] = {rays[i], o[i].total()};
        });
        CHECK(made.size() == 20 * 18 * 4);
        int wrong = 0;
        for (const auto& [key, was] : made) {
            const auto [x, y, sample] = key;
            PathStart start = startPixel(bench.job, {x, y}, sample);
            wrong += !(start.ray.o == was.first.o) || !(start.ray.d == was.first.d);
            Outputs out(bench.layout());
            path.radiance(bench.job, start, out);
            wrong += !(out.total() == was.second);
        }
        CHECK(wrong == 0);
    }

    TEST_CASE("starts: a pattern, one time for all, samples spread by the filter about the pixel's centre") {
        Settings s = small();
        Bench bench(theRoom(), theRoom().cameras()[0], s);
        const Point2 grid[] = {{0.25f, 0.25f}, {0.75f, 0.25f}, {0.25f, 0.75f}, {0.75f, 0.75f}};
        Starts how;
        how.pattern = grid;
        how.time = 0.125f;
        for (uint32_t sample = 0; sample < 8; ++sample) {
            const PathStart p = startPixel(bench.job, {5, 6}, sample, how);
            const Ray expected = bench.view.camera.ray({5 + grid[sample % 4].x, 6 + grid[sample % 4].y}, {0.5f, 0.5f}, 0.125f);
            CHECK(p.ray.d == expected.d);
            CHECK(p.ray.time == 0.125f);
            CHECK(p.sample == sample);
            CHECK(p.first.t > 0);
        }
        bench.job.shutter = {1, 3};
        double low = 3, high = 1;
        for (uint32_t sample = 0; sample < 64; ++sample) {
            const double time = double(startPixel(bench.job, {5, 6}, sample).ray.time);
            low = std::min(low, time);
            high = std::max(high, time);
        }
        CHECK(low >= 1);
        CHECK(high < 3);
        CHECK(high - low > 1.9);
        const PathStart chain = startPath(bench.job, {5.25f, 6.75f}, Sampler(0, SamplerKind::sobol, Stream::chain, 0, 0));
        CHECK(chain.pixel == Pixel{5, 6});
        CHECK(bool(chain.first));
    }

    TEST_CASE("the driver: passes reach the budget, stop at once when asked, and go on from where the film stands") {
        Settings s = small();
        const auto reference = batched(s, 256, {6});
        Bench first(theRoom(), theRoom().cameras()[0], s);
        Film film(first.layout());
        const IntegratorChoice choice = chooseIntegrator("path:wide=off"); // path by path, as batched() follows them
        const RenderResult none = render(first.job, *choice.entry->make(choice.options), film, {0, double(infinity)}, first.stop);
        CHECK(none.spp == 0);
        CHECK(none.ended == Ended::spp);
        const RenderResult one = render(first.job, *choice.entry->make(choice.options), film, {6, 0}, first.stop);
        CHECK(one.ended == Ended::time);
        CHECK(one.spp == 1); // a complete sample is taken before the clock may end it
        const RenderResult rest = render(first.job, *choice.entry->make(choice.options), film, {6, double(infinity)}, first.stop);
        CHECK(rest.ended == Ended::spp);
        CHECK(rest.spp == 6);
        CHECK(film.done() == 6);
        CHECK(samePicture(*reference, film));
        first.stop.request();
        CHECK(render(first.job, *choice.entry->make(choice.options), film, {9, double(infinity)}, first.stop).ended == Ended::stopped);
        CHECK(film.done() == 6);
    }
}
