// Form factors of flat convex polygons, exact, in double precision, without anything between them.
//   dA -> polygon     Lambert's formula (Lambert 1760; Baum, Rushmeier, Winget 1989): F = 1/(2 pi) sum of angle_k n . unit(R_k+1 x R_k)
//   polygon, polygon  Stokes' theorem twice (Sparrow 1963): A F = 1/(2 pi) sum over pairs of edges of d . d' times the double integral of
//                     ln r. The inner integral is elementary; the outer one is by Gauss' rule, finer the nearer the edges are, split and
//                     graded where they touch; edges on one line (the shared edge of neighbours) are elementary altogether.
// Both after clipping at the horizon: of a polygon only what lies before the other's plane sees it.
// Relative error below 1e-7 (patches that share an edge or a corner included). Units: metres; results in square metres, or none.
#pragma once
#include "core/math/vec.h"
#include <array>
#include <span>

namespace chiaro::radiosity {

// A clipped quadrilateral has five corners, clipped again six.
struct Polygon {
    std::array<Vec3d, 8> corner;
    std::size_t n = 0;
    void add(const Vec3d& p) noexcept { corner[n++] = p; }
    std::span<const Vec3d> all() const noexcept { return {corner.data(), n}; }
};
// What lies on the side of the plane through p to which n points (Sutherland and Hodgman 1974).
Polygon clipped(std::span<const Vec3d> polygon, const Vec3d& p, const Vec3d& n) noexcept;

// dA at p with normal n -> polygon; corners counter-clockwise seen from where it shines to. 0 from behind.
double pointToPolygon(const Vec3d& p, const Vec3d& n, std::span<const Vec3d> polygon) noexcept;
double pointToPolygon(const Vec3d& p, const Vec3d& n, std::span<const Vec3> polygon) noexcept;

// A_1 F_12 = A_2 F_21 of two polygons with their normals, square metres. At most 7 corners each,
// counter-clockwise seen from the front. The same bits in
// either order only as long as the caller keeps to one.
double exchangeArea(std::span<const Vec3d> first, const Vec3d& normal1, std::span<const Vec3d> second, const Vec3d& normal2) noexcept;

} // namespace chiaro::radiosity
