#include "io/gltf_path.h"
#include "core/scene/motion.h"
#include <algorithm>
#include <cmath>

namespace chiaro::gltf {

namespace {

Vec3d column(const Affine& a, int j) { return {a.m[0][j], a.m[1][j], a.m[2][j]}; }
double widest(const Affine& a) { return std::max(length(column(a, 0)), std::max(length(column(a, 1)), length(column(a, 2)))); }

// What a path is measured by: the way of its origin, and the largest scale on it.
struct Size {
    double way = 0, scale = 0, far = 0;
};
Size sizeOf(const std::vector<Affine>& maps) {
    Size s;
    for (const Affine& m : maps) {
        s.way = std::max(s.way, length(column(m, 3) - column(maps.front(), 3)));
        s.scale = std::max(s.scale, widest(m));
        s.far = std::max(s.far, length(column(m, 3)));
    }
    return s;
}

bool canBeTakenApart(const std::vector<Affine>& maps) {
    const bool mirrored = maps.front().determinant() < 0;
    return std::all_of(maps.begin(), maps.end(), [&](const Affine& m) {
        const double size = widest(m);
        return std::abs(m.determinant()) > 1e-9 * size * size * size && (m.determinant() < 0) == mirrored;
    });
}

// How far a motion of so many segments leaves the path: its worst error in units of what is allowed, and as a share of the way and the
// size. Short of the most segments, up to the first error above 1.
struct Misfit {
    double excess = 0, share = 0;
};
Misfit misfitOf(const Path& path, size_t segments, const Size& size, double radius) {
    const Motion motion(motionAlong(path, segments), {0, 1});
    const double turn = 1e-4 * size.scale, way = 1e-5 * size.way + 1e-4 * radius * size.scale + 1e-12 * size.far;
    Misfit worst;
    const auto add = [&worst](double off, double allowed, double whole) {
        if (!(off > 0)) return;
        worst.excess = std::max(worst.excess, off / allowed);
        worst.share = std::max(worst.share, off / whole);
    };
    for (size_t i = 0; i < Path::samples && (worst.excess <= 1 || segments == Motion::mostKeys - 1); ++i) {
        const Affine m = motion.exact(double(i) / double(Path::samples - 1));
        for (int j = 0; j < 3; ++j) add(length(column(m, j) - column(path[i], j)), turn, size.scale);
        add(length(column(m, 3) - column(path[i], 3)), way, size.way + radius * size.scale);
    }
    return worst;
}

} // namespace

MotionDesc motionAlong(const Path& path, size_t segments) {
    MotionDesc maps;
    for (size_t i = 0; segments > 0 && i <= segments; ++i) maps.push_back(path[i * (Path::samples - 1) / segments]);
    return maps;
}

Segments segmentsFor(const Path& path, double radius) {
    const std::vector<Affine>& maps = path.maps();
    if (std::all_of(maps.begin(), maps.end(), [&](const Affine& m) { return m == maps.front(); })) return {};
    constexpr size_t most = Motion::mostKeys - 1;
    if (!canBeTakenApart(maps)) return {most, 0}; // something shrinks to nothing: Scene::compile sees to it
    const Size size = sizeOf(maps);
    Misfit worst;
    for (size_t segments = 1; segments <= most; segments *= 2) {
        worst = misfitOf(path, segments, size, radius);
        if (worst.excess <= 1) return {segments, 0};
    }
    return {most, worst.share};
}

} // namespace chiaro::gltf
