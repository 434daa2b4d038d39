// Environment light: rows E1 to E6 and B15 of the verification table, rotation, chi-square of its samples.
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>
#include <functional>

using namespace chiaro;
using namespace chiaro::test;

namespace {

using Radiance = std::function<double(const Vec3d&)>; // radiance of a direction

std::unique_ptr<const Scene> under(EnvironmentDesc e) {
    SceneDesc d;
    d.environment = std::move(e);
    return compiled(std::move(d));
}
// The direction of a texel's middle, before rotation: u = 0.5 + atan2(z, x) / (2 pi), v = acos(y) / pi.
Vec3d texelDirection(double column, double row, int width, int height) {
    const double phi = (column / width - 0.5) * 2 * std::numbers::pi, theta = row / height * std::numbers::pi;
    return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}
EnvironmentDesc picture(int width, int height, const Radiance& sky) {
    return environment(width, height, [&](int x, int y) { return Spectrum(float(sky(texelDirection(x + 0.5, y + 0.5, width, height)))); });
}
// Irradiance on a plane of normal n by next-event samples with Lambert's cosine. Independent numbers: an alias table keeps no strata.
stats::Moments sampled(const Scene& scene, const Vec3& n) {
    const SurfacePoint at = receiver(scene, {}, n);
    stats::Random u(5);
    stats::Moments m;
    for (int i = 0; i < 1 << 18; ++i) {
        const double pick = double(u.next() >> 32) * 0x1p-32;
        const float x = u();
        const auto s = scene.lights().sampleTowards(at, pick, {x, u()});
        m.add(s ? double(s->radiance[0]) * std::max(0.0, double(dot(s->wi, at.ns))) / double(s->pdfW) : 0);
    }
    return m;
}
// The same by looking up every texel of the picture, which is exact but for the cosine inside a texel.
double lookedUp(const Scene& scene, const Vec3& n, int width, int height) {
    double sum = 0;
    for (int y = 0; y < height; ++y) {
        const double solid =
            2 * std::numbers::pi / width * (std::cos(std::numbers::pi * y / height) - std::cos(std::numbers::pi * (y + 1) / height));
        for (int x = 0; x < width; ++x) {
            const Vec3 d = cast<float>(texelDirection(x + 0.5, y + 0.5, width, height));
            sum += solid * double(scene.lights().miss(rayFrom({}, d), nullptr).radiance[0] * std::max(0.f, dot(d, normalize(n))));
        }
    }
    return sum;
}
void checkIrradiance(const Scene& scene, const Vec3& n, int width, int height, double expected) {
    CHECK(lookedUp(scene, n, width, height) == doctest::Approx(expected).epsilon(1e-3));
    const stats::Moments m = sampled(scene, n);
    CHECK(std::fabs(m.mean - expected) < 4.5 * m.error() + 1e-3 * expected);
}
Vec3 tilted(double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    return {float(std::sin(a)), float(std::cos(a)), 0};
}
Spectrum seen(const Scene& scene, const Vec3d& d) { return scene.lights().miss(rayFrom({}, cast<float>(d)), nullptr).radiance; }

} // namespace

