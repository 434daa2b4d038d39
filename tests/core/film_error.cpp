// The error that a film reports of itself, against numbers worked out by hand and against the true spread of independent pictures.
#include "core/render/film.h"
#include "tests/statistics.h"
#include <cmath>
#include <doctest/doctest.h>

using namespace chiaro;

namespace {

void add(Film& film, Pixel p, uint32_t sample, const Spectrum& v) {
    Outputs o(film.layout());
    o.add(1, v);
    film.add(p, sample, o);
}
Film blank(uint32_t w, uint32_t h) { return Film(FilmLayout{w, h, {0, 0, w, h}, {}, false}); }

} // namespace

TEST_SUITE("film-error") {

    TEST_CASE("standard error: half the difference of the halves, pooled over 8 x 8 pixels") {
        Film film(FilmLayout{9, 1, {0, 0, 9, 1}, {}, false});
        for (uint32_t x = 0; x < 9; ++x)
            for (uint32_t s = 0; s < 2; ++s) add(film, {x, 0}, s, Spectrum(5));
        Film other(film.layout());
        // Pixel 0: halves 1 and 3; pixel 1: halves 2 and 2 in green; pixel 8 lies in the next block: halves 10 and 4.
        add(other, {0, 0}, 0, {1, 0, 7});
        add(other, {0, 0}, 1, {3, 0, 7});
        add(other, {1, 0}, 0, {2, 0, 7});
        add(other, {1, 0}, 1, {2, 8, 7});
        add(other, {8, 0}, 0, Spectrum(10));
        add(other, {8, 0}, 1, Spectrum(4));
        CHECK(film.standardError()[3] == Spectrum(0));
        const std::vector<Spectrum> e = other.standardError();
        REQUIRE(e.size() == 9);
        for (const std::size_t x : {0u, 1u, 7u}) { // pixels 2 to 7 have no samples and do not count
            CHECK(e[x][0] == doctest::Approx(std::sqrt(0.5)));
            CHECK(e[x][1] == doctest::Approx(std::sqrt(8.0)));
            CHECK(e[x][2] == 0);
        }
        CHECK(e[8] == Spectrum(3));
    }

    TEST_CASE("one half alone knows no error") {
        Film film(FilmLayout{1, 1, {0, 0, 1, 1}, {}, false});
        CHECK(film.standardError()[0] == Spectrum(0));
        CHECK(std::isnan(film.noise()));
        add(film, {0, 0}, 0, Spectrum(1));
        film.setDone(1);
        CHECK(film.standardError()[0] == Spectrum(0));
        CHECK(std::isnan(film.noise()));
    }

    TEST_CASE("mean luminance, its error, and the relative noise") {
        Film film(FilmLayout{2, 2, {0, 0, 2, 2}, {}, false});
        const float even[] = {1, 2, 3, 4}, odd[] = {3, 2, 1, 8};
        for (uint32_t i = 0; i < 4; ++i) {
            add(film, {i % 2, i / 2}, 0, Spectrum(even[i]));
            add(film, {i % 2, i / 2}, 1, Spectrum(odd[i]));
        }
        film.setDone(2); // at once: there was no doubling, the halves speak
        const Film::Mean m = film.meanLuminance();
        CHECK(m.value == doctest::Approx((2 + 2 + 2 + 6) / 4.0));
        CHECK(m.error == doctest::Approx(std::sqrt(1.0 + 0 + 1 + 4) / 4)); // errors of pixels 1 0 1 2, independent
        CHECK(film.noise() == doctest::Approx(std::sqrt((1.0 + 0 + 1 + 4) / 4) / 0.9399856 / 3));
        Film green(FilmLayout{1, 1, {0, 0, 1, 1}, {}, false});
        add(green, {0, 0}, 0, {0, 1, 0});
        CHECK(green.meanLuminance().value == doctest::Approx(0.7152));
    }

    TEST_CASE("under independent samples the reported error is the true one") {
        constexpr uint32_t side = 32, samples = 16;
        stats::Moments truth, reported, pixelTruth, pixelReported;
        for (uint64_t replica = 0; replica < 200; ++replica) {
            Film film = blank(side, side);
            stats::Random u(replica + 1);
            for (uint32_t y = 0; y < side; ++y)
                for (uint32_t x = 0; x < side; ++x)
                    for (uint32_t s = 0; s < samples; ++s) add(film, {x, y}, s, Spectrum(u()));
            film.setDone(samples);
            const Film::Mean m = film.meanLuminance();
            truth.add(m.value);
            reported.add(m.error * m.error);
            pixelTruth.add(double(film.mean({5, 6})[0]));
            pixelReported.add(double(sqr(film.standardError()[5 + 6 * side][0])));
        }
        // A variance from 200 replicas is known to 10 %.
        const double pixel = 1 / 12.0 / samples, whole = pixel / (side * side);
        CHECK(reported.mean == doctest::Approx(whole).epsilon(0.02));
        CHECK(truth.variance() == doctest::Approx(whole).epsilon(0.4));
        CHECK(pixelReported.mean == doctest::Approx(pixel).epsilon(0.05));
        CHECK(pixelTruth.variance() == doctest::Approx(pixel).epsilon(0.4));
    }

    // 200 pictures of 32 x 32 pixels with 16 samples, sample(u, pixel, index); looks at powers of two, as render() does.
    template <class Sample> void againstTruth(Sample && sample, double least, double most) {
        constexpr uint32_t side = 32, samples = 16;
        stats::Moments truth, reported;
        for (uint64_t replica = 0; replica < 200; ++replica) {
            Film film = blank(side, side);
            stats::Random u(replica + 1);
            for (uint32_t s = 0; s < samples; ++s) {
                for (uint32_t y = 0; y < side; ++y)
                    for (uint32_t x = 0; x < side; ++x) add(film, {x, y}, s, Spectrum(sample(u, Pixel{x, y}, s)));
                film.setDone(s + 1);
            }
            const Film::Mean m = film.meanLuminance();
            truth.add(m.value);
            reported.add(m.error * m.error);
            CHECK(film.noiseBound() > film.noise());
        }
        CAPTURE(truth.variance());
        CHECK(reported.mean > least * truth.variance());
        CHECK(reported.mean < most * truth.variance());
    }

    TEST_CASE("how far the picture moves when samples double tells its error: independent samples") {
        againstTruth([](stats::Random& u, Pixel, uint32_t) { return u(); }, 0.75, 1.3);
    }

    TEST_CASE("stratified samples: the halves would report several times the error, the movement does not") {
        // Sample s of a scrambled van der Corput sequence in every pixel: the variance of its prefixes falls as n^-3.
        std::vector<std::vector<float>> points(32 * 32);
        againstTruth(
            [&](stats::Random& u, Pixel p, uint32_t s) {
                std::vector<float>& own = points[p.y * 32 + p.x];
                if (s == 0) {
                    own.clear();
                    std::vector<uint32_t> cells{0}; // nested: every new point goes where none is
                    for (uint32_t bit = 1; bit < 16; bit *= 2) {
                        std::vector<uint32_t> more;
                        for (uint32_t& c : cells) {
                            const uint32_t flip = uint32_t(u() * 2);
                            c = 2 * c + flip;
                            more.push_back(c ^ 1);
                        }
                        cells.insert(cells.end(), more.begin(), more.end());
                    }
                    for (const uint32_t c : cells) own.push_back((float(c) + u()) / 16);
                }
                return own[s];
            },
            0.7, 8);
    }

    TEST_CASE("where pixels share their samples, blocks of them speak") {
        float shared = 0;
        againstTruth(
            [&](stats::Random& u, Pixel p, uint32_t) {
                if (p.x % 8 == 0) shared = u(); // eight pixels in a row have the same value
                return shared;
            },
            0.7, 1.5);
    }

    TEST_CASE("an error that lies in one pixel is known with few degrees of freedom") {
        Film film = blank(16, 16);
        stats::Random u(7);
        for (uint32_t s = 0; s < 16; ++s) {
            for (uint32_t y = 0; y < 16; ++y)
                for (uint32_t x = 0; x < 16; ++x) add(film, {x, y}, s, Spectrum(x == 3 && y == 4 ? 1000 * u() : 1 + 0.01f * u()));
            film.setDone(s + 1);
        }
        CHECK(film.meanLuminance().dof < 1.5);
        CHECK(film.noiseBound() > 1.5 * film.noise());
        Film flat = blank(4, 4);
        for (uint32_t s = 0; s < 4; ++s) {
            for (uint32_t i = 0; i < 16; ++i) add(flat, {i % 4, i / 4}, s, Spectrum(0));
            flat.setDone(s + 1);
        }
        CHECK(flat.noise() == 0); // black: nothing to wait for
        CHECK(flat.noiseBound() == 0);
    }
}
