// The film: exact sums whatever the order, halves, splats, the ledger of samples that were left out.
#include "core/render/film.h"
#include "core/render/executor.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <bit>
#include <cmath>
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

FilmLayout layout(uint32_t w, uint32_t h, std::vector<std::string> layers = {}, bool splats = false) {
    return {w, h, {0, 0, w, h}, std::move(layers), splats};
}
Outputs value(const Film& film, const Spectrum& v) {
    Outputs o(film.layout());
    o.add(1, v);
    return o;
}
Int128 reference(float v) { return Int128(std::nearbyint(std::ldexp(static_cast<long double>(v), 48))); } // ties to even by default

// A sample with a value of any magnitude that a film takes, the same for the same index.
Outputs anySample(const FilmLayout& l, Pixel p, uint32_t sample) {
    stats::Random u((uint64_t(p.y) << 40) ^ (uint64_t(p.x) << 20) ^ sample);
    const auto number = [&] { return std::ldexp(u() - 0.3f, int(u() * 70) - 35); };
    Outputs o(l);
    for (int i = 0; i < o.layers(); ++i) o.add(Layer(i + 1), {number(), number(), number()});
    o.aov(Aov::albedo, {u(), u(), u()});
    o.aov(Aov::normal, {u() * 2 - 1, u() * 2 - 1, u() * 2 - 1});
    return o;
}

} // namespace

