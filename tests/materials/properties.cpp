// What holds for every closure whatever its parameters: reciprocity, energy, densities of both directions, finite answers everywhere.
#include "materials/dispersion.h"
#include "tests/materials/closures.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>
#include <string>

using namespace chiaro;
using namespace chiaro::test;
using doctest::Approx;

namespace {

Vec3 randomDirection(stats::Random& u) {
    const float x = u(), y = u();
    return uniformSphere(Point2{x, y});
}
// A direction that a narrow lobe answers for: sampled, else anywhere.
Vec3 partner(const Bsdf& b, stats::Random& u) {
    const float uLobe = u(), x = u(), y = u();
    const auto s = b.sample(uLobe, {x, y});
    return s && !s->delta && uLobe < 0.8f ? s->wi : randomDirection(u);
}
// Up to rounding: beside total reflection 1 - F goes like a square root and keeps few digits (f of ior 2.4: 1e-5).
bool near(const Spectrum& a, const Spectrum& b, float relative) {
    for (std::size_t i = 0; i < 3; ++i)
        if (std::fabs(a[i] - b[i]) > relative * (std::fabs(a[i]) + std::fabs(b[i])) + 2e-5f) return false;
    return true;
}
bool near(float a, float b, float relative) { return near(Spectrum(a), Spectrum(b), relative); }
Spectrum divided(const Spectrum& a, const Spectrum& b) { return {a[0] / b[0], a[1] / b[1], a[2] / b[2]}; }
// Of the medium behind the surface, each channel's own.
Spectrum squaredIors(const BsdfParameters& p) {
    if (p.thin || p.ior == 0 || p.transmission == 0) return Spectrum(1);
    const Spectrum n = p.dispersion > 0 ? Dispersion::iors(p.ior, p.dispersion) : Spectrum(p.ior);
    return n * n;
}
// Energy that one direction scatters, by sampling: smooth and delta lobes, green and its largest channel.
stats::Moments sampledAlbedo(const Bsdf& b, int n, uint64_t seed) {
    stats::Moments m;
    stats::Random u(seed);
    for (int i = 0; i < n; ++i) {
        const float uLobe = u(), x = u(), y = u();
        const auto s = b.sample(uLobe, {x, y});
        m.add(s ? double(s->weight[1]) : 0);
    }
    return m;
}

} // namespace

