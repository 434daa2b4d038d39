#include "core/scene/light_tree.h"
#include "core/math/wide_isa.h"

namespace chiaro {
namespace {

constexpr std::size_t width = LightTree::width;

// What each child could bring to the point: intensity times the cosines at both ends, over the squared distance d2, each taken where the
// bounds make it largest. The angle between axis and way is lessened by the cone's and by that under which the sphere appears,
// cos(a - b) = cos a cos b + sin a sin b, or is none where sin(a - b) is not above 0. Sines and cosines carry the factors sqrt(d2) and d2
// until the end: one division, three roots side by side. In the middle of a sphere the distance counts as half its radius: the mean of 1 /
// d2 over a ball is 3 / r2 there. (With the whole radius the error of many-lights is 1.7 times as large.)
[[gnu::always_inline]] inline void weigh(const LightTree::Node& n, const Vec3& p, const Vec3& normal, float (&weight)[width]) noexcept {
    constexpr float slack = 0x1p-10f; // what rounding may take from a cosine; a light that is met at less counts as at this
    for (std::size_t i = 0; i < width; ++i) {
        const float dx = n.x[i] - p.x, dy = n.y[i] - p.y, dz = n.z[i] - p.z, r = n.radius[i];
        const float d2 = dx * dx + dy * dy + dz * dz, r2 = r * r, over = 1 / std::max(d2, r2 * 0.25f);
        const bool inside = d2 <= r2;
        const float ball = std::sqrt(std::max(d2 - r2, 0.f));
        const float along = -(dx * n.axisX[i] + dy * n.axisY[i] + dz * n.axisZ[i]);
        const float axis = n.intensity[i] < 0 ? std::fabs(along) : along, across = std::sqrt(std::max(d2 - axis * axis, 0.f));
        const float cosFace = axis * n.cosSpread[i] + across * n.sinSpread[i], sinFace = across * n.cosSpread[i] - axis * n.sinSpread[i];
        const bool facing = inside | (sinFace <= 0) | (sinFace * ball <= cosFace * r);
        const float cosLight = facing ? 1.f : (cosFace * ball + sinFace * r) * over;
        const float up = std::fabs(dx * normal.x + dy * normal.y + dz * normal.z), beside = std::sqrt(std::max(d2 - up * up, 0.f));
        const float cosHere = (inside | (beside * ball <= up * r)) ? 1.f : (up * ball + beside * r) * over;
        const float value = std::fabs(n.intensity[i]) * std::max(cosLight, slack) * std::max(cosHere, slack) * over;
        weight[i] = cosLight > n.cosReach[i] - slack ? value : 0.f;
    }
}

// The weights in a tree of sums, as the choice goes down it.
struct Sums {
    double pair[4], half[2], all;
};
[[gnu::always_inline]] inline Sums summed(const float (&w)[width]) noexcept {
    Sums s;
    for (std::size_t i = 0; i < 4; ++i) s.pair[i] = double(w[2 * i]) + double(w[2 * i + 1]);
    for (std::size_t i = 0; i < 2; ++i) s.half[i] = s.pair[2 * i] + s.pair[2 * i + 1];
    s.all = s.half[0] + s.half[1];
    return s;
}

struct Way {
    const LightTree::Node* nodes;
    const uint32_t* parents;
    uint32_t end; // children from here on are no nodes
};
struct End {
    uint32_t child = LightTree::none;
    double u = 0, pmf = 0; // what is left of u
};

[[gnu::always_inline]] inline End descend(const Way& way, const Vec3& p, const Vec3& normal, double u) noexcept {
    alignas(64) float weight[width];
    double pmf = 1;
    for (uint32_t node = 0;;) {
        const LightTree::Node& n = way.nodes[node];
        weigh(n, p, normal, weight);
        const Sums s = summed(weight);
        if (!(s.all > 0)) return {};
        // To the second of two where u lies beyond the first; never to what has no weight, should rounding have moved u.
        double rest = u * s.all;
        std::size_t at = 0;
        const auto step = [&](double first, double second) {
            const bool on = (rest >= first) & (second > 0);
            rest -= on ? first : 0;
            at = 2 * at + on;
        };
        step(s.half[0], s.half[1]);
        step(s.pair[2 * at], s.pair[2 * at + 1]);
        step(double(weight[2 * at]), double(weight[2 * at + 1]));
        const double own = double(weight[at]);
        u = std::min(rest / own, 1 - 0x1p-53);
        pmf *= own / s.all;
        node = n.child[at];
        if (node >= way.end) return {node, u, pmf};
    }
}

[[gnu::always_inline]] inline float ascend(const Way& way, const Vec3& p, const Vec3& normal, uint32_t place) noexcept {
    alignas(64) float weight[width];
    double pmf = 1;
    for (;; place = way.parents[place / width]) {
        weigh(way.nodes[place / width], p, normal, weight);
        const Sums s = summed(weight);
        if (!(s.all > 0)) return 0;
        pmf *= double(weight[place % width]) / s.all;
        if (place < width) return float(pmf);
    }
}

using Descend = End(const Way&, const Vec3&, const Vec3&, double) noexcept;
using Ascend = float(const Way&, const Vec3&, const Vec3&, uint32_t) noexcept;
End descendPlain(const Way& w, const Vec3& p, const Vec3& n, double u) noexcept { return descend(w, p, n, u); }
CHIARO_TARGET_AVX2 End descendAvx2(const Way& w, const Vec3& p, const Vec3& n, double u) noexcept { return descend(w, p, n, u); }
CHIARO_TARGET_AVX512 End descendAvx512(const Way& w, const Vec3& p, const Vec3& n, double u) noexcept { return descend(w, p, n, u); }
float ascendPlain(const Way& w, const Vec3& p, const Vec3& n, uint32_t place) noexcept { return ascend(w, p, n, place); }
CHIARO_TARGET_AVX2 float ascendAvx2(const Way& w, const Vec3& p, const Vec3& n, uint32_t place) noexcept { return ascend(w, p, n, place); }
CHIARO_TARGET_AVX512 float ascendAvx512(const Way& w, const Vec3& p, const Vec3& n, uint32_t place) noexcept {
    return ascend(w, p, n, place);
}
Descend* const descendWidest = widest<Descend>(descendPlain, descendAvx2, descendAvx512);
Ascend* const ascendWidest = widest<Ascend>(ascendPlain, ascendAvx2, ascendAvx512);

} // namespace

LightTree::Pick LightTree::choose(const Vec3& p, const Vec3& normal, double u) const noexcept {
    if (nodes_.empty()) return {};
    const End e = descendWidest({nodes_.data(), parents_.data(), patch}, p, normal, u);
    if (e.child == none) return {};
    if (e.child >= leaf) return {e.child - leaf, float(e.pmf)};
    const Member* m = &members_[e.child - patch]; // of these the first whose share, added up, is beyond u
    for (uint32_t count = m[-1].light, half; count > 1; count = e.u < double(m[half - 1].upTo) ? half : (m += half, count - half))
        half = count / 2;
    return {m->light, float(e.pmf * (double(m->upTo) - double(m[-1].upTo)))};
}

float LightTree::pmf(uint32_t light, const Vec3& p, const Vec3& normal) const noexcept {
    if (light >= places_.size() || places_[light].at == none) return 0;
    return places_[light].share * ascendWidest({nodes_.data(), parents_.data(), patch}, p, normal, places_[light].at);
}

} // namespace chiaro
