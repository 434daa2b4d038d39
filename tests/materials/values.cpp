// Fresnel, Snell and microfacet numbers that were derived elsewhere (closed forms and independent quadratures).
#include "materials/albedo_tables.h"
#include "materials/fresnel.h"
#include "materials/microfacet.h"
#include "tests/materials/closures.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>
#include <string>

using namespace chiaro;
using doctest::Approx;

namespace {

double degrees(double d) { return d * std::numbers::pi / 180; }
double exact(double deg, double eta) { return fresnelDielectric(std::cos(degrees(deg)), eta); }
Vec3d spherical(double theta, double phi) {
    return {std::sin(degrees(theta)) * std::cos(degrees(phi)), std::sin(degrees(theta)) * std::sin(degrees(phi)), std::cos(degrees(theta))};
}
// The mean of share(o, h) over the visible normals h of GGX seen from o at cosine mu, by midpoint quadrature; finer towards grazing.
template <class F> double overVisibleNormals(double alpha, double mu, const F& share) {
    const Ggx<double> g{alpha, alpha};
    const Vec3d o{std::sqrt(1 - mu * mu), 0, mu};
    constexpr int n = 400;
    double sum = 0;
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
            const double v = 1 - (b + 0.5) / n;
            sum += 3 * v * v * share(g, o, g.sampleVisible(o, {(a + 0.5) / n / 2, 1 - v * v * v}));
        }
    return sum / (n * n);
}
// Directional albedo with F(c), reflected; or refracted through the facets; masking separable or correlated.
template <class F> double reflected(double alpha, double mu, const F& f, bool correlated = true) {
    return overVisibleNormals(alpha, mu, [&](const Ggx<double>& g, const Vec3d& o, const Vec3d& h) {
        const Vec3d i = reflect(o, h);
        return i.z > 0 ? f(dot(o, h)) * (correlated ? g.g2(o, i) / g.g1(o) : g.g1(i)) : 0;
    });
}
double refracted(double alpha, double mu, double eta) {
    return overVisibleNormals(alpha, mu, [&](const Ggx<double>& g, const Vec3d& o, const Vec3d& h) {
        const Vec3d i = refract(o, h, eta), m{i.x, i.y, -i.z};
        return i.z < 0 ? (1 - fresnelDielectric(dot(o, h), eta)) * g.g2(o, m) / g.g1(o) : 0;
    });
}

} // namespace