TEST_SUITE("closure-properties") {
    TEST_CASE("Lambert: f = rho/pi, every weight is rho") {
        const Bsdf b = closure({"", {.baseColor = sand, .specular = 0}}, direction(40));
        stats::Random u(1);
        for (int i = 0; i < 1000; ++i) {
            const float uLobe = u(), x = u(), y = u();
            const auto s = b.sample(uLobe, {x, y});
            REQUIRE(s);
            CHECK(near(s->weight, sand, 1e-6f));
            CHECK(s->event == Event::DR);
            CHECK(near(b.evaluate(s->wi).f(), sand * (1 / pi), 1e-6f));
        }
    }
    TEST_CASE("reciprocity, both densities, adjoint pairs") {
        for (const ClosureCase& c : closures) {
            INFO(std::string(c.name));
            stats::Random u(17);
            int worst = 0;
            for (int i = 0; i < 10'000; ++i) {
                const Vec3 wo = randomDirection(u);
                const Bsdf b = closure(c, wo);
                const Vec3 wi = partner(b, u);
                // Nearer to the horizon than this, the rounding of the directions themselves is all one would see.
                if (absDot(wo, surface.z) < 1e-3f || absDot(wi, surface.z) < 1e-3f) continue;
                const bool transmitted = dot(wo, surface.z) * dot(wi, surface.z)<0, outside = dot(wo, surface.z)> 0;
                const Bsdf reverse = closure(c, wi), adjoint = closure(c, wo, Transport::importance);
                const BsdfValue ab = b.evaluate(wi), ba = reverse.evaluate(wo), star = adjoint.evaluate(wi);
                const Spectrum squared = transmitted ? squaredIors(c.parameters) : Spectrum(1), one(1);
                const bool good = near(divided(ab.f(), outside ? one : squared), divided(ba.f(), outside ? squared : one), 4e-3f) &&
                                  near(ab.pdfW, ba.pdfReverseW, 4e-3f) && near(ab.pdfReverseW, ba.pdfW, 4e-3f) &&
                                  near(star.f(), ba.f(), 4e-3f) && near(star.pdfW, ab.pdfW, 1e-5f);
                worst += !good;
            }
            CHECK(worst == 0);
        }
    }
    TEST_CASE("a sample is what evaluate says of its direction") {
        for (const ClosureCase& c : closures)
            for (double degrees : incidences) {
                INFO(std::string(c.name) << " at " << degrees);
                const Bsdf b = closure(c, direction(degrees));
                stats::Random u(23);
                int wrong = 0;
                for (int i = 0; i < 1000; ++i) {
                    const float uLobe = u(), x = u(), y = u();
                    const auto s = b.sample(uLobe, {x, y});
                    if (!s) continue;
                    wrong += !finite(s->weight) || std::fabs(length(s->wi) - 1) > 1e-5f || !(s->pdfW > 0);
                    if (s->delta) continue;
                    // World and local directions differ by rounding: a narrow lobe at grazing sees that.
                    const float loose = sharpest(c.parameters) < 0.0225f || std::fabs(degrees - 90) < 1 || c.parameters.ior == 1.05f ||
                                                c.parameters.dispersion > 0
                                            ? 0.05f
                                            : 1e-3f;
                    const BsdfValue v = b.evaluate(s->wi);
                    wrong += !near(v.f() * (absDot(s->wi, b.normal()) / v.pdfW), s->weight, loose) || !near(v.pdfW, s->pdfW, loose);
                }
                CHECK(wrong <= 1);
            }
    }
    TEST_CASE("terms apart are the terms together") {
        stats::Random u(29);
        for (const ClosureCase& c : closures)
            for (int i = 0; i < 300; ++i) {
                const Bsdf b = closure(c, randomDirection(u));
                const Vec3 wi = partner(b, u);
                const BsdfValue one = b.evaluate(wi), two = b.evaluate(wi, Terms::apart);
                CHECK((one.n <= 1 && one.pdfW == two.pdfW && near(one.f(), two.f(), 1e-6f)));
                if (two.n == 2) {
                    const bool through = dot(wi, surface.z) * dot(b.normal(), surface.z) < 0;
                    CHECK(two.terms[0].event == (through ? Event::DT : Event::DR));
                    CHECK(two.terms[1].event == (through ? Event::GT : Event::GR));
                }
            }
    }
    TEST_CASE("deltaSplit agrees with the dice") {
        for (const ClosureCase& c : closures)
            for (double degrees : incidences) {
                INFO(std::string(c.name) << " at " << degrees);
                const Bsdf b = closure(c, direction(degrees));
                const DeltaBranches branches = b.deltaSplit();
                stats::Random u(31);
                int wrong = 0, deltas = 0;
                for (int i = 0; i < 500; ++i) {
                    const float uLobe = u(), x = u(), y = u();
                    const auto s = b.sample(uLobe, {x, y});
                    if (!s || !s->delta) continue;
                    ++deltas;
                    bool found = c.parameters.dispersion > 0; // by its own wavelength: see below
                    for (const DeltaBranch& d : branches)
                        found |= d.event == s->event && length(d.wi - s->wi) < 1e-6f && near(d.weight, s->weight * s->pdfW, 1e-5f);
                    wrong += !found;
                }
                CHECK(wrong == 0);
                CHECK((branches.n > 0 || deltas == 0));
                // The reverse pmf is the pmf of the way back.
                for (const DeltaBranch& d : branches) {
                    const Bsdf reverse = closure(c, d.wi);
                    stats::Random v(1);
                    for (int i = 0; i < 200; ++i) {
                        const float uLobe = v(), x = v(), y = v();
                        const auto there = b.sample(uLobe, {x, y});
                        const auto back = reverse.sample(uLobe, {x, y});
                        if (there && back && there->event == d.event && back->event == d.event && length(there->wi - d.wi) < 1e-5f &&
                            length(back->wi - direction(degrees)) < 1e-5f)
                            CHECK(near(there->pdfReverseW, back->pdfW, std::fabs(degrees - 90) < 1 ? 2e-2f : 1e-3f));
                    }
                }
            }
    }
    TEST_CASE("no closure gives more than it gets") {
        for (const ClosureCase& c : closures)
            for (double degrees : incidences) {
                INFO(std::string(c.name) << " at " << degrees);
                const stats::Moments m = sampledAlbedo(closure(c, direction(degrees), Transport::importance), 20'000, 37);
                CHECK(m.mean - 5 * m.error() <= 1.0006);
            }
    }
    TEST_CASE("white furnace: a white coated base loses nothing") {
        for (float roughness : {0.f, 0.1f, 0.2f, 0.35f, 0.5f, 0.7f, 1.f})
            for (float ior : {1.2f, 1.33f, 1.5f, 1.8f, 2.4f, 0.f})
                for (float mu : {1.f, 0.8f, 0.5f, 0.25f, 0.1f, 0.05f}) {
                    const BsdfParameters p{.roughness = roughness, .ior = ior, .specularColor = Spectrum(ior == 0 ? 0.1f : 1)};
                    const Bsdf b(p, {0, 0, 1}, {0, 0, 1}, {std::sqrt(1 - mu * mu), 0, mu});
                    const stats::Moments m = sampledAlbedo(b, 60'000, 41);
                    INFO("roughness " << roughness << " ior " << ior << " mu " << mu << ": " << m.mean << " +- " << m.error());
                    CHECK(m.mean < 1.0006 + 4.5 * m.error());
                    CHECK(m.mean > 0.998 - 4.5 * m.error());
                }
    }
    TEST_CASE("smooth glass and pane lose nothing, and basic radiance grows by eta squared") {
        const BsdfParameters solid{.roughness = 0, .transmission = 1, .thin = false}, pane{.roughness = 0, .transmission = 1};
        for (double degrees : {0., 30., 60., 85., 150., 120., 100.}) {
            const auto total = [&](const BsdfParameters& p, Transport t) {
                float sum = 0;
                for (const DeltaBranch& d : closure({"", p}, direction(degrees), t).deltaSplit()) sum += d.weight[0];
                return double(sum);
            };
            CHECK(total(solid, Transport::importance) == Approx(1).epsilon(1e-6));
            CHECK(total(pane, Transport::radiance) == Approx(1).epsilon(1e-6));
        }
        const DeltaBranches leaving = closure({"", solid}, direction(180)).deltaSplit();
        REQUIRE(leaving.n == 2);
        CHECK(double(leaving.b[1].weight[0]) == Approx(0.96 * 2.25).epsilon(1e-5));
        const DeltaBranches through = closure({"", pane}, direction(60)).deltaSplit();
        CHECK(double(through.b[0].weight[0]) == Approx(.163767537).epsilon(1e-4));
        CHECK(length(through.b[1].wi + direction(60)) < 1e-6f);
        CHECK(closure({"", {.roughness = 0, .ior = 1, .transmission = 1, .thin = false}}, direction(30)).deltaSplit().n == 1);
    }
    TEST_CASE("a million directions, none of them NaN") {
        stats::Random u(43);
        int bad = 0;
        const auto extreme = [&] {
            Vec3 w = randomDirection(u);
            const uint64_t kind = u.next() % 8;
            const float z = kind == 0 ? 1e-7f : kind == 1 ? -1e-7f : kind == 2 ? 0 : w.z;
            if (kind == 3) return Vec3{0, 0, w.z > 0 ? 1.f : -1.f};
            const float s = std::sqrt((1 - z * z) / std::max(w.x * w.x + w.y * w.y, 1e-20f));
            return Vec3{w.x * s, w.y * s, z};
        };
        for (int i = 0; i < 1'000'000; ++i) {
            const ClosureCase& c = closures[u.next() % closureCount];
            const Vec3 wo = extreme(), wi = extreme();
            const uint64_t kind = u.next() % 4;
            Vec3 ns = kind == 0 ? normalize(randomDirection(u) + Vec3{0, 0, 0.5f}) : Vec3{0, 0, 1};
            if (ns.z < 0) ns = -ns;
            const Bsdf b(c.parameters, {0, 0, 1}, ns, wo, kind & 1 ? Transport::importance : Transport::radiance);
            const BsdfValue v = b.evaluate(wi);
            bad += !finite(v.f()) || !std::isfinite(v.pdfW) || !std::isfinite(v.pdfReverseW) || v.f()[0] < 0 || v.pdfW < 0;
            const float uLobe = u(), x = i % 16 ? u() : 0, y = i % 17 ? u() : oneMinusEpsilon;
            if (const auto s = b.sample(uLobe, {x, y}))
                bad += !finite(s->weight) || !finite(s->wi) || !(s->pdfW > 0) || !std::isfinite(s->pdfW) || s->weight[0] < 0;
            for (const DeltaBranch& d : b.deltaSplit()) bad += !finite(d.weight) || !finite(d.wi);
            bad += !finite(b.albedo()) || !finite(b.diffuseAlbedo()) || !finite(b.normal());
        }
        CHECK(bad == 0);
    }
}

TEST_SUITE("shading-normals") {
    TEST_CASE("no light leaks, no black specks") {
        stats::Random u(47);
        const Vec3 ng{0, 0, 1};
        for (const ClosureCase& c : closures)
            for (int i = 0; i < 500; ++i) {
                Vec3 wo = randomDirection(u), ns = normalize(randomDirection(u) + Vec3{0, 0, 1.2f});
                if (ns.z < 0.05f) continue;
                const Bsdf b(c.parameters, ng, ns, wo);
                CHECK(dot(b.normal(), wo) > 0);
                const float uLobe = u(), x = u(), y = u();
                const auto s = b.sample(uLobe, {x, y});
                if (!s) continue;
                const bool passed = s->event == Event::ST || s->event == Event::GT || s->event == Event::DT;
                CHECK((s->wi.z * wo.z < 0) == passed);
            }
    }
    TEST_CASE("importance is the adjoint of radiance") {
        stats::Random u(53);
        const Vec3 ng{0, 0, 1};
        for (const ClosureCase& c : closures) {
            INFO(std::string(c.name));
            int wrong = 0;
            for (int i = 0; i < 2000; ++i) {
                const Vec3 ns = normalize(randomDirection(u) * 0.5f + ng), wo = randomDirection(u);
                const Bsdf b(c.parameters, ng, ns, wo);
                const Vec3 wi = partner(b, u);
                const float no = std::fabs(dot(wo, ns)), ni = std::fabs(dot(wi, ns));
                if (dot(wo, ns) * wo.z <= 0 || dot(wi, ns) * wi.z <= 0 || std::min(no, ni) < 0.02f || std::fabs(wi.z) < 0.02f ||
                    std::fabs(wo.z) < 0.02f)
                    continue;
                // Veach 1997, 5.3: f* |wi.ns| / |wi.ng| with light arriving along wi = f |wi.ns| / |wi.ng| seen from wo.
                const Bsdf star(c.parameters, ng, ns, wi, Transport::importance);
                const Spectrum lit = star.evaluate(wo).f() * (no / std::fabs(wo.z)), seen = b.evaluate(wi).f() * (ni / std::fabs(wi.z));
                wrong += !near(lit, seen, 4e-3f);
            }
            CHECK(wrong == 0);
        }
    }
    TEST_CASE("a geometric normal is used as it is, however grazing") {
        const float mu = 1e-4f;
        const Bsdf b({}, {0, 0, 1}, {0, 0, 1}, {std::sqrt(1 - mu * mu), 0, mu});
        CHECK(b.normal() == Vec3{0, 0, 1});
        const Bsdf back({}, {0, 0, 1}, {0, 0, 1}, {0, 0, -1});
        CHECK(back.normal() == Vec3{0, 0, -1});
        CHECK(back.evaluate({0, 0, -1}).n == 1);
    }
}
