// The sampler: stratification, independence, purity (row H10 of the verification table).
#include "core/math/sampler.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>
#include <set>

using namespace chiaro;

namespace {

struct Origin {
    uint64_t seed, path;
    uint32_t dimension;
};
// Seeds, pixels and dimensions of every kind: small, neighbouring, huge.
std::vector<Origin> origins() {
    std::vector<Origin> all;
    for (const uint64_t seed : {0ull, 1ull, 0xffffffffffffffffull})
        for (const uint64_t path : {0ull, 1ull, 1ull << 32, (719ull << 32) | 1279})
            for (const uint32_t dimension : {0u, 1u, 2u, 7u, 64u, 1001u}) all.push_back({seed, path, dimension});
    return all;
}
Sampler at(const Origin& o, uint32_t sample, SamplerKind kind = SamplerKind::sobol) {
    Sampler s(o.seed, kind, Stream::pixel, o.path, sample);
    s.skip(o.dimension);
    return s;
}

// Points in each elementary interval 2^-q x 2^-(k-q) of the first 2^k points: how many intervals do not hold exactly one.
int strayIntervals(const std::vector<Point2>& points, int k) {
    int stray = 0;
    const std::size_t n = std::size_t(1) << k;
    for (int q = 0; q <= k; ++q) {
        std::vector<int> cells(n);
        for (std::size_t i = 0; i < n; ++i) {
            const auto column = std::size_t(std::ldexp(double(points[i].x), q)), row = std::size_t(std::ldexp(double(points[i].y), k - q));
            ++cells[(column << (k - q)) + row];
        }
        for (const int c : cells) stray += c != 1;
    }
    return stray;
}
int strayStrata(const std::vector<double>& numbers, std::size_t n) {
    std::vector<int> cells(n);
    for (std::size_t i = 0; i < n; ++i) ++cells[std::size_t(numbers[i] * double(n))];
    return int(std::count_if(cells.begin(), cells.end(), [](int c) { return c != 1; }));
}

double pairP(const std::vector<Point2>& points, int side) {
    std::vector<double> cells(std::size_t(side) * side), expected(cells.size(), double(points.size()) / double(cells.size()));
    for (const Point2& p : points) ++cells[std::size_t(p.x * float(side)) * side + std::size_t(p.y * float(side))];
    return stats::chiSquare(cells, expected).p;
}
double correlation(const std::vector<Point2>& points) {
    double xy = 0;
    for (const Point2& p : points) xy += (double(p.x) - 0.5) * (double(p.y) - 0.5) * 12;
    return xy / double(points.size());
}

} // namespace