TEST_SUITE("fresnel") {
    TEST_CASE("air to glass") {
        const double angle[] = {0, 15, 30, 45, 60, 75, 80, 85, 89};
        const double f[] = {.04, .040080767, .041522626, .050239911, .089186713, .25306056, .38770435, .61279965, .90418495};
        for (int i = 0; i < 9; ++i) {
            CHECK(exact(angle[i], 1.5) == Approx(f[i]).epsilon(1e-6));
            CHECK(double(fresnelDielectric(float(std::cos(degrees(angle[i]))), 1.5f)) == Approx(f[i]).epsilon(1e-4));
        }
        CHECK(exact(56.3099325, 1.5) == Approx(.073964497).epsilon(1e-6));
    }
    TEST_CASE("glass to air, total reflection") {
        const double angle[] = {10, 20, 30, 40, 41, 41.5, 41.8, 42, 89};
        const double f[] = {.040082959, .041728518, .055190167, .2452912, .37975127, .54161999, .89077192, 1, 1};
        for (int i = 0; i < 9; ++i) CHECK(exact(angle[i], 1 / 1.5) == Approx(f[i]).epsilon(1e-6));
        const double critical[][2] = {{1.333, 48.606626}, {1.309, 49.812954}, {1.5, 41.810315}, {1.6, 38.682187}, {2.42, 24.407469}};
        for (const auto& [n, deg] : critical) {
            CHECK(exact(deg - 1e-4, 1 / n) < 1);
            CHECK(exact(deg + 1e-4, 1 / n) == 1);
        }
        CHECK(exact(62.706176 + 1e-4, 1.333 / 1.5) == 1);
        CHECK(exact(79.111152 - 1e-4, 1.309 / 1.333) < 1);
    }
    TEST_CASE("matched and infinite indices need no division by zero") {
        for (float c : {0.f, 1e-7f, 0.3f, 1.f}) {
            CHECK(fresnelDielectric(c, 1.f) == 0);
            CHECK(dielectricShape(c, 1.f) == 0);
            CHECK(fresnelDielectric(c, 1e6f) > 0.8f);
        }
        CHECK(paneReflectance(fresnelDielectric(1.0, 1.5)) == Approx(1.0 / 13).epsilon(1e-9));
        CHECK(paneReflectance(exact(60, 1.5)) == Approx(.163767537).epsilon(1e-7));
    }
    TEST_CASE("Schlick against exact") {
        const double n[] = {1.5, 1.333, 2.42}, most[] = {.0356926, .0591781, .0756912}, least[] = {-.0196258, -.0093630, -.0135820};
        for (int k = 0; k < 3; ++k) {
            const double f0 = fresnelNormal(n[k]);
            double high = 0, low = 0;
            for (int i = 0; i <= 90000; ++i) {
                const double c = std::cos(degrees(i * 1e-3)), d = f0 + (1 - f0) * schlickShape(c) - fresnelDielectric(c, n[k]);
                high = std::max(high, d), low = std::min(low, d);
            }
            CHECK(high == Approx(most[k]).epsilon(1e-5));
            CHECK(low == Approx(least[k]).epsilon(1e-4));
        }
        double mean = 0, meanSchlick = 0;
        for (int i = 0; i < 200000; ++i) {
            const double c = (i + 0.5) / 200000;
            mean += 2 * c * fresnelDielectric(c, 1.5) / 200000;
            meanSchlick += 2 * c * (0.04 + 0.96 * schlickShape(c)) / 200000;
        }
        CHECK(mean == Approx(.0917779593).epsilon(1e-7));
        CHECK(meanSchlick == Approx(.0857142857).epsilon(1e-7));
        const AlbedoSlice mirror(0, 1.5f);
        CHECK(double(0.04f + 0.96f * mirror.average().shape) == Approx(.0917779593).epsilon(2e-4));
    }
    TEST_CASE("Snell") {
        const double n[] = {1.333, 1.309, 1.5}, out[] = {32.036723, 32.696474, 28.125506};
        for (int i = 0; i < 3; ++i) {
            const Vec3d t = refract(spherical(45, 0), Vec3d{0, 0, 1}, n[i]);
            CHECK(std::asin(-t.x) / std::numbers::pi * 180 == Approx(out[i]).epsilon(1e-7));
            const Vec3d back = refract(t, Vec3d{0, 0, -1}, 1 / n[i]);
            CHECK(length(back - spherical(45, 0)) < 1e-12);
        }
        const Vec3d t = refract(spherical(60, 180), Vec3d{0, 0, 1}, 1.5);
        CHECK(t.x == Approx(.5773502692).epsilon(1e-9));
        CHECK(t.z == Approx(-.8164965809).epsilon(1e-9));
    }
}

