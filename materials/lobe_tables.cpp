#include "materials/lobe_tables.h"
#include "core/math/lanes.h"
#include "materials/albedo_columns.h"
#include "materials/gauss.h"
#include "materials/microfacet.h"

namespace chiaro {
namespace {

constexpr int width = 8;
using V = Lanes<width>;
using VisibleNormal = Vec3T<V>;

float lerp(float a, float b, float f) noexcept { return a + (b - a) * f; }
V lanesAt(const std::vector<float>& v, std::size_t i) { return V(&v[i], std::experimental::element_aligned); }

// visit(h, weight) over the normals seen from wo, eight at a time; weights sum to the share of the turn, of 1.
template <class F>
void overVisibleNormals(const Ggx<V>& ggx, const Vec3T<V>& wo, const Gauss& turn, const Gauss& cap, float share, const F& visit) {
    for (std::size_t a = 0; a < turn.x.size(); ++a)
        for (std::size_t b = 0; b < cap.x.size(); b += width)
            visit(ggx.sampleVisible(wo, {V(turn.x[a] * share), lanesAt(cap.x, b)}), V(turn.w[a]) * lanesAt(cap.w, b));
}
Vec3T<V> seenAt(float mu, float phi = 0) noexcept {
    const float s = std::sqrt(1 - mu * mu);
    return {V(s * std::cos(phi)), V(s * std::sin(phi)), V(mu)};
}
// G2 / G1 of a reflection, 0 where it goes into the surface.
V reflectedShare(const Ggx<V>& ggx, const Vec3T<V>& wo, const VisibleNormal& h) noexcept {
    Vec3T<V> wi = reflect(wo, h);
    const auto lost = wi.z <= V(0);
    wi.z = max(wi.z, V(1e-9f));
    return select(lost, V(0), ggx.g2(wo, wi) / ggx.g1(wo));
}
float sum(const V& v) noexcept { return std::experimental::reduce(v); }

// The weights of 2 mu dmu between nodes that are even in the root of the cosine.
float cosineWeight(float mu, float w) noexcept { return 4 * w * std::sqrt(mu) * mu; } // mu = x^2, dmu = 2 x dx

// Rows in the fourth root of alpha.
template <int count> struct Rows {
    static constexpr float smallest = 1e-3f;
    static float first() noexcept { return std::sqrt(std::sqrt(smallest)); }
    static float alpha(int row) noexcept { return sqr(sqr(first() + (1 - first()) * float(row) / (count - 1))); }
    static void place(float alpha, int& row, float& fraction) noexcept {
        const float y = clamp01((std::sqrt(std::sqrt(alpha)) - first()) / (1 - first())) * (count - 1);
        row = std::min(int(y), count - 2);
        fraction = y - float(row);
    }
};
void split(float x, int count, int& cell, float& fraction) noexcept {
    const float scaled = clamp01(x) * float(count - 1);
    cell = std::min(int(scaled), count - 2);
    fraction = scaled - float(cell);
}

// ---- brushed

struct Brushed {
    static constexpr int rows = 12, depths = 7, columns = 14, turns = 7;
    using Plane = float[columns][turns];
    Plane cells[rows][depths];
    float averages[rows][depths];

    Brushed() {
        const Gauss turn(20), cap(24), mu(24), phi(8);
        for (int row = 0; row < rows; ++row)
            for (int depth = 0; depth < depths; ++depth) {
                const float alpha = Rows<rows>::alpha(row), strength = float(depth) / (depths - 1);
                const Ggx<V> ggx{V(BrushedSlice::along(alpha, strength)), V(alpha)};
                for (int c = 0; c < columns; ++c)
                    for (int t = 0; t < turns; ++t) {
                        const Vec3T<V> wo = seenAt(std::max(sqr(float(c) / (columns - 1)), 1e-5f), pi / 2 * float(t) / (turns - 1));
                        V all = 0;
                        overVisibleNormals(ggx, wo, turn, cap, 1,
                                           [&](const VisibleNormal& h, V w) { all += w * reflectedShare(ggx, wo, h); });
                        cells[row][depth][c][t] = sum(all);
                    }
                float mean = 0;
                for (std::size_t i = 0; i < mu.x.size(); ++i)
                    for (std::size_t j = 0; j < phi.x.size(); ++j)
                        mean += cosineWeight(sqr(mu.x[i]), mu.w[i]) * phi.w[j] * at(cells[row][depth], sqr(mu.x[i]), phi.x[j]);
                averages[row][depth] = mean;
            }
    }
    // turn: of a quarter.
    static float at(const Plane& plane, float mu, float turn) noexcept {
        int c, t;
        float fc, ft;
        split(std::sqrt(mu), columns, c, fc);
        split(turn, turns, t, ft);
        return lerp(lerp(plane[c][t], plane[c][t + 1], ft), lerp(plane[c + 1][t], plane[c + 1][t + 1], ft), fc);
    }
};
const Brushed& brushed() noexcept {
    static const Brushed t;
    return t;
}

// ---- glass

struct Glass {
    // The index axis as that of the albedo tables; columns of the inside are cosines of the outside where light can leave.
    static constexpr int rows = 18, columns = 24, iors = 10;
    static constexpr float lastRoot = 0.76f; // index 3.7
    struct Cell {
        float whole = 0, more = 0, moreShape = 0; // 1 - T for F = 0; what F = 1 and F = shape add
    };
    Cell cells[2][rows][columns][iors];
    Cell averages[2][rows][iors];

