// What the tests of patches and form factors share: the work of a pre-pass, without a view, and scenes of a few polygons.
#pragma once
#include "integrators/radiosity/patches.h"
#include "tests/render/measure.h"
#include "tests/work_kit.h"

namespace chiaro::test {

inline radiosity::Patches patchesOf(const Bare& bare, float size) {
    radiosity::PatchSettings s;
    s.size = size;
    return radiosity::Patches::of(bare.work, s);
}
inline radiosity::Patches patchesByCount(const Bare& bare, uint32_t count) {
    radiosity::PatchSettings s;
    s.count = count;
    return radiosity::Patches::of(bare.work, s);
}

// A room of one box, seen from inside: six walls of one grey.
inline SceneDesc room(const Vec3d& halfExtent = {.5, .5, .5}) {
    SceneDesc d;
    shapes::add(d, "room", shapes::insideOut(shapes::box(halfExtent)), shapes::add(d, shapes::diffuse("grey", Spectrum(.5f))));
    return d;
}
// Two plates of unit edges: the floor at y = 0, and one of the given corners.
inline SceneDesc twoPlates(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& e) {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
    shapes::add(d, "floor", shapes::quad({0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}), grey); // front up
    shapes::add(d, "other", shapes::quad(a, b, c, e), grey);
    return d;
}
// The patches of a node's part.
inline std::vector<uint32_t> ofPart(const radiosity::Patches& patches, uint32_t part) {
    std::vector<uint32_t> found;
    for (uint32_t i = 0; i < patches.size(); ++i)
        if (patches[i].part == part) found.push_back(i);
    return found;
}

} // namespace chiaro::test
