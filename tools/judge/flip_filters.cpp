#include "tools/judge/flip_filters.h"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace chiaro::judge {

namespace {
constexpr double pi = std::numbers::pi;

// Contrast sensitivity in the spatial domain (Andersson et al. 2020, table 1): a sqrt(pi/b) exp(-pi^2 x^2/b), x in degrees.
struct Term {
    double a, b;
};
constexpr Term achromatic{1, 0.0047}, redGreen{1, 0.0053}, blueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};
constexpr double widest = 0.04;        // largest b: sets the radius
constexpr double featureWidth = 0.082; // degrees: width of the feature detector, two standard deviations

using Weights = std::vector<double>;

Weights gaussian(int radius, double pixelsPerDegree, double scale, double b) {
    Weights w;
    for (int i = -radius; i <= radius; ++i) w.push_back(scale * std::exp(-pi * pi * (i / pixelsPerDegree) * (i / pixelsPerDegree) / b));
    return w;
}
double total(const Weights& w) {
    double sum = 0;
    for (const double v : w) sum += v;
    return sum;
}
Kernel scaled(const Weights& w, double positive, double negative) {
    Kernel k;
    for (const double v : w) k.push_back(float(v * (v > 0 ? positive : negative)));
    return k;
}
// Positive and negative weights each brought to a sum of 1 in size.
Kernel balanced(const Weights& w) {
    double positive = 0, negative = 0;
    for (const double v : w) (v > 0 ? positive : negative) += std::abs(v);
    return scaled(w, 1 / positive, 1 / negative);
}

void accumulate(float* to, const float* values, const float* centre, float weight, uint32_t count, Mode mode) noexcept {
    if (mode == Mode::plain)
        for (uint32_t x = 0; x < count; ++x) to[x] += weight * values[x];
    else
        for (uint32_t x = 0; x < count; ++x) to[x] += weight * (values[x] - centre[x]);
}
} // namespace

ContrastKernels contrastKernels(double pixelsPerDegree) {
    const int radius = int(std::ceil(3 * std::sqrt(widest / (2 * pi * pi)) * pixelsPerDegree));
    const auto unit = [&](const Term& t) {
        const Weights w = gaussian(radius, pixelsPerDegree, 1, t.b);
        return scaled(w, 1 / total(w), 0);
    };
    // Each term of the sum is the product of two equal factors, sqrt(a sqrt(pi/b)) exp(...).
    Weights terms[2];
    double norm = 0;
    for (int k = 0; k < 2; ++k) {
        const Term& t = blueYellow[k];
        terms[k] = gaussian(radius, pixelsPerDegree, std::sqrt(t.a * std::sqrt(pi / t.b)), t.b);
        norm += total(terms[k]) * total(terms[k]);
    }
    norm = 1 / std::sqrt(norm);
    return {unit(achromatic), unit(redGreen), {scaled(terms[0], norm, 0), scaled(terms[1], norm, 0)}};
}

FeatureKernels featureKernels(double pixelsPerDegree) {
    const double deviation = 0.5 * featureWidth * pixelsPerDegree;
    const int radius = int(std::ceil(3 * deviation));
    Weights gauss, edge, point;
    for (int i = -radius; i <= radius; ++i) {
        const double x = i / deviation, g = std::exp(-0.5 * x * x);
        gauss.push_back(g);
        edge.push_back(-x * g);
        point.push_back((x * x - 1) * g);
    }
    return {scaled(gauss, 1 / total(gauss), 0), balanced(edge), balanced(point)};
}

Plane filterRows(const Plane& in, uint32_t width, uint32_t height, const Kernel& kernel, Mode mode) {
    const std::size_t radius = kernel.size() / 2;
    Plane out(in.size(), 0.0f), row(width + 2 * radius);
    for (uint32_t y = 0; y < height; ++y) {
        const float* from = in.data() + std::size_t(y) * width;
        float* to = out.data() + std::size_t(y) * width;
        std::fill_n(row.begin(), radius, from[0]);
        std::copy_n(from, width, row.begin() + std::ptrdiff_t(radius));
        std::fill_n(row.begin() + std::ptrdiff_t(radius + width), radius, from[width - 1]);
        for (std::size_t k = 0; k < kernel.size(); ++k) {
            const float weight = kernel[k];
            const float* shifted = row.data() + k;
            accumulate(to, shifted, from, weight, width, mode);
        }
    }
    return out;
}

Plane filterColumns(const Plane& in, uint32_t width, uint32_t height, const Kernel& kernel, Mode mode) {
    const int radius = int(kernel.size() / 2);
    Plane out(in.size(), 0.0f);
    for (int y = 0; y < int(height); ++y) {
        float* to = out.data() + std::size_t(y) * width;
        const float* centre = in.data() + std::size_t(y) * width;
        for (int k = -radius; k <= radius; ++k) {
            const float weight = kernel[std::size_t(k + radius)];
            const float* from = in.data() + std::size_t(std::clamp(y + k, 0, int(height) - 1)) * width;
            accumulate(to, from, centre, weight, width, mode);
        }
    }
    return out;
}

} // namespace chiaro::judge
