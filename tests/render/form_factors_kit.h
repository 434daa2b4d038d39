// Closed forms of form factors (the catalogue of J. R. Howell, C-11, C-14, C-41) and sums over rows, for their tests.
#pragma once
#include "integrators/radiosity/form_factors.h"
#include "tests/render/patches_kit.h"
#include <numbers>
#include <numeric>

namespace chiaro::test {

using namespace radiosity;

inline constexpr double pi64 = std::numbers::pi;
using Corners = std::vector<Vec3d>;

// C-11: parallel rectangles a x b at distance d.
inline double parallel(double a, double b, double d) {
    const double x = a / d, y = b / d, x2 = x * x, y2 = y * y, p = std::sqrt(1 + x2), q = std::sqrt(1 + y2);
    return 2 / (pi64 * x * y) *
           (std::log(std::sqrt((1 + x2) * (1 + y2) / (1 + x2 + y2))) + x * q * std::atan(x / q) + y * p * std::atan(y / p) -
            x * std::atan(x) - y * std::atan(y));
}
// C-14: rectangles w and h wide that share an edge of length 1 at a right angle.
inline double perpendicular(double w, double h) {
    const double w2 = w * w, h2 = h * h, s = std::sqrt(h2 + w2), all = 1 + w2 + h2;
    return 1 / (pi64 * w) *
           (w * std::atan(1 / w) + h * std::atan(1 / h) - s * std::atan(1 / s) +
            .25 * std::log((1 + w2) * (1 + h2) / all * std::pow(w2 * all / ((1 + w2) * (w2 + h2)), w2) *
                           std::pow(h2 * all / ((1 + h2) * (w2 + h2)), h2)));
}
// C-41: coaxial discs of radii r1, r2 at distance h, from the first.
inline double discs(double r1, double r2, double h) {
    const double a = r1 / h, b = r2 / h, x = 1 + (1 + b * b) / (a * a);
    return (x - std::sqrt(x * x - 4 * (b / a) * (b / a))) / 2;
}

inline Corners floorOf(double a, double b) { return {{0, 0, 0}, {a, 0, 0}, {a, b, 0}, {0, b, 0}}; } // front +z
inline Corners ceilingOf(double a, double b, double d) { return {{0, 0, d}, {0, b, d}, {a, b, d}, {a, 0, d}}; }
inline Corners wallOf(double b, double h) { return {{0, 0, 0}, {0, b, 0}, {0, b, h}, {0, 0, h}}; } // on the floor's edge x = 0, front +x

inline double sumOf(const std::vector<Factor>& row) {
    return std::accumulate(row.begin(), row.end(), 0.0, [](double s, const Factor& f) { return s + double(f.factor); });
}
inline double factorOf(const std::vector<Factor>& row, uint32_t j) {
    for (const Factor& f : row)
        if (f.patch == j) return double(f.factor);
    return 0;
}
// From all patches of a part to all of another: the mean of their rows' sums by area.
inline double betweenParts(const FormFactors& f, uint32_t from, uint32_t to) {
    const Patches& p = f.patches();
    double flux = 0, area = 0;
    std::vector<Factor> row;
    for (const uint32_t i : ofPart(p, from)) {
        f.row(i, row);
        for (const Factor& x : row)
            if (p[x.patch].part == to) flux += double(p[i].area) * double(x.factor);
        area += double(p[i].area);
    }
    return flux / area;
}

inline FormFactorSettings by(FormFactorMethod method) {
    FormFactorSettings s;
    s.method = method;
    return s;
}
inline FormFactorSettings exact() {
    FormFactorSettings s = by(FormFactorMethod::analytic);
    s.shadowRays = 0;
    return s;
}

} // namespace chiaro::test
