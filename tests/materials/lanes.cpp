// The leaf mathematics with 16 lanes gives what it gives for one float.
#include "core/math/lanes.h"
#include "materials/fresnel.h"
#include "materials/microfacet.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;

namespace {

using V = Lanes<16>;
struct Inputs {
    V x, y, mu, alpha, eta;
    explicit Inputs(stats::Random& u) {
        for (std::size_t i = 0; i < 16; ++i) {
            x[i] = u(), y[i] = u(), mu[i] = std::max(u(), 1e-4f), alpha[i] = 1e-3f + u();
            eta[i] = u() < 0.5f ? 1 / (1 + u()) : 1 + u();
        }
    }
};
struct Worst {
    float relative = 0;
    void operator()(float lane, float scalar) { relative = std::max(relative, std::fabs(lane - scalar) / (std::fabs(scalar) + 1e-4f)); }
    void operator()(const Vec3T<V>& lanes, std::size_t i, const Vec3& s) {
        (*this)(lanes.x[i], s.x);
        (*this)(lanes.y[i], s.y);
        (*this)(lanes.z[i], s.z);
    }
};

} // namespace

TEST_SUITE("lanes") {
    TEST_CASE("Fresnel, refraction, warps and microfacets, 16 wide") {
        stats::Random u(3);
        Worst fresnel, direction, value, sampled;
        for (int round = 0; round < 2000; ++round) {
            const Inputs in(u);
            const V s = sqrt(V(1) - in.mu * in.mu);
            const Vec3T<V> o{s, V(0), in.mu}, n{V(0), V(0), V(1)};
            const Ggx<V> g{in.alpha, in.alpha * V(0.5f)};
            const V f = fresnelDielectric(in.mu, in.eta), pane = paneReflectance(f), schlick = schlickShape(in.mu),
                    shape = dielectricShape(in.mu, in.eta);
            const Vec3T<V> t = refract(o, n, in.eta), h = g.sampleVisible(o, {in.x, in.y}), r = reflect(o, n),
                           c = cosineHemisphere(Vec2T<V>{in.x, in.y});
            const Vec3T<V> cone = uniformCone(Vec2T<V>{in.x, in.y}, in.mu);
            const FrameT<V> frame = FrameT<V>::about(h);
            const Vec2T<V> b = uniformTriangle(Vec2T<V>{in.x, in.y});
            const V g1 = g.g1(o), g2 = g.g2(o, c), visibility = g.visibility(o, c), d = g.d(h);
            for (std::size_t i = 0; i < 16; ++i) {
                const Vec3 oi{o.x[i], 0, o.z[i]};
                const Point2 ui{in.x[i], in.y[i]};
                const Ggx<float> gi{g.alphaX[i], g.alphaY[i]};
                const float mu = in.mu[i], eta = in.eta[i], fi = fresnelDielectric(mu, eta);
                fresnel(f[i], fi), fresnel(pane[i], paneReflectance(fi)), fresnel(schlick[i], schlickShape(mu));
                if (eta < 0.95f || eta > 1.05f) fresnel(shape[i], dielectricShape(mu, eta));
                direction(t, i, refract(oi, {0, 0, 1}, eta)), direction(r, i, reflect(oi, {0, 0, 1})),
                    direction(c, i, cosineHemisphere(ui));
                direction(cone, i, uniformCone(ui, mu));
                const Point2 bi = uniformTriangle(ui);
                direction.operator()(b.x[i], bi.x), direction.operator()(b.y[i], bi.y);
                const Vec3 ci{c.x[i], c.y[i], c.z[i]}, hi{h.x[i], h.y[i], h.z[i]};
                sampled(h, i, gi.sampleVisible(oi, ui));
                direction(frame.x, i, Frame::about(hi).x);
                value(g1[i], gi.g1(oi)), value(g2[i], gi.g2(oi, ci)), value(visibility[i], gi.visibility(oi, ci)), value(d[i], gi.d(hi));
            }
        }
        CHECK(fresnel.relative < 1e-4f);
        CHECK(direction.relative < 1e-2f);
        CHECK(value.relative < 1e-4f);
        CHECK(sampled.relative < 1e-2f);
    }
}
