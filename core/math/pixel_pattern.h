// Pixel patterns: where the samples of a pixel lie, when the pattern itself is the subject (classical anti-aliasing) and not the sampler's
// sequence. A pattern is a list of positions in the unit square, (0, 0) the pixel's corner; it is the same for every pixel. What varies
// from pixel to pixel is done where a sample starts (Starts, core/render/integrator.h): `jitter` moves each position inside a square,
// `shifted` moves the whole pattern around the edges, which keeps its toroidal distances.
//
//   regular grid     gridPattern(n)                          aliases coherently: its spectrum is a comb
//   jittered grid    gridPattern(n), jitter 1/n              Cook, Stochastic Sampling in Computer Graphics, 1986
//   Poisson disc     poissonPattern(n, seed), shifted        white noise without its low frequencies (Yellott 1983)
//
// Errors: Error(Exit::usage) for a pattern of no points or of more than mostPatternPoints.
#pragma once
#include "core/math/vec.h"
#include <cstdint>
#include <span>
#include <vector>

namespace chiaro {

inline constexpr uint32_t mostPatternPoints = 4096;

// The centres of n x n equal cells, row by row.
std::vector<Point2> gridPattern(uint32_t n);

// So many points of the unit torus, no two nearer than 0.65 of the distance that the densest packing allows (most patterns keep 0.73 to
// 0.75). Every prefix is spread over the pixel too. The same seed gives the same points. Takes time by the square of the count: 4 ms for
// 256 points, a second for 4096.
std::vector<Point2> poissonPattern(uint32_t count, uint64_t seed);

// The smallest distance between two points, around the edges; 1 (a point and its own image) for less than two.
double minimumDistance(std::span<const Point2> pattern) noexcept;
// The largest that so many points can have: sqrt(2 / (sqrt(3) n)), the hexagonal packing (Lagae and Dutre, A Comparison of Methods for
// Generating Poisson Disk Distributions, 2008).
double densestDistance(std::size_t points) noexcept;

} // namespace chiaro