    static float ior(int slot) noexcept {
        const float root = lastRoot * (float(slot) + 0.5f) / (float(iors) - 0.5f);
        return (1 + root * root) / (1 - root * root);
    }
    static void place(float ior, int& slot, float& fraction) noexcept {
        const float root = std::sqrt((ior - 1) / (ior + 1)), x = root / lastRoot * (float(iors) - 0.5f) - 0.5f;
        slot = std::clamp(int(x), 0, iors - 2);
        fraction = clamp01(x - float(slot));
    }
    static float mu(int column) noexcept { return std::max(sqr(float(column) / (columns - 1)), 1e-5f); }

    Glass() {
        const Gauss turn(16), cap(32);
        for (int side = 0; side < 2; ++side)
            for (int row = 0; row < rows; ++row)
                for (int slot = 0; slot < iors; ++slot) {
                    for (int c = 0; c < columns; ++c)
                        cells[side][row][c][slot] = cell(side == 1, Rows<rows>::alpha(row), mu(c), ior(slot), turn, cap);
                    averages[side][row][slot] = mean(side, row, slot);
                }
    }
    static Cell cell(bool outside, float alpha, float mu, float ior, const Gauss& turn, const Gauss& cap) {
        const Ggx<V> ggx{V(alpha), V(alpha)};
        const Vec3T<V> wo = seenAt(mu);
        const float eta = outside ? ior : 1 / ior, normal = fresnelNormal(ior);
        V whole = 0, more = 0, shape = 0;
        overVisibleNormals(ggx, wo, turn, cap, 0.5f, [&](const VisibleNormal& h, V w) {
            const V c = dot(wo, h), exact = fresnelDielectric(c, V(eta)), s = (exact - V(normal)) / V(1 - normal);
            const V reflected = reflectedShare(ggx, wo, h);
            const Vec3T<V> wi = refract(wo, h, V(eta));
            const Vec3T<V> m{wi.x, wi.y, max(-wi.z, V(1e-9f))};
            const V passed = select(wi.z < V(0), ggx.g2(wo, m) / ggx.g1(wo), V(0));
            const auto total = exact >= V(1); // whatever F0 and F90
            whole += w * (V(1) - select(total, reflected, passed));
            more += w * select(total, V(0), passed - reflected);
            shape += w * select(total, V(0), s * (passed - reflected));
        });
        return {sum(whole), sum(more), sum(shape)};
    }
    Cell mean(int side, int row, int slot) const {
        static const Gauss nodes(48);
        Cell m;
        for (std::size_t i = 0; i < nodes.x.size(); ++i) {
            int c;
            float f;
            split(nodes.x[i], columns, c, f);
            const Cell &a = cells[side][row][c][slot], &b = cells[side][row][c + 1][slot];
            const float w = cosineWeight(sqr(nodes.x[i]), nodes.w[i]);
            m.whole += w * lerp(a.whole, b.whole, f), m.more += w * lerp(a.more, b.more, f),
                m.moreShape += w * lerp(a.moreShape, b.moreShape, f);
        }
        return m;
    }
};
const Glass& glass() noexcept {
    static const Glass t;
    return t;
}
Spectrum lost(const Glass::Cell& e, const Spectrum& f0, float f90) noexcept {
    Spectrum r;
    for (std::size_t i = 0; i < 3; ++i) r[i] = std::max(e.whole + f0[i] * (e.more - e.moreShape) + f90 * e.moreShape, 0.f);
    return r;
}
Glass::Cell mixed(const Glass::Cell& a, const Glass::Cell& b, float f) noexcept {
    return {lerp(a.whole, b.whole, f), lerp(a.more, b.more, f), lerp(a.moreShape, b.moreShape, f)};
}

// ---- curves

struct Curves {
    static constexpr int rows = 16, columns = 24, nodes = CurveAlbedo::nodes;
    using Weights = float[nodes];
    Weights cells[rows][columns];
    Weights averages[rows];
    Weights means; // of the curve itself

