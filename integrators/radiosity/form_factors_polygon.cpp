#include "integrators/radiosity/form_factors_polygon.h"
#include "core/render/fault.h"
#include <algorithm>
#include <numbers>
#include <vector>

namespace chiaro::radiosity {
namespace {

constexpr double pi64 = std::numbers::pi;

// Gauss-Legendre on [0, 1].
struct Rule {
    std::vector<double> x, w;
};
Rule gauss(int n) {
    Rule r;
    for (int i = 0; i < n; ++i) {
        double z = std::cos(pi64 * (i + 0.75) / (n + 0.5)), slope = 1;
        for (int step = 0; step < 50; ++step) { // Newton's method on the Legendre polynomial
            double p = 1, before = 0;
            for (int k = 1; k <= n; ++k) {
                const double older = before;
                before = p;
                p = ((2 * k - 1) * z * before - (k - 1) * older) / k;
            }
            slope = n * (z * p - before) / (z * z - 1);
            const double step64 = p / slope;
            z -= step64;
            if (std::fabs(step64) < 1e-16) break;
        }
        r.x.push_back((1 - z) / 2);
        r.w.push_back(1 / ((1 - z * z) * slope * slope));
    }
    return r;
}
// Graded towards both ends: x = t^3 (10 - 15 t + 6 t^2) makes x ln x three times differentiable there (after Sidi 1993).
Rule graded(int n) {
    Rule r = gauss(n);
    for (int i = 0; i < n; ++i) {
        const std::size_t k = std::size_t(i);
        const double t = r.x[k];
        r.x[k] = t * t * t * (10 - 15 * t + 6 * t * t);
        r.w[k] *= 30 * t * t * (1 - t) * (1 - t);
    }
    return r;
}

struct Segment {
    Vec3d a, d; // from, direction
    double length = 0;
};

// The integral of ln |x - y| over y on the segment.
double inner(const Vec3d& x, const Segment& s) noexcept {
    const Vec3d from = x - s.a;
    const double along = dot(from, s.d), h2 = lengthSquared(from - s.d * along), h = std::sqrt(h2);
    const auto upTo = [&](double t) {
        const double r2 = t * t + h2;
        return r2 > 0 ? t * (0.5 * std::log(r2) - 1) + (h > 0 ? h * std::atan2(t, h) : 0) : 0;
    };
    return upTo(s.length - along) - upTo(-along);
}

// Of two stretches of one line: G with G'' = ln |u|.
double onOneLine(double a, double b, double c, double d) noexcept {
    const auto g = [](double u) { return u == 0 ? 0 : u * u * (0.5 * std::log(std::fabs(u)) - 0.75); };
    return g(b - c) + g(a - d) - g(b - d) - g(a - c);
}

double between(const Segment& s, const Vec3d& p) noexcept {
    const double t = std::clamp(dot(p - s.a, s.d), 0.0, s.length);
    return lengthSquared(s.a + s.d * t - p);
}

// The least distance of two segments that do not cross.
double distance(const Segment& s, const Segment& r) noexcept {
    const Vec3d sEnd = s.a + s.d * s.length, rEnd = r.a + r.d * r.length;
    double least = std::min({between(s, r.a), between(s, rEnd), between(r, s.a), between(r, sEnd)});
    const double c = dot(s.d, r.d), sine2 = 1 - c * c; // feet of the common perpendicular
    if (sine2 > 1e-12) {
        const Vec3d w = r.a - s.a;
        const double x = (dot(w, s.d) - c * dot(w, r.d)) / sine2, y = (c * dot(w, s.d) - dot(w, r.d)) / sine2;
        if (x > 0 && x < s.length && y > 0 && y < r.length) least = std::min(least, lengthSquared(s.a + s.d * x - r.a - r.d * y));
    }
    return std::sqrt(least);
}

double integrate(const Segment& outer, const Segment& s, double from, double to, const Rule& rule) noexcept {
    double sum = 0;
    for (std::size_t k = 0; k < rule.x.size(); ++k) sum += rule.w[k] * inner(outer.a + outer.d * (from + (to - from) * rule.x[k]), s);
    return sum * (to - from);
}

double logIntegral(const Segment& s, const Segment& r) noexcept {
    static const Rule four = gauss(4), six = gauss(6), ten = gauss(10), ends = graded(20);
    const double scale = std::max(s.length, r.length), c = dot(s.d, r.d);
    const double a = dot(r.a - s.a, s.d), b = a + r.length * c;
    if (std::fabs(c) > 1 - 1e-12) {
        const Vec3d off = r.a - s.a - s.d * a;
        if (lengthSquared(off) < 1e-14 * scale * scale) return onOneLine(0, s.length, std::min(a, b), std::max(a, b));
    }
    const double apart = distance(s, r) / s.length;
    if (apart > 2) return integrate(s, r, 0, s.length, four);
    if (apart > 1) return integrate(s, r, 0, s.length, six);
    if (apart > 0.6) return integrate(s, r, 0, s.length, ten);
    // Near: the integrand bends beside the ends of the other segment.
    double cuts[4] = {0, std::clamp(a, 0.0, s.length), std::clamp(b, 0.0, s.length), s.length};
    std::sort(cuts, cuts + 4);
    double sum = 0;
    for (int k = 0; k < 3; ++k)
        if (cuts[k + 1] - cuts[k] > 1e-9 * s.length) sum += integrate(s, r, cuts[k], cuts[k + 1], ends);
    return sum;
}

} // namespace

Polygon clipped(std::span<const Vec3d> polygon, const Vec3d& p, const Vec3d& n) noexcept {
    Polygon kept;
    if (fault(Fault::formFactorHorizon)) {
        for (const Vec3d& c : polygon) kept.add(c);
        return kept;
    }
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec3d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        const double da = dot(a - p, n), db = dot(b - p, n);
        if (da >= 0) kept.add(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) kept.add(a + (b - a) * (da / (da - db)));
    }
    return kept;
}

