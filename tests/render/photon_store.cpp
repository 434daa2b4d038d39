// The photon store: what is found is what brute force finds, in the same order for any number of threads, and a file gives it back or is
// refused.
#include "integrators/photon_store.h"
#include "core/render/archive.h"
#include "tests/statistics.h"
#include <cstring>
#include <doctest/doctest.h>
#include <sstream>

using namespace chiaro;

namespace {

Vec3 direction(stats::Random& u) {
    const float z = 2 * u() - 1, r = std::sqrt(std::max(0.f, 1 - z * z)), a = 6.2831853f * u();
    return {r * std::cos(a), r * std::sin(a), z};
}
Photon photonAt(const Vec3& p, uint32_t number) {
    Photon photon;
    photon.p = p;
    photon.flux = Spectrum(float(number), 1, 2);
    photon.wi = packDirection({0, 1, 0});
    photon.state = 1;
    return photon;
}
// Number of a photon: its red flux.
uint32_t numberOf(const Photon& photon) { return uint32_t(photon.flux[0]); }

struct Cloud {
    std::string name;
    PhotonList photons;
    float cell;
};
std::vector<Cloud> clouds() {
    std::vector<Cloud> all;
    stats::Random u(3);
    const auto cloud = [&](const char* name, uint32_t n, float cell, auto&& place) {
        Cloud c{name, {}, cell};
        for (uint32_t i = 0; i < n; ++i) c.photons.push_back(photonAt(place(), i));
        all.push_back(std::move(c));
    };
    const auto cube = [&] { return Vec3{u() * 2 - 1, u() * 2 - 1, u() * 2 - 1}; };
    const auto plane = [&] { return Vec3{u() * 4 - 2, .25f, u() * 4 - 2}; };
    cloud("cube", 20'000, .2f, cube);
    cloud("cube, small cells: hashed", 20'000, .01f, cube);
    cloud("cube, one cell", 3'000, 10, cube);
    cloud("plane", 30'000, .05f, plane);
    cloud("plane, tiny cells", 30'000, 1e-4f, plane);
    cloud("many", 200'000, .02f, plane);
    cloud("clusters far apart", 10'000, .1f, [&] {
        const Vec3 d = direction(u) * (u() * .3f);
        return Vec3{(u() < .5f ? 1e3f : -1e3f) + d.x, d.y, (u() < .5f ? 1e3f : 0) + d.z};
    });
    cloud("all in one place", 500, .1f, [] { return Vec3{.5f, .5f, .5f}; });
    cloud("one", 1, .1f, cube);
    cloud("none", 0, .1f, cube);
    return all;
}
std::vector<Vec3> queries(const Cloud& c) {
    stats::Random u(17);
    std::vector<Vec3> all{{0, 0, 0}, {1e6f, 0, 0}, {-1e30f, 3, 1e30f}};
    for (int i = 0; i < 12 && !c.photons.empty(); ++i) {
        const Photon& near = c.photons[std::size_t(u.next() % c.photons.size())];
        all.push_back(i % 2 ? near.p : near.p + direction(u) * (c.cell * u()));
    }
    return all;
}

bool sameBits(const PhotonStore& a, const PhotonStore& b) {
    return a.size() == b.size() && std::memcmp(a.photons().data(), b.photons().data(), a.photons().size_bytes()) == 0;
}
PathClasses anyPath() { return PathClasses(); }

std::string saved(const PhotonStore& store) {
    std::ostringstream out;
    Writer to(out);
    store.save(to);
    return out.str();
}
void load(const std::string& bytes, PhotonStore& store) {
    std::istringstream in(bytes);
    Reader from(in, "map.bin", bytes.size());
    store.load(Executor(1), from, anyPath());
}

} // namespace

TEST_SUITE("photon-store") {
    TEST_CASE("directions and normals keep their way through 32 and 16 bits") {
        stats::Random u(1);
        double worst = 0, worstNormal = 0;
        for (int i = 0; i < 200'000; ++i) {
            const Vec3 d = direction(u);
            worst = std::max(worst, double(length(unpackDirection(packDirection(d)) - d)));
            worstNormal = std::max(worstNormal, double(length(unpackNormal(packNormal(d)) - d)));
        }
        CHECK(worst < 1e-4);
        CHECK(worstNormal < 2e-2);
        for (const Vec3& axis : {Vec3{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
            CHECK(unpackDirection(packDirection(axis)) == axis);
            CHECK(unpackNormal(packNormal(axis)) == axis);
        }
        for (const uint32_t c : {0u, 0xffffffffu, 0xffffu, 0x8000u}) { // whatever a file holds is a direction
            CHECK(std::fabs(length(unpackDirection(c)) - 1) < 1e-6f);
            CHECK(std::fabs(length(unpackNormal(uint16_t(c))) - 1) < 1e-6f);
        }
    }

    TEST_CASE("within finds what brute force finds, each once") {
        for (const Cloud& c : clouds()) {
            CAPTURE(c.name);
            const PhotonStore store(Executor(2), c.photons, c.cell);
            CHECK(store.size() == c.photons.size());
            for (const Vec3& q : queries(c))
                for (const float radius : {c.cell, c.cell * .3f, c.cell * 2.7f, 0.f, -1.f, infinity}) {
                    if (radius == infinity && c.photons.size() > 1000 && q.x < 1e5f) continue;
                    std::vector<uint32_t> found, expected;
                    bool told = true;
                    store.within(q, radius, [&](const Photon& photon, float d2) {
                        found.push_back(numberOf(photon));
                        told = told && d2 == lengthSquared(photon.p - q);
                    });
                    CHECK(told);
                    for (const Photon& photon : c.photons)
                        if (radius > 0 && lengthSquared(photon.p - q) < radius * radius) expected.push_back(numberOf(photon));
                    std::sort(found.begin(), found.end());
                    CHECK(found == expected);
                }
        }
    }

    TEST_CASE("nearest finds the k that brute force finds, the farthest first") {
        for (const Cloud& c : clouds()) {
            CAPTURE(c.name);
            const PhotonStore store(Executor(2), c.photons, c.cell);
            for (const Vec3& q : queries(c))
                for (const uint32_t k : {0u, 1u, 7u, 50u})
                    for (const float radius : {c.cell * .5f, c.cell * 1.6f}) {
                        const auto odd = [](const Photon& photon) { return numberOf(photon) % 3 != 0; };
                        std::vector<PhotonStore::Near> found(k), expected;
                        found.resize(store.nearest(q, k, radius, found, odd));
                        for (uint32_t i = 0; i < store.size(); ++i)
                            if (const float d2 = lengthSquared(store.photons()[i].p - q); d2 < radius * radius && odd(store.photons()[i]))
                                expected.push_back({d2, i});
                        std::sort(expected.begin(), expected.end());
                        expected.resize(std::min<std::size_t>(k, expected.size()));
                        REQUIRE(found.size() == expected.size());
                        if (!found.empty()) CHECK(found[0].distance2 == expected.back().distance2);
                        std::sort(found.begin(), found.end());
                        CHECK(std::equal(found.begin(), found.end(), expected.begin(),
                                         [](const auto& a, const auto& b) { return a.photon == b.photon && a.distance2 == b.distance2; }));
                    }
        }
    }

    TEST_CASE("the same order for one, two and five threads; photons of one cell stay in the order in which they came") {
        for (const Cloud& c : clouds()) {
            CAPTURE(c.name);
            const PhotonStore one(Executor(1), c.photons, c.cell);
            for (const unsigned threads : {2u, 5u}) CHECK(sameBits(one, PhotonStore(Executor(threads), c.photons, c.cell)));
        }
        const Cloud heap = clouds()[7];
        const PhotonStore store(Executor(2), heap.photons, heap.cell);
        bool inOrder = true;
        for (std::size_t i = 0; i < store.size(); ++i) inOrder = inOrder && numberOf(store.photons()[i]) == i;
        CHECK(inOrder);
    }

    TEST_CASE("32 bytes a photon and some for the cells") {
        const Cloud c = clouds()[5];
        const PhotonStore store(Executor(2), c.photons, c.cell);
        CHECK(store.bytes() <= store.size() * 42);
    }

    TEST_CASE("save and load give the same store; a damaged file is refused in one line") {
        for (const Cloud& c : clouds()) {
            CAPTURE(c.name);
            const PhotonStore store(Executor(2), c.photons, c.cell);
            PhotonStore again;
            load(saved(store), again);
            CHECK(sameBits(store, again));
            CHECK(again.cell() == store.cell());
            if (!c.photons.empty()) {
                int found = 0;
                again.within(c.photons[0].p, c.cell, [&](const Photon&, float) { ++found; });
                CHECK(found > 0);
            }
        }
        const Cloud small = {"", {photonAt({0, 0, 0}, 1), photonAt({1, 0, 0}, 2)}, .1f};
        const std::string good = saved(PhotonStore(Executor(1), small.photons, small.cell));
        PhotonStore store;
        const auto refused = [&](std::string bytes) {
            try {
                load(bytes, store);
                return false;
            } catch (const Error& e) {
                CHECK(e.code == Exit::file);
                CHECK(std::string(e.what()).find('\n') == std::string::npos);
                return std::string(e.what()).starts_with("map.bin: ");
            }
        };
        for (std::size_t cut = 0; cut < good.size(); ++cut) CHECK(refused(good.substr(0, cut)));
        const auto with = [&](std::size_t at, auto value) {
            std::string bytes = good;
            std::memcpy(bytes.data() + at, &value, sizeof value);
            return bytes;
        };
        constexpr std::size_t first = 4 + 8; // cell, length
        CHECK(refused(with(0, 0.f)));
        CHECK(refused(with(0, -1.f)));
        CHECK(refused(with(0, std::numeric_limits<float>::quiet_NaN())));
        CHECK(refused(with(0, infinity)));
        CHECK(refused(with(4, ~uint64_t(0))));
        CHECK(refused(with(4, uint64_t(3))));
        CHECK(refused(with(first, std::numeric_limits<float>::quiet_NaN())));
        CHECK(refused(with(first + 4, infinity)));
        CHECK(refused(with(first + 12, infinity)));
        CHECK(refused(with(first + 28, uint16_t(0xffff))));
        load(with(0, 1e-30f), store); // cells far too small are made larger
        CHECK(store.size() == 2);
    }
} // TEST_SUITE