    static float muOf(float x, float alpha) noexcept {
        constexpr float scale = AlbedoColumns::scale;
        return x >= 1 ? 1 : x * x * scale * alpha / (1 + scale * alpha - x * x);
    }
    Curves() {
        const Gauss turn(16), cap(32), mu(48);
        for (int k = 0; k < nodes; ++k) means[k] = 0;
        for (std::size_t i = 0; i < mu.x.size(); ++i) add(sqr(mu.x[i]), cosineWeight(sqr(mu.x[i]), mu.w[i]), means);
        for (int row = 0; row < rows; ++row) {
            const float alpha = Rows<rows>::alpha(row);
            const Ggx<V> ggx{V(alpha), V(alpha)};
            for (int c = 0; c < columns; ++c) {
                Weights& to = cells[row][c];
                for (float& w : to) w = 0;
                const Vec3T<V> wo = seenAt(std::max(muOf(float(c) / (columns - 1), alpha), 1e-6f));
                overVisibleNormals(ggx, wo, turn, cap, 0.5f, [&](const VisibleNormal& h, V w) {
                    const V cosine = dot(wo, h), kept = w * reflectedShare(ggx, wo, h);
                    for (std::size_t lane = 0; lane < width; ++lane) add(cosine[lane], kept[lane], to);
                });
            }
            for (float& w : averages[row]) w = 0;
            for (std::size_t i = 0; i < mu.x.size(); ++i) {
                const float m = sqr(mu.x[i]);
                int c;
                float f;
                split(AlbedoColumns::place(m, alpha), columns, c, f);
                for (int k = 0; k < nodes; ++k)
                    averages[row][k] += cosineWeight(m, mu.w[i]) * lerp(cells[row][c][k], cells[row][c + 1][k], f);
            }
        }
    }
    static void add(float cosine, float weight, Weights& to) noexcept {
        int k;
        float f;
        split(cosine, nodes, k, f);
        to[k] += weight * (1 - f);
        to[k + 1] += weight * f;
    }
};
const Curves& curves() noexcept {
    static const Curves t;
    return t;
}

} // namespace

BrushedSlice::BrushedSlice(float alpha, float strength) noexcept {
    Rows<Brushed::rows>::place(alpha, row_, rowFraction_);
    split(strength, Brushed::depths, depth_, depthFraction_);
    const auto& a = brushed().averages;
    average_ = lerp(lerp(a[row_][depth_], a[row_][depth_ + 1], depthFraction_),
                    lerp(a[row_ + 1][depth_], a[row_ + 1][depth_ + 1], depthFraction_), rowFraction_);
}
float BrushedSlice::at(const Vec3& w) const noexcept {
    const float mu = std::min(std::fabs(w.z), 1.f), turn = std::atan2(std::fabs(w.y), std::fabs(w.x)) * (2 / pi);
    const auto& cells = brushed().cells;
    const auto depths = [&](int row) {
        return lerp(Brushed::at(cells[row][depth_], mu, turn), Brushed::at(cells[row][depth_ + 1], mu, turn), depthFraction_);
    };
    constexpr float margin = 0.002f; // what interpolation may err by: later facets get so much less
    return std::min(lerp(depths(row_), depths(row_ + 1), rowFraction_) + margin, 1.f);
}

GlassLoss::GlassLoss(float alpha, float ior) noexcept {
    Rows<Glass::rows>::place(alpha, row_, rowFraction_);
    Glass::place(ior, slot_, slotFraction_);
}
Spectrum GlassLoss::at(float mu, bool outside, const Spectrum& f0, float f90) const noexcept {
    int c;
    float f;
    split(std::sqrt(mu), Glass::columns, c, f);
    const auto& cells = glass().cells[outside ? 1 : 0];
    const auto column = [&](int row, int i) { return mixed(cells[row][i][slot_], cells[row][i][slot_ + 1], slotFraction_); };
    const auto row = [&](int r) { return mixed(column(r, c), column(r, c + 1), f); };
    return lost(mixed(row(row_), row(row_ + 1), rowFraction_), f0, f90);
}
Spectrum GlassLoss::average(bool outside, const Spectrum& f0, float f90) const noexcept {
    const auto& all = glass().averages[outside ? 1 : 0];
    const auto row = [&](int r) { return mixed(all[r][slot_], all[r][slot_ + 1], slotFraction_); };
    return lost(mixed(row(row_), row(row_ + 1), rowFraction_), f0, f90);
}

CurveAlbedo::CurveAlbedo(float alpha) noexcept : alpha_(alpha) { Rows<Curves::rows>::place(alpha, row_, fraction_); }
Spectrum CurveAlbedo::at(float mu, const Curve& curve) const noexcept {
    int c;
    float f;
    split(AlbedoColumns::place(mu, alpha_), Curves::columns, c, f);
    const auto *const a = curves().cells[row_], *const b = curves().cells[row_ + 1];
    Spectrum sum(0);
    for (int k = 0; k < nodes; ++k) sum += curve[k] * lerp(lerp(a[c][k], a[c + 1][k], f), lerp(b[c][k], b[c + 1][k], f), fraction_);
    return sum;
}
Spectrum CurveAlbedo::average(const Curve& curve) const noexcept {
    const auto &a = curves().averages[row_], &b = curves().averages[row_ + 1];
    Spectrum sum(0);
    for (int k = 0; k < nodes; ++k) sum += curve[k] * lerp(a[k], b[k], fraction_);
    return sum;
}
Spectrum CurveAlbedo::mean(const Curve& curve) noexcept {
    Spectrum sum(0);
    for (int k = 0; k < nodes; ++k) sum += curve[k] * curves().means[k];
    return sum;
}

} // namespace chiaro
