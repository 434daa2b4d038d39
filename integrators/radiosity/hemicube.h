// The hemicube (Cohen and Greenberg, The Hemi-Cube, 1985): half a cube of side 2 about a point, its faces divided into pixels, each of
// which is a known share of the hemisphere weighted by the cosine: its delta form factor. What is seen through a pixel receives it.
//   top, at z = 1     dA / (pi (x^2 + y^2 + 1)^2)
//   sides, e.g. x = 1 z dA / (pi (y^2 + z^2 + 1)^2)
// Each is integrated over its pixel exactly, so that all pixels sum to 1; which surface a pixel shows is decided at its middle, and that is
// the error of the method (aliasing).
#pragma once
#include "core/math/vec.h"
#include <vector>

namespace chiaro::radiosity {

class Hemicube {
public:
    explicit Hemicube(uint32_t resolution); // pixels along the edge of the top; even, at least 2
    uint32_t resolution() const noexcept { return n_; }
    uint32_t pixels() const noexcept { return 3 * n_ * n_; }
    struct Pixel {
        Vec3 direction; // unit, about +z
        float factor = 0;
    };
    // Pixels come in blocks of 4 x 4, or 2 x 4 and less at edges: neighbours follow each other, so that sixteen rays go the same way.
    Pixel operator[](uint32_t i) const noexcept { return {directions_[i], factors_[i]}; }
    // Of a pixel of the top (columns and rows from the corner at -1, -1) and of the side x = 1 (columns along y, rows from z = 0).
    float top(uint32_t column, uint32_t row) const noexcept;
    float side(uint32_t column, uint32_t row) const noexcept;
    // The mid-point approximations of both, as they were first published.
    double topByMiddle(uint32_t column, uint32_t row) const noexcept;
    double sideByMiddle(uint32_t column, uint32_t row) const noexcept;

private:
    uint32_t n_;
    std::vector<Vec3> directions_;
    std::vector<float> factors_;
};

} // namespace chiaro::radiosity
