// The shapes, materials and cameras of which the built-in scenes are made. Every shape is a triangle list whose front (counter-clockwise)
// side is the one its comment names; closed shapes share their vertices, so that each edge belongs to exactly two triangles.
// Lengths in metres. No errors: the arguments are those of the scenes in this folder.
#pragma once
#include "core/scene/desc.h"
#include <array>
#include <string>

namespace chiaro::shapes {

// Corners counter-clockwise seen from the front; texture coordinates over the unit square. Four corners of a measured wall need not lie in
// one plane: flat shapes carry no vertex normals, so each triangle is shaded as the facet that it is.
PrimitiveDesc quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
// Axis-parallel box about the origin, front outwards, as six quads.
PrimitiveDesc box(const Vec3d& halfExtent);
// A regular polygon of `segments` corners about the origin in the plane y = 0, front up. Its corners lie on the circle of `radius`.
PrimitiveDesc disc(double radius, int segments);
// Sphere about the origin, front outwards: an icosahedron divided `subdivisions` times (20 x 4^subdivisions triangles), every vertex on
// the sphere, vertex normals exact. The faces lie inside the sphere by at most 0.3 / 4^subdivisions of its radius.
PrimitiveDesc sphere(double radius, int subdivisions);
// The same surface with its front where its back was.
PrimitiveDesc insideOut(PrimitiveDesc shape);
// Both in one primitive.
PrimitiveDesc joined(PrimitiveDesc first, const PrimitiveDesc& second);
// Area of the triangles, in square metres.
double area(const PrimitiveDesc& shape);

MaterialDesc diffuse(std::string name, const Spectrum& reflectance);                      // Lambert, both sides
MaterialDesc metal(std::string name, const Spectrum& atNormalIncidence, float roughness); // both sides; roughness 0 is a mirror
MaterialDesc glass(std::string name, float ior);                                          // smooth, solid, colourless
MaterialDesc lamp(std::string name, const Spectrum& radiance, const Spectrum& reflectance = Spectrum{0}); // one-sided, cd/m2

Affine translation(const Vec3d& t);
// The frame whose -Z axis points from `eye` to `target`, as cameras look, and whose +Y axis leans towards `up`.
Affine lookAt(const Vec3d& eye, const Vec3d& target, const Vec3d& up = {0, 1, 0});

// Add a material and give its index; a shape as a mesh used once; a perspective camera.
int add(SceneDesc& scene, MaterialDesc material);
void add(SceneDesc& scene, const std::string& name, PrimitiveDesc shape, int material, const Affine& toWorld = {});
void addCamera(SceneDesc& scene, const std::string& name, double yfov, const Affine& toWorld);

} // namespace chiaro::shapes
