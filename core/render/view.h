// View: what one render looks at. One scene, many views.
#pragma once
#include "core/math/ray.h"
#include "core/scene/camera.h"
#include <string_view>

namespace chiaro {

// Reconstruction by filter importance sampling (Ernst, Stamminger, Greiner 2006): the sample position is drawn from the filter, its
// weight is 1. Filters are separable and positive.
enum class FilterKind : uint8_t { box, gauss, blackmanHarris };
class Filter {
public:
    explicit Filter(FilterKind = FilterKind::blackmanHarris);
    FilterKind kind() const noexcept { return kind_; }
    float radius() const noexcept { return radius_; } // pixels
    Point2 sample(Point2 u) const noexcept;           // offset from the pixel centre
    // One axis of it, u in [0, 1).
    [[gnu::always_inline]] float offset(float u) const noexcept {
        const float x = u * cells;
        const int i = std::min(int(x), cells - 1);
        return inverse_[std::size_t(i)] + (inverse_[std::size_t(i) + 1] - inverse_[std::size_t(i)]) * (x - float(i));
    }
    double density(double x) const noexcept; // of one axis

private:
    static constexpr int cells = 1024;
    FilterKind kind_;
    float radius_;
    std::array<float, cells + 1> inverse_{}; // inverse distribution function, linear between
};

struct View {
    Camera camera;
    uint32_t width = 0, height = 0;
    Rect crop;
    Filter filter;
    Interval shutter;
};

} // namespace chiaro
