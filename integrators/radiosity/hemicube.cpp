#include "integrators/radiosity/hemicube.h"
#include <numbers>

namespace chiaro::radiosity {
namespace {

constexpr double pi64 = std::numbers::pi;

// The factor of the rectangle from the axis to (x, y) on the top: antiderivative in both.
double topUpTo(double x, double y) noexcept {
    const double a = std::sqrt(1 + x * x), b = std::sqrt(1 + y * y);
    return (x / a * std::atan(y / a) + y / b * std::atan(x / b)) / (2 * pi64);
}
double sideUpTo(double y, double z) noexcept {
    const double a = std::sqrt(1 + z * z);
    return -std::atan(y / a) / (2 * pi64 * a);
}
template <class F> double over(F upTo, double x0, double x1, double y0, double y1) noexcept {
    return upTo(x1, y1) - upTo(x0, y1) - upTo(x1, y0) + upTo(x0, y0);
}

} // namespace

Hemicube::Hemicube(uint32_t resolution) : n_(std::max(2u, resolution + resolution % 2)) {
    constexpr uint32_t block = 4;
    directions_.reserve(pixels());
    factors_.reserve(pixels());
    for (int face = 0; face < 5; ++face) {
        const uint32_t rows = face == 0 ? n_ : n_ / 2;
        for (uint32_t y = 0; y < rows; y += block)
            for (uint32_t x = 0; x < n_; x += block)
                for (uint32_t j = y; j < std::min(y + block, rows); ++j)
                    for (uint32_t i = x; i < std::min(x + block, n_); ++i) {
                        const float across = -1 + (float(i) + 0.5f) * 2 / float(n_), up = (float(j) + 0.5f) * 2 / float(n_);
                        const Vec3 d = face == 0   ? Vec3{across, up - 1, 1}
                                       : face == 1 ? Vec3{1, across, up}
                                       : face == 2 ? Vec3{-across, 1, up}
                                       : face == 3 ? Vec3{-1, -across, up}
                                                   : Vec3{across, -1, up};
                        directions_.push_back(normalize(d));
                        factors_.push_back(face == 0 ? top(i, j) : side(i, j));
                    }
    }
}

float Hemicube::top(uint32_t column, uint32_t row) const noexcept {
    const auto edge = [this](uint32_t i) { return -1 + 2.0 * i / n_; };
    return float(over(topUpTo, edge(column), edge(column + 1), edge(row), edge(row + 1)));
}
float Hemicube::side(uint32_t column, uint32_t row) const noexcept {
    const auto edge = [this](uint32_t i) { return 2.0 * i / n_; };
    return float(over(sideUpTo, edge(column) - 1, edge(column + 1) - 1, edge(row), edge(row + 1)));
}
double Hemicube::topByMiddle(uint32_t column, uint32_t row) const noexcept {
    const double step = 2.0 / n_, x = (column + 0.5) * step - 1, y = (row + 0.5) * step - 1, r = x * x + y * y + 1;
    return step * step / (pi64 * r * r);
}
double Hemicube::sideByMiddle(uint32_t column, uint32_t row) const noexcept {
    const double step = 2.0 / n_, y = (column + 0.5) * step - 1, z = (row + 0.5) * step, r = y * y + z * z + 1;
    return z * step * step / (pi64 * r * r);
}

} // namespace chiaro::radiosity