TEST_SUITE("microfacets") {
    TEST_CASE("values of D and G1") {
        const double alpha[] = {.1, .5, 1}, g1[] = {.992610, .861002, .666667}, d20[] = {.2011100, .6976575, .3183099};
        for (int i = 0; i < 3; ++i) {
            const Ggx<double> g{alpha[i], alpha[i]};
            CHECK(g.g1(spherical(60, 20)) == Approx(g1[i]).epsilon(2e-6));
            CHECK(g.d(spherical(20, 70)) == Approx(d20[i]).epsilon(1e-6));
            CHECK(g.d({0, 0, 1}) == Approx(1 / (std::numbers::pi * alpha[i] * alpha[i])));
        }
    }
    TEST_CASE("D cos and the visible normals integrate to one, isotropic and not") {
        for (const auto& [ax, ay] : {std::pair{.1, .1}, {.5, .5}, {1., 1.}, {.1, .3}})
            for (double theta : {0., 40., 80.}) {
                const Ggx<double> g{ax, ay};
                const Vec3d o = spherical(theta, 30);
                double sum = 0, visible = 0;
                constexpr int n = 1500;
                for (int a = 0; a < n; ++a)
                    for (int b = 0; b < n / 3; ++b) { // tan of the angle is t/(1-t), so that the long tail is covered
                        const double t = (a + 0.5) / n, tan = ax * t / (1 - t), phi = 2 * std::numbers::pi * (b + 0.5) / (n / 3);
                        const double c = 1 / std::sqrt(1 + tan * tan), s = tan * c;
                        const Vec3d h{s * std::cos(phi), s * std::sin(phi), c};
                        const double area = c * c * s * ax / ((1 - t) * (1 - t)) * 2 * std::numbers::pi / (double(n) * (n / 3));
                        sum += g.d(h) * c * area;
                        visible += g.g1(o) * g.d(h) * std::max(0.0, dot(o, h)) / o.z * area;
                    }
                CHECK(sum == Approx(1).epsilon(1e-5));
                CHECK(visible == Approx(1).epsilon(1e-5));
            }
    }
    TEST_CASE("directional albedo, F = 1, single scattering") {
        const double mu[] = {1, .8, .5, .2}, alpha[] = {.1, .25, .5, 1};
        const double correlated[][4] = {{.988304, .984566, .969205, .904559},
                                        {.915812, .897272, .857263, .848160},
                                        {.687849, .682046, .698251, .789929},
                                        {.306853, .351256, .450694, .641648}};
        const double separable[][4] = {{.687849, .679637, .686007, .738978}, {.306853, .340948, .409137, .511421}};
        const auto one = [](double) { return 1.0; };
        for (int a = 0; a < 4; ++a)
            for (int m = 0; m < 4; ++m) {
                CHECK(reflected(alpha[a], mu[m], one) == Approx(correlated[a][m]).epsilon(2e-5));
                if (a >= 2) CHECK(reflected(alpha[a], mu[m], one, false) == Approx(separable[a - 2][m]).epsilon(2e-5));
            }
    }
    TEST_CASE("rough glass from the air side") {
        const double alpha[] = {.1, .1, .5, .5, 1, 1}, mu[] = {1, .5, 1, .5, 1, .5};
        const double r[] = {.039637, .085882, .028175, .043935, .012702, .023387};
        for (int i = 0; i < 6; ++i)
            CHECK(reflected(alpha[i], mu[i], [](double c) { return fresnelDielectric(c, 1.5); }) == Approx(r[i]).epsilon(5e-5));
        CHECK(refracted(1, .5, 1.5) == Approx(.7184).epsilon(1e-4));
        CHECK(refracted(.1, 1, 1.5) == Approx(.959198).epsilon(1e-4));
    }
    TEST_CASE("glTF's metal") {
        const BsdfParameters p{.baseColor = {.8f, .4f, .2f}, .metallic = 1, .roughness = .5f, .compensated = false};
        const auto f = [&](const Vec3d& o, const Vec3d& i) {
            return Bsdf(p, {0, 0, 1}, {0, 0, 1}, cast<float>(o)).evaluate(cast<float>(i)).f();
        };
        const double mirror[] = {1.977423079, .9913740554, .4983495438}, across[] = {.0576508177, .0288284827, .0144173152};
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(double(f(spherical(45, 180), spherical(45, 0))[k]) == Approx(mirror[k]).epsilon(1e-5));
            CHECK(double(f(spherical(30, 90), spherical(60, 0))[k]) == Approx(across[k]).epsilon(1e-5));
        }
    }
    TEST_CASE("visible normals are sampled with their density, anisotropic too") {
        for (const auto& [ax, ay] : {std::pair{.1, .3}, {.02, .02}, {.7, .7}})
            for (double theta : {0., 30., 60., 85., 89.9}) {
                const Ggx<double> g{ax, ay};
                const Vec3d o = spherical(theta, 25);
                stats::Random u(uint64_t(theta * 10));
                // Under h -> (x/ax, y/ay, z)/length the density is that of alpha 1: a histogram over its cos and phi.
                constexpr int rows = 16, columns = 24, sub = 12, n = 200'000;
                std::vector<double> seen(rows * columns), due(rows * columns);
                for (int i = 0; i < n; ++i) {
                    const double x = double(u()), y = double(u());
                    const Vec3d h = g.sampleVisible(o, {x, y}), s = normalize(Vec3d{h.x / ax, h.y / ay, h.z});
                    const double phi = std::atan2(s.y, s.x) / (2 * std::numbers::pi);
                    seen[std::size_t(std::min(int(s.z * rows), rows - 1) * columns +
                                     std::clamp(int((phi < 0 ? phi + 1 : phi) * columns), 0, columns - 1))]++;
                }
                for (int r = 0; r < rows * sub; ++r)
                    for (int c = 0; c < columns * sub; ++c) {
                        const double z = (r + 0.5) / (rows * sub), phi = 2 * std::numbers::pi * (c + 0.5) / (columns * sub),
                                     w = std::sqrt(1 - z * z);
                        const Vec3d s{w * std::cos(phi), w * std::sin(phi), z}, raw{s.x * ax, s.y * ay, s.z}, h = normalize(raw);
                        const double jacobian = ax * ay / std::pow(length(raw), 3); // solid angle of h over that of s
                        due[std::size_t(r / sub * columns + c / sub)] += n * g.visible(o) * g.d(h) * std::max(0.0, dot(o, h)) * jacobian *
                                                                         2 * std::numbers::pi / (rows * sub * double(columns * sub));
                    }
                const stats::ChiSquare x = stats::chiSquare(seen, due);
                CHECK_MESSAGE(x.p > stats::sidak(15), "alpha " << ax << " " << ay << " at " << theta << " deg, p " << x.p);
            }
    }
}
