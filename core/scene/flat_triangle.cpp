#include "core/scene/flat_triangle.h"
#include "core/scene/accel.h"
#include "core/scene/scene.h"

namespace chiaro {

bool Scene::flat(const Hit& hit, FlatTriangle& f) const noexcept {
    const Geometry& g = geometries_[hit.geometry];
    if (hit.instance != Hit::none || !g.normals.empty() || !g.colors.empty() || g.deforms()) return false;
    const auto i = g.triangle(hit.triangle);
    const Vec3 &a = g.positions[i[0]], &b = g.positions[i[1]], &c = g.positions[i[2]];
    f.a = a;
    f.e1 = b - a;
    f.e2 = c - a;
    const Vec3 normal = cross(f.e1, f.e2);
    f.height = heightOf(f.e1, f.e2, length(normal));
    f.error = gamma8 * max(maxAbs(a), max(maxAbs(b), maxAbs(c)));
    f.ng = unitOr(normal, Vec3{0, 0, 1});
    f.material = g.material;
    f.light = g.firstLight == Lights::none ? Lights::none : g.firstLight + hit.triangle;
    return true;
}

} // namespace chiaro
