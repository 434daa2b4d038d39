// Importance over shading normals: what a light path scatters is what the camera path on the same way backwards sees, silhouettes included,
// and every direction that scatters light can be drawn.
#include "tests/materials/closures.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

Vec3 anyDirection(stats::Random& u) { return uniformSphere(Point2{float(u()), float(u())}); }

} // namespace

TEST_SUITE("adjoint") {
    TEST_CASE("importance along a way is radiance along its reverse, wherever the shading normal looks") {
        stats::Random u(61);
        const Vec3 ng{0, 0, 1};
        for (const ClosureCase& c : closures) {
            INFO(std::string(c.name));
            int wrong = 0, hidden = 0, compared = 0;
            for (int i = 0; i < 20'000; ++i) {
                const Vec3 ns = normalize(anyDirection(u) * 0.9f + ng), camera = anyDirection(u), light = anyDirection(u);
                if (ns.z < 0.1f || std::fabs(camera.z) < 0.02f || std::fabs(light.z) < 0.02f) continue;
                const Bsdf seen(c.parameters, ng, ns, camera), lit(c.parameters, ng, ns, light, Transport::importance);
                const float cosine = absDot(seen.normal(), light), cosineLit = absDot(lit.normal(), camera);
                if (cosine < 1e-3f || cosineLit < 1e-3f) continue;
                const Spectrum a = seen.evaluate(light).f() * (cosine / std::fabs(light.z)),
                               b = lit.evaluate(camera).f() * (cosineLit / std::fabs(camera.z));
                for (std::size_t k = 0; k < 3; ++k)
                    wrong += !(std::fabs(a[k] - b[k]) <= 1e-2f * std::max(a[k], b[k]) + 2e-5f); // near total reflection 1 - F cancels
                compared += !black(a);
                hidden += !black(a) && (dot(ns, camera) * camera.z < 0 || dot(ns, light) * light.z < 0);
            }
            CHECK(wrong == 0);
            if (Bsdf(c.parameters, ng, ng, ng).smooth()) CHECK(hidden > compared / 100);
        }
    }
    TEST_CASE("what is drawn is all that is scattered") {
        const Vec3 ng{0, 0, 1};
        for (const ClosureCase& c : closures) {
            if (c.parameters.roughness < 0.25f || c.parameters.metallic * (1 - c.parameters.roughness) > 0.6f)
                continue; // the grid is uniform
            for (const Vec3& ns : {normalize(Vec3{0.5f, 0, 1}), normalize(Vec3{0.8f, 0.3f, 0.6f})})
                for (const Vec3& light : {normalize(Vec3{0.2f, -0.4f, 1}), normalize(Vec3{-1.5f, 0.2f, 0.7f})}) {
                    INFO(std::string(c.name) << ", ns.light " << dot(ns, light));
                    const Bsdf lit(c.parameters, ng, ns, light, Transport::importance);
                    stats::Random u(67);
                    constexpr int n = 100'000;
                    // Twice: uniform directions, and the closure's own.
                    double sum[2] = {}, squares[2] = {};
                    for (int i = 0; i < n; ++i) {
                        const Vec3 w = anyDirection(u);
                        const double all = double(luminance(lit.evaluate(w).f())) * double(absDot(lit.normal(), w)) * 4 * double(pi);
                        const float uLobe = float(u());
                        const Point2 p{float(u()), float(u())};
                        const auto s = lit.sample(uLobe, p);
                        const double drawn = s && !s->delta ? double(luminance(s->weight)) : 0;
                        sum[0] += all, squares[0] += all * all, sum[1] += drawn, squares[1] += drawn * drawn;
                    }
                    const auto variance = [&](int k) { return (squares[k] / n - sqr(sum[k] / n)) / n; };
                    CHECK(std::fabs(sum[0] - sum[1]) / n <= 5 * std::sqrt(variance(0) + variance(1)) + 1e-6);
                }
        }
    }
    TEST_CASE("the density of a sample is that of its direction") {
        stats::Random u(71);
        const Vec3 ng{0, 0, 1};
        for (const ClosureCase& c : closures) {
            INFO(std::string(c.name));
            int wrong = 0;
            for (int i = 0; i < 2000; ++i) {
                const Vec3 ns = normalize(anyDirection(u) * 0.9f + ng), light = anyDirection(u);
                if (ns.z < 0.1f) continue;
                const Bsdf lit(c.parameters, ng, ns, light, Transport::importance);
                const float uLobe = float(u());
                const Point2 p{float(u()), float(u())};
                const auto s = lit.sample(uLobe, p);
                if (!s || s->delta) continue;
                wrong += lit.evaluate(s->wi).pdfW != s->pdfW;
            }
            CHECK(wrong == 0);
        }
    }
}