namespace {

// One edge's share, seen from the origin.
double seenEdge(const Vec3d& a, const Vec3d& b, const Vec3d& n) noexcept {
    const Vec3d across = cross(b, a);
    const double sine = length(across);
    return sine > 0 ? dot(across, n) * (std::atan2(sine, dot(a, b)) / sine) : 0;
}

template <class Corner> double lambert(const Vec3d& p, const Vec3d& n, std::span<const Corner> polygon) noexcept {
    const bool clip = !fault(Fault::formFactorHorizon);
    double sum = 0;
    Vec3d leaves, enters; // where a convex outline goes down to the horizon and comes back; between them it runs along it
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        Vec3d a = cast<double>(polygon[k]) - p, b = cast<double>(polygon[(k + 1) % polygon.size()]) - p;
        const double da = dot(a, n), db = dot(b, n);
        if (clip && da <= 0 && db <= 0) continue;
        if (clip && (da < 0 || db < 0)) {
            const Vec3d at = a + (b - a) * (da / (da - db));
            (da < 0 ? a : b) = at;
            (da < 0 ? enters : leaves) = at;
        } else if (clip && da == 0) {
            enters = a;
        } else if (clip && db == 0) {
            leaves = b;
        }
        sum += seenEdge(a, b, n);
    }
    return std::max((sum + seenEdge(leaves, enters, n)) / (2 * pi64), 0.0);
}

} // namespace

double pointToPolygon(const Vec3d& p, const Vec3d& n, std::span<const Vec3d> polygon) noexcept { return lambert(p, n, polygon); }
double pointToPolygon(const Vec3d& p, const Vec3d& n, std::span<const Vec3> polygon) noexcept { return lambert(p, n, polygon); }

double exchangeArea(std::span<const Vec3d> first, const Vec3d& n1, std::span<const Vec3d> second, const Vec3d& n2) noexcept {
    const Polygon a = clipped(first, second[0], n2), b = clipped(second, first[0], n1);
    if (a.n < 3 || b.n < 3) return 0;
    double sum = 0;
    for (std::size_t i = 0; i < a.n; ++i) {
        Segment s{a.corner[i], a.corner[(i + 1) % a.n] - a.corner[i]};
        s.length = length(s.d);
        if (!(s.length > 0)) continue;
        s.d *= 1 / s.length;
        for (std::size_t j = 0; j < b.n; ++j) {
            Segment r{b.corner[j], b.corner[(j + 1) % b.n] - b.corner[j]};
            r.length = length(r.d);
            if (!(r.length > 0)) continue;
            r.d *= 1 / r.length;
            const double c = dot(s.d, r.d);
            if (std::fabs(c) > 1e-15) sum += c * logIntegral(s, r);
        }
    }
    return std::max(sum / (2 * pi64), 0.0);
}

} // namespace chiaro::radiosity