TEST_SUITE("film") {

    TEST_CASE("toFixed rounds to the nearest multiple of 2^-48, ties to even") {
        std::vector<float> values = {0.f,      -0.f,      1.f,        -1.f,      0x1p-48f,  0x1p-49f,     0x1.8p-48f,      0x1p-50f,
                                     0x3p-49f, 0x5p-49f,  0x7p-49f,   -0x3p-49f, 0x1p-126f, 0x1.fffp-49f, 0x1.fffffep-49f, 0x1.000002p-49f,
                                     0x1p-25f, 0x1p-149f, -0x1p-140f, 0x1p-73f,  0x1p-74f,  0x1p-72f,     0x1.fffffep35f,  -0x1.fffffep35f};
        for (uint32_t k = 0; k < 4096; ++k) values.push_back(std::ldexp(float(k), -50)); // every tie and its neighbours
        stats::Random u(1);
        for (int i = 0; i < 200'000; ++i) {
            const float v = std::bit_cast<float>(uint32_t(u.next()));
            if (std::fabs(v) < fixedLimit) values.push_back(v);
        }
        int wrong = 0;
        for (const float v : values) wrong += toFixed(v) != reference(v) || toFixed(-v) != -toFixed(v);
        CHECK(wrong == 0);
        CHECK(toFixed(1.f) == Int128(1) << 48);
        CHECK(toFixed(0x1p-49f) == 0);
        CHECK(toFixed(0x3p-49f) == 2);
        CHECK(toFixed(0x1.fffffep35f) == (Int128(0xffffff) << 60));
    }

    TEST_CASE("fromFixed is the nearest double") {
        stats::Random u(2);
        int wrong = 0;
        for (int i = 0; i < 100'000; ++i) {
            const auto v = int64_t(u.next()) >> int(u() * 63);
            wrong += fromFixed(v) != double(std::ldexp(static_cast<long double>(v), -48));
        }
        CHECK(wrong == 0);
        CHECK(fromFixed(Int128(1) << 100) == 0x1p52);
        CHECK(fromFixed(-(Int128(3) << 110)) == -0x3p62);
    }

    TEST_CASE("a thousand orders and cuts into films give the same bits") {
        const FilmLayout l = layout(2, 1);
        constexpr uint32_t samples = 48;
        Film whole(l);
        for (uint32_t s = 0; s < samples; ++s)
            for (uint32_t x = 0; x < 2; ++x) whole.add({x, 0}, s, anySample(l, {x, 0}, s));
        stats::Random u(3);
        int different = 0;
        for (int round = 0; round < 1000; ++round) {
            std::vector<uint32_t> order(samples);
            std::iota(order.begin(), order.end(), 0u);
            for (uint32_t i = samples; i > 1; --i) std::swap(order[i - 1], order[u.next() % i]);
            const std::size_t cut = u.next() % samples;
            Film a(l), b(l);
            for (std::size_t i = 0; i < samples; ++i)
                for (uint32_t x = 0; x < 2; ++x) (i < cut ? a : b).add({x, 0}, order[i], anySample(l, {x, 0}, order[i]));
            a.merge(b);
            for (uint32_t x = 0; x < 2; ++x) {
                const Pixel p{x, 0};
                different += !(a.mean(p) == whole.mean(p)) || !(a.halfMean(p, Half::even) == whole.halfMean(p, Half::even)) ||
                             !(a.aov(p, Aov::normal) == whole.aov(p, Aov::normal)) || a.count(p) != whole.count(p);
            }
        }
        CHECK(different == 0);
    }

    TEST_CASE("halves are the even and the odd samples") {
        Film film(layout(1, 1));
        const float v[] = {1, 10, 3, 20, 5}; // even: 1 3 5, odd: 10 20
        for (uint32_t s = 0; s < 5; ++s) film.add({0, 0}, s, value(film, Spectrum(v[s])));
        CHECK(film.halfMean({0, 0}, Half::even) == Spectrum(3));
        CHECK(film.halfMean({0, 0}, Half::odd) == Spectrum(15));
        CHECK(film.mean({0, 0}) == Spectrum(39.f / 5));
        CHECK(film.count({0, 0}) == 5);
        CHECK(film.next({0, 0}) == 5);
    }

    TEST_CASE("merging disjoint ranges of samples gives the film of all, ledger included") {
        const FilmLayout l = layout(5, 3, {"a", "b"}, true);
        const auto fill = [&](Film& film, uint32_t begin, uint32_t end) {
            for (uint32_t s = begin; s < end; ++s)
                for (uint32_t y = 0; y < 3; ++y)
                    for (uint32_t x = 0; x < 5; ++x) {
                        Outputs o = anySample(l, {x, y}, s);
                        if ((x + y + s) % 7 == 0) o.add(2, Spectrum(std::nanf("")));
                        film.add({x, y}, s, o);
                        film.splat({x, y}, Layer(1 + s % 2), o.layer[0] * 0.25f, Half(s & 1));
                    }
            for (const Half h : {Half::even, Half::odd}) film.lightPaths(0.5 * (end - begin), h);
            film.setDone(end);
        };
        Film whole(l), a(l), b(l), c(l);
        fill(whole, 0, 20);
        fill(a, 0, 4);
        fill(b, 4, 11);
        fill(c, 11, 20);
        c.merge(a);
        c.merge(b);
        CHECK(samePicture(whole, c));
        CHECK(whole.dropped() > 16);
        CHECK(c.dropped() == whole.dropped());
        CHECK(c.droppedSamples() == whole.droppedSamples());
        CHECK(c.done() == 20);
        for (int k = 0; k < 2; ++k) CHECK(c.mean({3, 2}, k) == whole.mean({3, 2}, k));
    }

    TEST_CASE("splats of five threads give the bits of one") {
        const FilmLayout l = layout(8, 8, {}, true);
        const auto shoot = [&](const Executor& run) {
            auto film = std::make_unique<Film>(l);
            run.chunks(
                20'000,
                [&](uint64_t i) {
                    stats::Random u(i);
                    const Pixel p{uint32_t(u() * 8), uint32_t(u() * 8)};
                    film->splat(p, 1, Spectrum(std::ldexp(u() - 0.4f, int(u() * 60) - 30)), Half(i & 1));
                },
                nullptr);
            film->lightPaths(10'000, Half::even);
            film->lightPaths(10'000, Half::odd);
            return film;
        };
        const auto one = shoot(Executor(1)), five = shoot(Executor(5));
        CHECK(samePicture(*one, *five));
        CHECK(!black(one->mean({4, 4})));
    }

    TEST_CASE("splats are divided by the light paths of their half, also below zero") {
        Film film(layout(1, 1, {}, true));
        CHECK(film.mean({0, 0}) == Spectrum(0));
        film.splat({0, 0}, 1, Spectrum(6, -6, 3), Half::even);
        film.splat({0, 0}, 1, Spectrum(2, -2, 1), Half::odd);
        film.lightPaths(3, Half::even);
        film.lightPaths(1, Half::odd);
        CHECK(film.halfMean({0, 0}, Half::even) == Spectrum(2, -2, 1));
        CHECK(film.halfMean({0, 0}, Half::odd) == Spectrum(2, -2, 1));
        CHECK(film.mean({0, 0}) == Spectrum(2, -2, 1));
        film.add({0, 0}, 0, value(film, Spectrum(1)));
        CHECK(film.mean({0, 0}) == Spectrum(3, -1, 2));   // eye paths have their own divisor
        film.splat({0, 0}, 0, Spectrum(100), Half::even); // layer 0: not wanted
        CHECK(film.mean({0, 0}) == Spectrum(3, -1, 2));
    }

    TEST_CASE("samples that are not finite or too large are dropped, counted and located in order") {
        Film film(layout(4, 4));
        const float bad[] = {std::nanf(""), infinity, -infinity, 0x1p36f, -0x1p36f, 1e30f};
        const float good[] = {0x1.fffffep35f, -0x1.fffffep35f, 0, 0x1p-149f};
        for (uint32_t s = 0; s < 4; ++s) film.add({1, 1}, s, value(film, Spectrum(1, good[s], 1)));
        CHECK(film.dropped() == 0);
        std::vector<DroppedSample> expected;
        for (uint32_t s = 10; s-- > 4;) { // backwards: the ledger sorts
            film.add({3, s % 2}, s, value(film, Spectrum(1, 1, bad[s - 4])));
            film.add({2, 2}, s, value(film, Spectrum(bad[s - 4], 1, 1)));
        }
        for (uint32_t s = 4; s < 10; ++s) {
            expected.push_back({{3, s % 2}, s});
            expected.push_back({{2, 2}, s});
        }
        CHECK(film.dropped() == 12);
        CHECK(film.droppedSamples() == expected);
        CHECK(film.count({2, 2}) == 0);
        CHECK(film.mean({2, 2}) == Spectrum(0));
        Outputs albedo(film.layout());
        albedo.aov(Aov::albedo, Spectrum(0, std::nanf(""), 0));
        film.add({0, 0}, 0, albedo);
        CHECK(film.dropped() == 13);
        film.add({0, 0}, 1, value(film, Spectrum(4)));
        CHECK(film.count({0, 0}) == 1); // the mean is that of the samples kept
        CHECK(film.mean({0, 0}) == Spectrum(4));
        CHECK(film.next({0, 0}) == 2);
        for (uint32_t s = 100; s < 200; ++s) film.add({0, 0}, s, value(film, Spectrum(infinity)));
        CHECK(film.dropped() == 113);
        CHECK(film.droppedSamples().size() == 16);
        Film splats(layout(1, 1, {}, true));
        splats.splat({0, 0}, 1, Spectrum(std::nanf("")), Half::odd);
        CHECK(splats.dropped() == 1);
    }

    TEST_CASE("a crop keeps the coordinates of the whole picture") {
        FilmLayout l = layout(100, 50, {}, true);
        l.crop = {90, 40, 100, 50};
        Film film(l);
        film.add({90, 40}, 0, value(film, Spectrum(1)));
        film.add({99, 49}, 0, value(film, Spectrum(2)));
        film.lightPaths(1, Half::even);
        for (const Pixel outside : {Pixel{89, 45}, {100, 45}, {95, 39}, {95, 50}, {0, 0}})
            film.splat(outside, 1, Spectrum(100), Half::even);
        film.splat({95, 45}, 1, Spectrum(5), Half::even);
        CHECK(film.mean({90, 40}) == Spectrum(1));
        CHECK(film.mean({99, 49}) == Spectrum(2));
        CHECK(film.mean({95, 45}) == Spectrum(5));
        CHECK(film.meanLuminance().value == doctest::Approx(8.0 / 100));
        CHECK(film.standardError().size() == 100);
    }

    TEST_CASE("beauty is the sum of its layers as integers") {
        const FilmLayout l = layout(1, 1, {"emission", "direct", "indirect"});
        Film film(l);
        Outputs o(l);
        CHECK(o.layers() == 3);
        o.add(1, Spectrum(1));
        o.add(2, Spectrum(0x1p-24f));
        o.add(3, Spectrum(0x1p-24f));
        o.add(0, Spectrum(50)); // layer 0: not wanted
        film.add({0, 0}, 0, o);
        CHECK(film.mean({0, 0}, 0) == Spectrum(1));
        CHECK(film.mean({0, 0}, 2) == Spectrum(0x1p-24f));
        CHECK(film.mean({0, 0}) == Spectrum(1 + 0x1p-23f)); // a sum of the three floats would stay at 1
        CHECK(film.halfMean({0, 0}, Half::even) == Spectrum(1 + 0x1p-23f));
        Outputs alone(layout(1, 1, {"beauty"}));
        alone.add(1, Spectrum(2));
        alone.add(1, Spectrum(3));
        CHECK(alone.layers() == 1);
        CHECK(alone.total() == Spectrum(5));
    }

    TEST_CASE("bytes() counts what a film takes") {
        CHECK(layout(10, 10).bytes() == 100 * (96 + 48 + 12 + 4));
        CHECK(layout(10, 10, {"a", "b"}, true).bytes() == 100 * (2 * (96 + 144) + 48 + 12 + 4));
    }
}