TEST_SUITE("environment") {

    TEST_CASE("E1, E2, E3, B15: irradiance under skies of known radiance") {
        constexpr double p = std::numbers::pi;
        const auto uniform = under(uniformSky(1));
        for (const Vec3& n : {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0.3f, -0.8f, 0.4f}}) checkIrradiance(*uniform, n, 512, 256, p);
        struct Row {
            const char* name;
            Radiance sky;
            std::vector<std::pair<double, double>> expected; // tilt in degrees, irradiance
        };
        const Row rows[] = {
            {"sky and ground", [](const Vec3d& d) { return d.y > 0 ? 3.0 : 1.0; }, {{0, 3 * p}, {60, 2.5 * p}, {90, 2 * p}, {180, p}}},
            {"1 + cos",
             [](const Vec3d& d) { return 1 + d.y; },
             {{0, 5.235987756}, {60, 4.188790205}, {90, 3.141592654}, {180, 1.047197551}}},
            {"x squared", [](const Vec3d& d) { return d.x * d.x; }, {{90, p / 2}, {0, p / 4}}},
            {"cos", [](const Vec3d& d) { return std::max(0.0, d.y); }, {{0, 2.094395}}},
            {"cos^2", [](const Vec3d& d) { return d.y > 0 ? d.y * d.y : 0; }, {{0, 1.570796}}},
            {"cos^10", [](const Vec3d& d) { return d.y > 0 ? std::pow(d.y, 10) : 0; }, {{0, .523599}}},
            {"cos^100", [](const Vec3d& d) { return d.y > 0 ? std::pow(d.y, 100) : 0; }, {{0, .0615999}}},
            {"overcast", [](const Vec3d& d) { return d.y > 0 ? (1 + 2 * d.y) / 3 : 0; }, {{0, 2.443460953}}},
        };
        for (const Row& row : rows) {
            CAPTURE(std::string(row.name));
            const auto scene = under(picture(1024, 512, row.sky));
            for (const auto& [tilt, expected] : row.expected) checkIrradiance(*scene, tilted(tilt), 1024, 512, expected);
        }
    }

    TEST_CASE("E4: poles and texels lie where they should") {
        // Four columns, four rows, each texel its own value.
        const auto value = [](int x, int y) { return Spectrum(float(10 * y + x + 1), float(x), float(y)); };
        const auto scene = under(environment(8, 4, value));
        int wrong = 0;
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 8; ++x)
                for (const double corner : {0.02, 0.5, 0.98})
                    wrong += !(seen(*scene, texelDirection(x + corner, y + corner, 8, 4)) == value(x, y));
        CHECK(wrong == 0);
        // The picture's centre looks along +X, u grows towards +Z, the top row is +Y.
        CHECK(seen(*scene, {1, 0.01, 0.01}) == value(4, 1));
        CHECK(seen(*scene, {-0.01, -0.01, 1}) == value(6, 2));
        CHECK(seen(*scene, {-0.01, -0.01, -1}) == value(1, 2));
        CHECK(seen(*scene, {-1, 0.01, -0.01}) == value(0, 1));
        CHECK(seen(*scene, {-1, 0.01, 0.01}) == value(7, 1));
        CHECK(seen(*scene, {0.01, 1, 0.01})[2] == 0);
        CHECK(seen(*scene, {0.01, -1, 0.01})[2] == 3);
        for (const Vec3d& pole : {Vec3d{0, 1, 0}, Vec3d{0, -1, 0}}) {
            const LightHit h = scene->lights().miss(rayFrom({}, cast<float>(pole)), nullptr);
            CHECK(finite(h.radiance));
        }
    }

    TEST_CASE("E5: texel solid angles, one hot texel") {
        const double expected[][2] = {{0, 4.72738353e-4}, {4, .004119243344}, {15, .009622810250}};
        for (const auto& [row, solidAngle] : expected) {
            const auto scene =
                under(environment(64, 32, [row = row](int x, int y) { return Spectrum(x == 20 && y == int(row) ? 1000.f : 0.f); }));
            const SurfacePoint at = receiver(*scene, {}, {0, 1, 0});
            const auto s = scene->lights().sampleTowards(at, 0.3, {0.4f, 0.6f});
            REQUIRE(s);
            CHECK(1 / double(s->pdfW) == doctest::Approx(solidAngle).epsilon(1e-6));
            if (row == 4) CHECK(sampled(*scene, {0, 1, 0}).mean == doctest::Approx(3.719266457).epsilon(1e-4));
        }
        double sum = 0;
        const auto flat = under(environment(64, 32, [](int, int) { return Spectrum(1); }));
        const SurfacePoint at = receiver(*flat, {}, {0, 1, 0});
        for (int y = 0; y < 32; ++y)
            sum += 1 / double(flat->lights().miss(rayFrom({}, cast<float>(texelDirection(0.5, y + 0.5, 64, 32))), &at).pdfW) / 32;
        CHECK(sum == doctest::Approx(4 * std::numbers::pi).epsilon(1e-5)); // a uniform sky is sampled uniformly
    }

    TEST_CASE("E6: samples follow the density that a look-up names; it integrates to one") {
        const struct {
            int width, height;
            std::function<float(int, int)> value;
        } cases[] = {{3, 2, [](int x, int y) { return float(1 + x + 3 * y); }},
                     {100, 10, [](int x, int y) { return x == 71 && y == 2 ? 1000.f : 0.f; }},
                     {100, 10, [](int x, int y) { return x == 71 && y == 2 ? 1000.f : 1.f; }},
                     {1024, 512, [](int x, int y) { return float((x * 7919 + y * 104729) % 1000) * (y < 40 ? 20.f : 1.f); }}};
        for (const auto& k : cases)
            for (const auto& [turn, filter] : {std::pair{0.f, TextureFilter::nearest}, {1.f, TextureFilter::linear}}) {
                CAPTURE(k.width);
                CAPTURE(turn);
                EnvironmentDesc e = environment(
                    k.width, k.height, [&](int x, int y) { return Spectrum(k.value(x, y)); }, filter);
                e.rotate = turn;
                const auto scene = under(e);
                const SurfacePoint at = receiver(*scene, {}, {0, 1, 0});
                // Cells: the texels themselves for the small pictures, blocks of them for the large one.
                const int block = k.width > 512 ? 16 : 1, columns = k.width / block, rows = k.height / block;
                constexpr int n = 300'000;
                std::vector<double> observed(std::size_t(columns) * rows), expected(observed.size());
                const Affine back = rotation({0, 1, 0}, -double(turn)), forth = rotation({0, 1, 0}, double(turn));
                double integral = 0;
                for (int y = 0; y < k.height; ++y)
                    for (int x = 0; x < k.width; ++x) {
                        const Vec3d d = forth.vector(texelDirection(x + 0.5, y + 0.5, k.width, k.height));
                        const double pdf = double(scene->lights().miss(rayFrom({}, cast<float>(d)), &at).pdfW);
                        const double solid = 2 * std::numbers::pi / k.width *
                                             (std::cos(std::numbers::pi * y / k.height) - std::cos(std::numbers::pi * (y + 1) / k.height));
                        integral += pdf * solid;
                        expected[std::size_t(y / block) * columns + x / block] += n * pdf * solid;
                    }
                CHECK(integral == doctest::Approx(1).epsilon(1e-5));
                stats::Random u(7);
                int wrong = 0;
                for (int i = 0; i < n; ++i) {
                    const double pick = double(u.next() >> 32) * 0x1p-32;
                    const float v = u();
                    const auto s = scene->lights().sampleTowards(at, pick, {v, u()});
                    REQUIRE(s);
                    const LightHit h = scene->lights().miss(rayFrom(at.p, s->wi), &at);
                    wrong +=
                        std::fabs(h.pdfW / s->pdfW - 1) > 1e-4f ||
                        std::fabs(h.radiance[0] - s->radiance[0]) > 1e-3f * (1 + std::fabs(s->radiance[0])); // on the border of two texels
                    const Vec3d d = back.vector(cast<double>(s->wi));
                    const int x = int((0.5 + std::atan2(d.z, d.x) / (2 * std::numbers::pi)) * k.width),
                              y = int(std::acos(std::clamp(d.y, -1.0, 1.0)) / std::numbers::pi * k.height);
                    ++observed[std::size_t(std::min(y, k.height - 1) / block) * columns + std::min(x, k.width - 1) / block];
                }
                CHECK(wrong < n / 2000);
                CHECK(stats::chiSquare(observed, expected).p > stats::sidak(8));
            }
    }

    TEST_CASE("a linear filter blends texels across the seam, and its sky is sampled without bias") {
        // One hot texel beside the seam: a tent of two texels' width.
        const auto scene = under(environment(
            64, 32, [](int x, int y) { return Spectrum(x == 0 && y == 6 ? 1000.f : 0.f); }, TextureFilter::linear));
        const auto tent = [](double x, double y) {
            return 1000 * std::max(0.0, 1 - std::min(std::fabs(x - 0.5), 64 - std::fabs(x - 0.5))) * std::max(0.0, 1 - std::fabs(y - 6.5));
        };
        double irradiance = 0;
        constexpr int fine = 64;
        for (int j = 5 * fine; j < 8 * fine; ++j)
            for (int i = 0; i < 64 * fine; ++i) {
                const double x = (i + 0.5) / fine, y = (j + 0.5) / fine, theta = std::numbers::pi * y / 32;
                irradiance += tent(x, y) * std::cos(theta) * std::sin(theta) * sqr(std::numbers::pi / 32 / fine);
            }
        const stats::Moments s = sampled(*scene, {0, 1, 0});
        CHECK(std::fabs(s.mean - irradiance) < 4.5 * s.error() + 1e-4 * irradiance);
        for (const auto& [x, y] : {std::pair{0.5, 6.5}, {0.0, 6.5}, {63.75, 6.25}, {1.25, 7.0}})
            CHECK(double(seen(*scene, texelDirection(x, y, 64, 32))[0]) == doctest::Approx(tent(x, y)).epsilon(1e-3));
    }

    TEST_CASE("rotation turns the sky counter-clockwise seen from above; scale multiplies") {
        EnvironmentDesc e = environment(8, 4, [](int x, int) { return Spectrum(x == 4 ? 1.f : 0.f); }); // a stripe beside +X, towards +Z
        const auto plain = under(e);
        CHECK(seen(*plain, texelDirection(4.5, 1.5, 8, 4)) == Spectrum(1));
        e.rotate = float(std::numbers::pi / 2);
        e.scale = 3;
        const auto turned = under(e); // +X goes to -Z
        const Vec3d d = texelDirection(4.5, 1.5, 8, 4);
        CHECK(seen(*turned, {d.z, d.y, -d.x}) == Spectrum(3));
        CHECK(black(seen(*turned, d)));
        CHECK(turned->lights().power() == doctest::Approx(3 * plain->lights().power()));
        const auto s = turned->lights().sampleTowards(receiver(*turned, {}, {0, 1, 0}), 0.5, {0.5f, 0.5f});
        REQUIRE(s);
        CHECK(s->wi.z < 0);
        CHECK(s->kind == LightKind::environment);
        CHECK(s->shadow.tfar == infinity);
    }

    TEST_CASE("a black sky and one that is not all finite") {
        const auto dark = under(uniformSky(0));
        CHECK(!dark->lights().sampleTowards(receiver(*dark, {}, {0, 1, 0}), 0.5, {0.5f, 0.5f}));
        CHECK(!dark->lights().miss(rayFrom({}, {0, 1, 0}), nullptr));
        const auto odd = under(environment(4, 2, [](int x, int y) {
            return Spectrum(y == 0 && x == 1 ? std::nanf("") : x == 2 ? -1.f : 1.f);
        }));
        stats::Random u(1);
        int bad = 0;
        for (int i = 0; i < 10'000; ++i) {
            const double pick = double(u());
            const float v = u();
            const auto s = odd->lights().sampleTowards(receiver(*odd, {}, {0, 1, 0}), pick, {v, u()});
            bad += !s || !finite(s->radiance) || !(s->pdfW > 0);
        }
        CHECK(bad == 0);
    }
}
