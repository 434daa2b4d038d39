// The further lobes against closed forms: dispersion, thin films, sheen; and white furnaces of what is compensated for multiple scattering.
#include "materials/dispersion.h"
#include "materials/sheen.h"
#include "materials/thin_film.h"
#include "tests/materials/closures.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>
#include <string>

using namespace chiaro;
using namespace chiaro::test;
using doctest::Approx;

namespace {

Bsdf level(const BsdfParameters& p, double mu, Transport t = Transport::importance) {
    const Vec3 wo{float(std::sqrt(1 - mu * mu)), 0, float(mu)};
    return Bsdf(p, {0, 0, 1}, {0, 0, 1}, wo, t);
}
// What all directions together return of each channel; error: the largest of their standard errors.
struct Returned {
    double mean[3] = {}, error = 0;
};
Returned returned(const Bsdf& b, int n, uint64_t seed) {
    stats::Random u(seed);
    stats::Moments m[3];
    for (int i = 0; i < n; ++i) {
        const float uLobe = u(), x = u(), y = u();
        const auto s = b.sample(uLobe, {x, y});
        for (std::size_t k = 0; k < 3; ++k) m[k].add(s ? double(s->weight[k]) : 0);
    }
    return {{m[0].mean, m[1].mean, m[2].mean}, std::max({m[0].error(), m[1].error(), m[2].error()})};
}

} // namespace

