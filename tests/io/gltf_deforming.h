// A square that skins and morph targets deform, and where its corners are then.
#pragma once
#include "tests/io/gltf_builder.h"
#include <doctest/doctest.h>

namespace chiaro::test {

using Numbers = std::vector<float>;

// A square with corners (0,0) (1,0) (1,1) (0,1) in z = 0, and what may be made of it.
struct Deforming : Builder {
    json attributes = {{"POSITION", accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3, "VEC3")}};
    json more = {{"indices", accessor<uint8_t>({0, 1, 2, 0, 2, 3}, 1, "SCALAR")}};
    int square() { return mesh(attributes, more); }
    void target(const Numbers& positions, const Numbers& normals = {}) {
        json t = {{"POSITION", accessor<float>(positions, 3, "VEC3")}};
        if (!normals.empty()) t["NORMAL"] = accessor<float>(normals, 3, "VEC3");
        more["targets"].push_back(t);
    }
    void animate(int node, const char* path, const Numbers& times, const Numbers& values, const char* how = "LINEAR") {
        const bool weights = std::string(path) == "weights", turns = std::string(path) == "rotation";
        json& a = root["animations"][0];
        const int output = accessor<float>(values, weights ? 1 : turns ? 4 : 3, weights ? "SCALAR" : turns ? "VEC4" : "VEC3");
        a["samplers"].push_back({{"input", accessor<float>(times, 1, "SCALAR")}, {"output", output}, {"interpolation", how}});
        a["channels"].push_back({{"sampler", a["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
    }
    // Two joints, the second at (1, 0, 0) under the first; corners at x = 0 follow the first, those at x = 1 the second.
    int skinned(const char* inverse = "translations") {
        const int second = add("nodes", {{"translation", {1, 0, 0}}});
        const int first = node({{"children", {second}}});
        json skin = {{"joints", {first, second}}, {"skeleton", first}};
        Numbers matrices = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1};
        if (std::string(inverse) == "translations") skin["inverseBindMatrices"] = accessor<float>(matrices, 16, "MAT4");
        add("skins", skin);
        attributes["JOINTS_0"] = accessor<uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, 4, "VEC4");
        attributes["WEIGHTS_0"] = accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4, "VEC4");
        return second;
    }
    SceneDesc at(const Folder& folder, double time, Interval shutter = {}) const {
        Diagnostics notes;
        SceneDesc s = read(folder, notes, {.frameTime = time, .shutter = shutter});
        for (const std::string& w : notes.warnings()) CHECK_MESSAGE(w.empty(), w);
        return s;
    }
};

inline const PrimitiveDesc& shown(const SceneDesc& s, size_t instance = 0) {
    REQUIRE(s.instances.size() > instance);
    return s.meshes[size_t(s.instances[instance].mesh)].primitives[0];
}
inline Vec3d corner(const SceneDesc& s, size_t vertex, size_t instance = 0) {
    return s.instances[instance].toWorld.point(cast<double>(shown(s, instance).positions[vertex]));
}
inline void checkNear(const Vec3d& a, const Vec3d& b, double tolerance = 1e-6) {
    INFO(a.x << ", " << a.y << ", " << a.z << " for " << b.x << ", " << b.y << ", " << b.z);
    CHECK(length(a - b) <= tolerance);
}
// Over the shutter, at a share of it.
inline Vec3d during(const SceneDesc& s, size_t vertex, double share, size_t instance = 0) {
    const PrimitiveDesc& p = shown(s, instance);
    if (p.steps.empty()) return corner(s, vertex, instance);
    const double place = share * double(p.steps.size());
    const size_t first = std::min(size_t(place), p.steps.size() - 1);
    const auto at = [&](size_t step) { return cast<double>(step == 0 ? p.positions[vertex] : p.steps[step - 1].positions[vertex]); };
    return s.instances[instance].toWorld.point(at(first) * (1 - (place - double(first))) + at(first + 1) * (place - double(first)));
}

} // namespace chiaro::test
