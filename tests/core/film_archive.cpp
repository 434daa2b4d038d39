// A film in a file: the same bits come back, and what is damaged is refused in one line.
#include "core/render/archive.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <cmath>
#include <doctest/doctest.h>
#include <sstream>

using namespace chiaro;
using namespace chiaro::test;

namespace {

std::string bytesOf(const Film& film) {
    std::ostringstream out;
    Writer writer(out);
    film.save(writer);
    return out.str();
}
std::unique_ptr<Film> filmOf(const std::string& bytes) {
    std::istringstream in(bytes);
    Reader reader(in, "a.chk", bytes.size());
    return Film::load(reader);
}
Exit refusal(const std::string& bytes) {
    try {
        filmOf(bytes);
    } catch (const Error& e) { return e.code; }
    return Exit::done;
}

FilmLayout everything() {
    FilmLayout l{40, 30, {3, 5, 33, 28}, {"a", "b"}, true};
    l.costs = l.photons = true;
    return l;
}
// Values of any size, some that need more than 64 bits, some that are dropped.
void fill(Film& film, uint32_t end) {
    const Rect c = film.layout().crop;
    while (film.done() < end) {
        const uint32_t s = film.done();
        for (uint32_t y = c.y0; y < c.y1; ++y)
            for (uint32_t x = c.x0; x < c.x1; ++x) {
                stats::Random u((uint64_t(y) << 40) ^ (uint64_t(x) << 20) ^ s);
                const auto number = [&] { return std::ldexp(u() - 0.3f, int(u() * 70) - 35); };
                Outputs o(film.layout());
                o.add(1, {number(), number(), number()});
                o.add(2, x % 5 == 0 && s % 3 == 0 ? Spectrum(infinity) : Spectrum(number()));
                o.aov(Aov::albedo, Spectrum(u()));
                o.rays = uint32_t(u() * 9);
                o.gathered = {u(), u(), u()};
                film.add({x, y}, s, o);
                film.splat({x, y}, Layer(1 + s % 2), Spectrum(number()), Half(s & 1));
            }
        film.lightPaths(0.375, Half(s & 1));
        film.setDone(s + 1);
    }
}

} // namespace

TEST_SUITE("film_archive") {

    TEST_CASE("a film comes back to the last bit, and goes on as if nothing had been") {
        Film whole(everything()), first(everything());
        fill(whole, 21);
        fill(first, 9);
        const std::string bytes = bytesOf(first);
        const std::unique_ptr<Film> again = filmOf(bytes);
        CHECK(bytesOf(*again) == bytes);
        CHECK(again->layout() == first.layout());
        CHECK(samePicture(*again, first));
        fill(*again, 21);
        CHECK(bytesOf(*again) == bytesOf(whole));
        CHECK(again->noise() == whole.noise());
        CHECK(again->meanLuminance().error == whole.meanLuminance().error);
        CHECK(again->dropped() == whole.dropped());
        CHECK(again->droppedSamples() == whole.droppedSamples());
        CHECK(again->cost({7, 7}).rays == whole.cost({7, 7}).rays);
        CHECK(again->gathered({7, 7}).radius == whole.gathered({7, 7}).radius);
    }

    TEST_CASE("a film that begins later holds its range alone; ranges merge to the whole") {
        Film whole(everything()), a(everything()), b(everything(), 5), c(everything(), 12);
        CHECK(b.begin() == 5);
        CHECK(b.done() == 5);
        CHECK(b.next({10, 10}) == 5);
        CHECK(std::isnan(b.noise()));
        fill(whole, 20);
        fill(a, 5);
        fill(b, 12);
        fill(c, 20);
        const std::unique_ptr<Film> all = filmOf(bytesOf(c));
        all->merge(*filmOf(bytesOf(a)));
        all->merge(*filmOf(bytesOf(b)));
        CHECK(all->begin() == 0);
        CHECK(all->done() == 20);
        CHECK(all->even());
        CHECK(samePicture(*all, whole));
        CHECK(all->droppedSamples() == whole.droppedSamples());
    }

    TEST_CASE("every cut and every impossible number is one error of the file") {
        Film film(FilmLayout{5, 4, {0, 0, 5, 4}, {}, true});
        fill(film, 3);
        const std::string good = bytesOf(film);
        CHECK(refusal(good) == Exit::done);
        for (std::size_t length = 0; length < good.size(); ++length) {
            CAPTURE(length);
            CHECK(refusal(good.substr(0, length)) == Exit::file);
        }
        stats::Random u(1);
        for (int i = 0; i < 2000; ++i) { // the file's checksum finds these first; here nothing may crash
            std::string bad = good;
            bad[u.next() % bad.size()] ^= char(1 << (u.next() & 7));
            const Exit code = refusal(bad);
            CHECK((code == Exit::done || code == Exit::file || code == Exit::resources));
        }
    }

    TEST_CASE("a film larger than the limit is refused before it is made") {
        Film film(FilmLayout{50, 40, {0, 0, 50, 40}, {}, false});
        const std::string bytes = bytesOf(film);
        std::istringstream in(bytes);
        Reader reader(in, "a.chk", bytes.size());
        try {
            Film::load(reader, 1000);
            FAIL("was read");
        } catch (const Error& e) { CHECK(e.code == Exit::resources); }
    }

} // TEST_SUITE
