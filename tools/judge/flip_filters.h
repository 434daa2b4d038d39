// The two filter banks of FLIP, as horizontal and vertical passes over planes: contrast sensitivity (a Gaussian a channel, two for
// blue-yellow) and feature detection (first and second derivatives of a Gaussian). The two-dimensional kernels of the paper are separated:
// a (pi/b) exp(-pi^2 (x^2 + y^2)/b) is a product, and so is each term of a sum of them.
#pragma once
#include <cstdint>
#include <vector>

namespace chiaro::judge {

using Plane = std::vector<float>;
using Kernel = std::vector<float>; // 2 radius + 1 weights

struct ContrastKernels {
    Kernel achromatic, redGreen; // each sums to 1
    Kernel blueYellow[2];        // the two terms; their squared sums add up to 1
};
ContrastKernels contrastKernels(double pixelsPerDegree);

struct FeatureKernels {
    Kernel gauss, edge, point; // edge, point: positive weights sum to 1, negative ones to -1
};
FeatureKernels featureKernels(double pixelsPerDegree);

// One-dimensional convolutions with the border repeated. Mode::derivative takes the values relative to the one at the centre: the same for
// a kernel that sums to 0, but exactly 0 where the picture is constant (FLIP takes a square root of what is left there).
enum class Mode { plain, derivative };
Plane filterRows(const Plane&, uint32_t width, uint32_t height, const Kernel&, Mode = Mode::plain);
Plane filterColumns(const Plane&, uint32_t width, uint32_t height, const Kernel&, Mode = Mode::plain);

} // namespace chiaro::judge