TEST_SUITE("sampler") {

    TEST_CASE("every 2D request is a (0,2)-sequence: 2^k samples fill every elementary interval") {
        int stray = 0;
        for (const Origin& o : origins()) {
            std::vector<Point2> points;
            for (uint32_t i = 0; i < 512; ++i) points.push_back(at(o, i).get2D());
            for (int k = 0; k <= 8; ++k) stray += strayIntervals(points, k);
            // Aligned blocks further on are nets as well: passes of 1, 2, 4 ... samples begin at such places.
            for (int k = 0; k <= 8; ++k) stray += strayIntervals({points.begin() + (1 << k), points.end()}, k);
        }
        CHECK(stray == 0);
    }

    TEST_CASE("every 1D request and every pick is stratified") {
        int stray = 0;
        for (const Origin& o : origins()) {
            std::vector<double> single, pick;
            for (uint32_t i = 0; i < 256; ++i) {
                single.push_back(double(at(o, i).get1D()));
                pick.push_back(at(o, i).getPick());
            }
            for (std::size_t n = 1; n <= 256; n *= 2) stray += strayStrata(single, n) + strayStrata(pick, n);
        }
        CHECK(stray == 0);
    }

    TEST_CASE(
        "a 3D request is a (1,3)-sequence whose point is a (0,2)-sequence: 2^k samples put two into every interval of volume 2^(1-k)") {
        int stray = 0;
        for (const Origin& o : origins()) {
            std::vector<PickAndPoint> all;
            std::vector<Point2> points;
            std::vector<double> picks;
            for (uint32_t i = 0; i < 256; ++i) {
                all.push_back(at(o, i).get3D());
                points.push_back(all.back().u);
                picks.push_back(all.back().pick);
            }
            for (int k = 0; k <= 8; ++k) stray += strayIntervals(points, k) + strayStrata(picks, std::size_t(1) << k);
            for (int k = 1; k <= 8; ++k)
                for (int a = 0; a < k; ++a)
                    for (int b = 0; a + b < k; ++b) {
                        std::vector<int> cells(std::size_t(1) << (k - 1));
                        const int c = k - 1 - a - b;
                        for (std::size_t i = 0; i < std::size_t(1) << k; ++i) {
                            const auto x = std::size_t(std::ldexp(all[i].pick, a)), y = std::size_t(std::ldexp(double(all[i].u.x), b)),
                                       z = std::size_t(std::ldexp(double(all[i].u.y), c));
                            ++cells[(x << (b + c)) + (y << c) + z];
                        }
                        for (const int n : cells) stray += n != 2;
                    }
        }
        CHECK(stray == 0);
        Sampler s(1, SamplerKind::independent, Stream::pixel, 2, 3), one = s;
        const PickAndPoint p = s.get3D();
        CHECK(p.pick == one.getPick());
        CHECK(p.u.x == one.get2D().x);
        CHECK(s.dimension() == 3);
    }

    TEST_CASE("dimensions of one pixel are independent: chi-square and covariance of pairs of requests") {
        const int pairs[][2] = {{0, 1}, {0, 2}, {1, 2}, {3, 4}, {4, 9}, {10, 100}, {64, 65}, {0, 1000}};
        const double level = stats::sidak(2 * 3 * 8);
        for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::independent})
            for (const uint64_t path : {0ull, 5ull, (99ull << 32) | 7})
                for (const auto& d : pairs) {
                    std::vector<Point2> points;
                    for (uint32_t i = 0; i < 16384; ++i)
                        points.push_back({at({3, path, uint32_t(d[0])}, i, kind).get1D(), at({3, path, uint32_t(d[1])}, i, kind).get1D()});
                    CAPTURE(path);
                    CAPTURE(d[0]);
                    CAPTURE(d[1]);
                    CHECK(pairP(points, 16) > level);
                    CHECK(std::fabs(correlation(points)) < 5 / std::sqrt(16384.0));
                }
    }

    TEST_CASE("pixels, seeds and streams are uncorrelated") {
        constexpr int n = 1 << 16;
        const double level = stats::sidak(2 * 5);
        for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::independent}) {
            std::vector<Point2> neighbours, rows, seeds, streams, dimensions;
            for (uint64_t i = 0; i < n; ++i) {
                const auto first = [&](uint64_t seed, Stream stream, uint64_t path) {
                    return Sampler(seed, kind, stream, path, 0).get1D();
                };
                const float here = first(0, Stream::pixel, i);
                neighbours.push_back({here, first(0, Stream::pixel, i + 1)});
                rows.push_back({here, first(0, Stream::pixel, i + (1ull << 32))});
                seeds.push_back({first(i, Stream::pixel, 0), first(i + 1, Stream::pixel, 0)});
                streams.push_back({here, first(0, Stream::light, i)});
                Sampler s(0, kind, Stream::pixel, i, 1);
                dimensions.push_back(s.get2D());
            }
            int k = 0;
            for (const auto* points : {&neighbours, &rows, &seeds, &streams, &dimensions}) {
                CAPTURE(k++);
                CHECK(pairP(*points, 32) > level);
                CHECK(std::fabs(correlation(*points)) < 5 / std::sqrt(double(n)));
            }
        }
    }

    TEST_CASE("the independent sampler is uniform over samples") {
        for (const uint32_t dimension : {0u, 1u, 33u}) {
            std::vector<Point2> points, singles;
            for (uint32_t i = 0; i < 1 << 16; ++i) {
                points.push_back(at({1, 2, dimension}, i, SamplerKind::independent).get2D());
                Sampler s = at({1, 2, dimension}, i, SamplerKind::independent);
                const float x = s.get1D();
                singles.push_back({x, s.get1D()});
            }
            CHECK(pairP(points, 32) > stats::sidak(6));
            CHECK(pairP(singles, 32) > stats::sidak(6));
        }
    }

    TEST_CASE("numbers lie in [0, 1), floats with 24 bits, picks with 32") {
        std::vector<double> low(256), expected(256, (1 << 17) / 256.0);
        int wrong = 0;
        for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::independent})
            for (uint32_t i = 0; i < 1 << 16; ++i) {
                Sampler s(7, kind, Stream::pixel, i / 64, i % 64);
                const Point2 p = s.get2D();
                const float x = s.get1D();
                const double pick = s.getPick(), bits = std::ldexp(pick, 32);
                for (const float v : {p.x, p.y, x}) wrong += !(v >= 0 && v < 1) || std::ldexp(v, 24) != std::floor(std::ldexp(v, 24));
                wrong += !(pick >= 0 && pick < 1) || bits != std::floor(bits);
                ++low[std::size_t(uint64_t(bits) & 255)];
            }
        CHECK(wrong == 0);
        CHECK(stats::chiSquare(low, expected).p > 1e-4);
    }

    TEST_CASE("a number depends on its place alone, not on what was asked before") {
        for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::independent}) {
            Sampler walked(9, kind, Stream::light, 4, 5), skipped(9, kind, Stream::light, 4, 5);
            walked.get1D();
            walked.get2D();
            walked.getPick();
            skipped.skip(4);
            CHECK(walked.dimension() == 4);
            const Point2 a = walked.get2D(), b = skipped.get2D();
            CHECK(a.x == b.x);
            CHECK(a.y == b.y);
            std::set<float> different;
            for (const uint64_t seed : {9ull, 10ull})
                for (const Stream stream : {Stream::light, Stream::pixel, Stream::chain, Stream::prepass})
                    for (const uint64_t path : {4ull, 4ull << 32})
                        for (const uint32_t sample : {5u, 6u}) different.insert(Sampler(seed, kind, stream, path, sample).get1D());
            CHECK(different.size() == 32);
        }
    }

    TEST_CASE("replay gives the vector first and goes on with the other sampler's own numbers") {
        const std::vector<float> vector = {0.25f, 0.5f, 0.75f, 0.125f, 0.0625f};
        const Sampler beyond(1, SamplerKind::sobol, Stream::chain, 2, 3);
        Sampler s = Sampler::replay(vector, beyond);
        CHECK(s.get1D() == 0.25f);
        const Point2 p = s.get2D();
        CHECK(p.x == 0.5f);
        CHECK(p.y == 0.75f);
        CHECK(s.getPick() == 0.125);
        Sampler other = beyond;
        other.skip(4);
        const Point2 q = s.get2D(), r = other.get2D(); // a pair that the vector does not hold whole is not torn
        CHECK(q.x == r.x);
        CHECK(q.y == r.y);
        CHECK(s.get1D() == other.get1D());
    }

    TEST_CASE("split: continuations of all samples are stratified together") {
        int stray = 0;
        for (const Origin& o : origins())
            for (const uint32_t n : {2u, 4u, 16u}) {
                std::vector<Point2> pairs;
                std::vector<double> singles;
                for (uint32_t i = 0; i < 256 / n; ++i)
                    for (uint32_t j = 0; j < n; ++j) {
                        Sampler s = at(o, i).split(j, n);
                        pairs.push_back(s.get2D());
                        singles.push_back(double(s.get1D()));
                    }
                for (int k = 0; k <= 8; ++k) stray += strayIntervals(pairs, k) + strayStrata(singles, std::size_t(1) << k);
            }
        CHECK(stray == 0);
    }

    TEST_CASE("split: one continuation changes nothing, several are independent of the parent") {
        Sampler parent = at({1, 2, 5}, 3), same = parent.split(0, 1);
        CHECK(same.get1D() == parent.get1D());
        std::vector<Point2> points;
        for (uint32_t i = 0; i < 16384; ++i) {
            Sampler s = at({1, 2, 5}, i), child = s.split(1, 4);
            points.push_back({s.get1D(), child.get1D()});
        }
        CHECK(pairP(points, 16) > 1e-4);
        CHECK(std::fabs(correlation(points)) < 5 / std::sqrt(16384.0));
    }
}