TEST_SUITE("dispersion") {
    TEST_CASE("Abbe's number, the lines, three channels") {
        CHECK(double(Dispersion::ior(1.5f, 1, Dispersion::place(486.1327f))) == Approx(1.517476).epsilon(1e-6)); // F
        CHECK(double(Dispersion::ior(1.5f, 1, Dispersion::place(656.2725f))) == Approx(1.492476).epsilon(1e-6)); // C
        CHECK(double(Dispersion::ior(1.5f, 1, Dispersion::place(587.5618f))) == Approx(1.5).epsilon(1e-5));      // d
        CHECK(Dispersion::ior(1.01f, 100, Dispersion::place(700)) == 1);
        for (float d : {0.5f, 1.f, 4.f}) {
            const Spectrum n = Dispersion::iors(1.5f, d);
            CHECK(double(n[2] - n[0]) / 2 == Approx(0.0125 * double(d)).epsilon(1e-4));
        }
        CHECK(double(Dispersion::place(Dispersion::wavelength(0.4f))) == Approx(0.4).epsilon(1e-4));
    }
    TEST_CASE("the mean place of a band is its middle, between two middles bands add up to one") {
        int seen[2] = {};
        for (std::size_t channel = 0; channel < 3; ++channel) {
            double sum = 0;
            for (int i = 0; i < 20'000; ++i) {
                const float place = Dispersion::draw(channel, (float(i) + 0.5f) / 20'000);
                sum += double(place);
                if (channel < 2) {
                    seen[0] += std::fabs(place - 0.0f) < 0.02f;
                    seen[1] += std::fabs(place - 0.15f) < 0.02f;
                }
            }
            CHECK(sum / 20'000 == Approx(double(Dispersion::middle[channel])).epsilon(1e-3));
        }
        CHECK(seen[0] == Approx(1600).epsilon(0.02)); // 0.04 of the axis at a density of 2
        CHECK(seen[1] == Approx(1600).epsilon(0.02));
    }
    TEST_CASE("every channel gets back what it gave, total reflection of some wavelengths included") {
        const BsdfParameters prism{.roughness = 0, .ior = 1.6f, .transmission = 1, .thin = false, .dispersion = 5};
        for (double mu : {1., 0.5, 0.1, -1., -0.9, -0.8, -0.78, -0.76, -0.5}) {
            const Returned r = returned(level(prism, mu), 100'000, 5);
            INFO("mu " << mu);
            for (double mean : r.mean) CHECK(std::fabs(mean - 1) <= 4.5 * r.error + 1e-5);
        }
    }
    TEST_CASE("a refraction goes where glass of its wavelength sends it") {
        const BsdfParameters prism{.roughness = 0, .ior = 1.6f, .transmission = 1, .thin = false, .dispersion = 5};
        const Bsdf b = level(prism, 0.6);
        stats::Random u(9);
        for (int i = 0; i < 1000; ++i) {
            const float uLobe = u(), x = u(), y = u();
            const auto s = b.sample(uLobe, {x, y});
            if (!s || s->event != Event::ST) continue;
            REQUIRE(s->lambda.hero > 400);
            BsdfParameters known = prism;
            known.dispersion = 0;
            known.ior = Dispersion::ior(1.6f, 5, Dispersion::place(s->lambda.hero));
            const DeltaBranches there = level(known, 0.6).deltaSplit();
            REQUIRE(there.n == 2);
            CHECK(length(there.b[1].wi - s->wi) < 1e-5f);
            CHECK((s->weight[0] > 0) + (s->weight[1] > 0) + (s->weight[2] > 0) == 1);
        }
        const DeltaBranches all = b.deltaSplit();
        REQUIRE(all.n == 4);
        Spectrum sum(0);
        for (const DeltaBranch& d : all) sum += d.weight;
        for (std::size_t k = 0; k < 3; ++k) CHECK(double(sum[k]) == Approx(1).epsilon(1e-5));
    }
    TEST_CASE("prisms of 60 degrees: minimum deviation") {
        const double n[] = {1.51432, 1.5168, 1.52238}, deviation[] = {38.428931, 38.646695, 39.138437};
        for (int i = 0; i < 3; ++i) { // symmetric passage: 30 degrees within
            const double within = std::numbers::pi / 6, outside = std::asin(n[i] * std::sin(within));
            const Vec3d in{-std::sin(outside), 0, std::cos(outside)};
            const Vec3d bent = refract(in, Vec3d{0, 0, 1}, n[i]);
            CHECK(std::asin(bent.x) == Approx(within).epsilon(1e-9));
            CHECK((2 * outside - 2 * within) * 180 / std::numbers::pi == Approx(deviation[i]).epsilon(1e-7));
        }
    }
}

TEST_SUITE("thin-film") {
    TEST_CASE("a film of no thickness is none") {
        const ThinFilm none(1.8f, 0), faint(1.8f, 0.05f);
        for (float c : {1.f, 0.8f, 0.4f, 0.1f}) {
            CHECK(double(none.overDielectric(Spectrum(0.04f), c)[1]) == Approx(double(fresnelDielectric(c, 1.5f))).epsilon(1e-4));
            const float f0 = 0.6f, schlick = f0 + (1 - f0) * schlickShape(c);
            CHECK(double(none.overMetal(Spectrum(f0), c)[0]) == Approx(double(schlick)).epsilon(1e-4));
            CHECK(double(faint.overMetal(Spectrum(f0), c)[2]) == Approx(double(schlick)).epsilon(1e-2));
        }
    }
    TEST_CASE("a film of the base's index is none, however thick") {
        for (float thickness : {100.f, 400.f, 3000.f})
            for (float c : {1.f, 0.6f})
                for (std::size_t k = 0; k < 3; ++k)
                    CHECK(double(ThinFilm(1.5f, thickness).overDielectric(Spectrum(0.04f), c)[k]) ==
                          Approx(double(fresnelDielectric(c, 1.5f))).epsilon(2e-3));
    }
    TEST_CASE("a thick film is a pane: fringes too fine to see leave the sum of all orders, 1/13") {
        for (std::size_t k = 0; k < 3; ++k)
            CHECK(double(ThinFilm(1.5f, 100'000).overDielectric(Spectrum(0), 1)[k]) == Approx(1.0 / 13).epsilon(1e-4));
    }
    TEST_CASE("a quarter of a wave of the geometric mean puts the reflection out") {
        // n = sqrt(1.5) on 1.5, 550 nm / (4 n): dark in green, less so in red and blue.
        const float n = std::sqrt(1.5f);
        const Spectrum r = ThinFilm(n, 550 / (4 * n)).overDielectric(Spectrum(0.04f), 1);
        CHECK(r[1] < 0.004f);
        CHECK(r[0] > r[1]);
        CHECK(r[2] > r[1]);
    }
}

TEST_SUITE("sheen") {
    TEST_CASE("values of the distribution") {
        CHECK(double(Charlie{0.25f}.d(std::sqrt(0.5f))) == Approx(6 * 0.25 / (2 * std::numbers::pi)).epsilon(1e-5));
        CHECK(double(Charlie{1}.d(0.6f)) == Approx(3 * 0.8 / (2 * std::numbers::pi)).epsilon(1e-5));
        for (float alpha : {0.04f, 0.25f, 1.f}) { // D cos integrates to one
            double sum = 0;
            for (int i = 0; i < 20'000; ++i) {
                const float c = (float(i) + 0.5f) / 20'000;
                sum += 2 * std::numbers::pi * double(Charlie{alpha}.d(c) * c) / 20'000;
            }
            CHECK(sum == Approx(1).epsilon(2e-3));
        }
    }
    TEST_CASE("albedo: the table is what the lobe returns") {
        for (float roughness : {0.1f, 0.3f, 0.6f, 1.f})
            for (float mu : {1.f, 0.7f, 0.4f, 0.15f}) {
                const Charlie c{std::max(roughness * roughness, Charlie::smallestAlpha)};
                const Vec3 wo{std::sqrt(1 - mu * mu), 0, mu};
                stats::Random u(3);
                stats::Moments m;
                for (int i = 0; i < 100'000; ++i) {
                    const float x = u(), y = u();
                    const Vec3 wi = uniformHemisphere(Point2{x, y});
                    m.add(double(c.value(wo, wi) * wi.z * 2 * pi));
                }
                INFO("roughness " << roughness << " mu " << mu << ": " << m.mean << " +- " << m.error());
                CHECK(std::fabs(double(SheenSlice(c.alpha).at(mu)) - m.mean) <= 0.006 + 4.5 * m.error());
            }
    }
}

TEST_SUITE("multiple-scattering") {
    constexpr float roughnesses[] = {0.05f, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f, 1};
    constexpr double cosines[] = {1, 0.8, 0.5, 0.2, 0.05};

    void furnace(const std::string& name, BsdfParameters p, double within, bool inside = false) {
        double worst = 0;
        for (float roughness : roughnesses)
            for (double mu : cosines) {
                p.roughness = roughness;
                const Returned r = returned(level(p, inside ? -mu : mu), 30'000, 13);
                INFO(name << ", roughness " << roughness << ", mu " << mu << ": " << r.mean[1] << " +- " << r.error);
                CHECK(std::fabs(r.mean[1] - 1) <= within + 3.5 * r.error);
                worst = std::max(worst, std::fabs(r.mean[1] - 1));
            }
        MESSAGE(name << ": at most " << worst << " from 1");
    }
    TEST_CASE("a white furnace shows rough metal no darker than smooth, within 1 %") {
        furnace("metal", {.metallic = 1}, 0.01);
        furnace("metal under a dielectric's weight", {.metallic = 0.5f}, 0.01);
    }
    TEST_CASE("a white furnace shows rough glass no darker than smooth, within 2 %") {
        furnace("glass 1.5 from outside", {.transmission = 1, .thin = false}, 0.02);
        furnace("glass 1.5 from inside", {.transmission = 1, .thin = false}, 0.02, true);
        furnace("glass 1.2", {.ior = 1.2f, .transmission = 1, .thin = false}, 0.02);
        furnace("glass 2.4 from outside", {.ior = 2.4f, .transmission = 1, .thin = false}, 0.02);
        furnace("glass 2.4 from inside", {.ior = 2.4f, .transmission = 1, .thin = false}, 0.02, true);
        furnace("pane", {.transmission = 1}, 0.02);
        furnace("coated white", {}, 0.01);
    }
    TEST_CASE("without it, light is lost as single scattering loses it") {
        const double mu[] = {1, .8, .5, .2}, alpha[] = {.5, 1},
                     albedo[][4] = {{.687849, .682046, .698251, .789929}, {.306853, .351256, .450694, .641648}};
        for (int a = 0; a < 2; ++a)
            for (int m = 0; m < 4; ++m) {
                const Returned r =
                    returned(level({.metallic = 1, .roughness = float(std::sqrt(alpha[a])), .compensated = false}, mu[m]), 60'000, 17);
                CHECK(std::fabs(r.mean[1] - albedo[a][m]) <= 4.5 * r.error + 1e-4);
            }
    }
    TEST_CASE("a coloured metal grows more colourful, not brighter than its colour") {
        const Spectrum gold{1, 0.77f, 0.34f};
        const Returned rough = returned(level({.baseColor = gold, .metallic = 1, .roughness = 1}, 0.8), 60'000, 19);
        CHECK(rough.mean[0] == Approx(1).epsilon(0.01));
        for (std::size_t k = 1; k < 3; ++k) CHECK(rough.mean[k] < double(gold[k]) + 0.05);
        CHECK(rough.mean[2] / rough.mean[0] < 0.36);
    }
}
