#include "io/gltf_animation.h"
#include "io/gltf_deform.h"
#include "io/gltf_file.h"
#include "io/gltf_nodes.h"
#include "io/gltf_skin.h"
#include <Eigen/Geometry>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::gltf {

using nlohmann::json;

Affine compose(const std::array<double, 3>& t, const std::array<double, 4>& quaternion, const std::array<double, 3>& s) {
    const Eigen::Matrix3d r =
        Eigen::Quaterniond(quaternion[3], quaternion[0], quaternion[1], quaternion[2]).normalized().toRotationMatrix();
    Affine a;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) a.m[i][j] = r(i, j) * s[size_t(j)];
        a.m[i][3] = t[size_t(i)];
    }
    return a;
}

bool isRotation(const std::array<double, 4>& q) {
    const double size = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    return size > 1e-12 && std::isfinite(size);
}

namespace {

Affine localTransform(const GltfFile& file, size_t index, const Animations& animations, double seconds) {
    const tinygltf::Node& node = file.model.nodes[index];
    if (node.matrix.empty()) {
        Trs trs{numbers<3>(node.translation, {0, 0, 0}), numbers<4>(node.rotation, {0, 0, 0, 1}), numbers<3>(node.scale, {1, 1, 1})};
        animations.apply(index, seconds, trs);
        if (!isRotation(trs.rotation)) file.fail(fmt::format("/nodes/{}/rotation", index), "is no quaternion. Export the file again.");
        return compose(trs.translation, trs.rotation, trs.scale);
    }
    const auto& m = node.matrix; // column-major
    if (std::abs(m[3]) > 1e-6 || std::abs(m[7]) > 1e-6 || std::abs(m[11]) > 1e-6 || std::abs(m[15] - 1) > 1e-6)
        file.fail(fmt::format("/nodes/{}/matrix", index), "is not affine: its last row must be 0 0 0 1. Export the file again.");
    Affine a;
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 4; ++j) a.m[i][j] = m[j * 4 + i];
    return a;
}

} // namespace

size_t sceneNumber(const GltfFile& file, const std::string& wanted) {
    const json& scenes = list(file, "scenes");
    if (wanted.empty()) return file.json.value("scene", size_t(0));
    std::vector<std::string> names;
    for (size_t i = 0; i < scenes.size(); ++i) {
        names.push_back(scenes[i].value("name", std::string()));
        if (names.back() == wanted) return i;
    }
    size_t number = 0;
    const auto [end, failed] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (failed == std::errc() && end == wanted.data() + wanted.size() && number < scenes.size()) return number;
    const std::string near = nearest(wanted, names);
    names.resize(std::min<size_t>(names.size(), 20));
    throw Error(Exit::usage,
                printable(fmt::format("no scene \"{}\" in {}; have 0 to {}, by name \"{}\"{}", wanted, file.name, scenes.size() - 1,
                                      fmt::join(names, "\", \""), near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near))));
}

namespace {

// The roots of a scene; in a file without any, all nodes that are no child.
std::vector<size_t> roots(const GltfFile& file, const std::string& wanted) {
    const json &scenes = list(file, "scenes"), &nodes = list(file, "nodes");
    std::vector<bool> child(nodes.size());
    for (const auto& node : nodes)
        if (node.contains("children"))
            for (const auto& c : node["children"]) child[c.get<size_t>()] = true;
    std::vector<size_t> found;
    if (scenes.empty()) {
        if (!wanted.empty()) throw Error(Exit::usage, printable(fmt::format("no scene \"{}\": {} has none", wanted, file.name)));
        for (size_t i = 0; i < nodes.size(); ++i)
            if (!child[i]) found.push_back(i);
        return found;
    }
    const size_t scene = sceneNumber(file, wanted);
    std::vector<bool> seen(nodes.size());
    for (const auto& entry : scenes[scene].value("nodes", json::array())) {
        const size_t node = entry;
        if (seen[node] || child[node])
            file.fail(fmt::format("/scenes/{}/nodes", scene), fmt::format("names node {}, which is {}. Export the file again.", node,
                                                                          seen[node] ? "there twice" : "a child of another node"));
        seen[node] = true;
        found.push_back(node);
    }
    return found;
}

} // namespace

void checkNodes(const GltfFile& file) {
    const json& nodes = list(file, "nodes");
    std::vector<size_t> parent(nodes.size(), nodes.size());
    for (size_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].contains("children")) continue;
        for (const auto& entry : nodes[i]["children"]) {
            const size_t child = entry;
            if (parent[child] != nodes.size())
                file.fail(fmt::format("/nodes/{}/children", i),
                          fmt::format("names node {}, which node {} has already: a node has one parent. Export the file again.", child,
                                      parent[child]));
            parent[child] = i;
        }
    }
    // With one parent at most, what no root reaches is a cycle.
    std::vector<std::pair<size_t, int>> open;
    size_t reached = 0;
    std::vector<bool> seen(nodes.size());
    for (size_t i = 0; i < nodes.size(); ++i)
        if (parent[i] == nodes.size()) open.emplace_back(i, 1);
    while (!open.empty()) {
        const auto [node, depth] = open.back();
        open.pop_back();
        seen[node] = true;
        ++reached;
        if (depth > maxNodeDepth)
            file.fail(fmt::format("/nodes/{}", node),
                      fmt::format("lies more than {} nodes deep. Flatten the hierarchy and export it again.", maxNodeDepth));
        if (nodes[node].contains("children"))
            for (const auto& child : nodes[node]["children"]) open.emplace_back(child.get<size_t>(), depth + 1);
    }
    for (size_t i = 0; reached < nodes.size() && i < nodes.size(); ++i)
        if (!seen[i]) file.fail(fmt::format("/nodes/{}", i), "is its own ancestor. Export the file again.");
}

namespace {

// Under a parent that moves or by its own animation, over the shutter; else as it is at the opening.
Path pathOf(const Conversion& to, size_t index, const Path& parent) {
    const Interval shutter = to.options.shutter;
    const double open = to.options.frameTime + double(shutter.open), length = double(shutter.close) - double(shutter.open);
    const auto local = [&](double seconds) { return localTransform(to.file, index, to.animations, seconds); };
    if (!(length > 0) || (parent.rests() && !to.animations.moves(index))) return Path({parent.opening() * local(open)});
    std::vector<Affine> maps;
    for (size_t i = 0; i < Path::samples; ++i) maps.push_back(parent[i] * local(open + length * double(i) / double(Path::samples - 1)));
    return Path(std::move(maps));
}

// Depth first, children in their order.
std::vector<size_t> inOrder(const GltfFile& file, const std::vector<size_t>& first) {
    std::vector<size_t> open(first.rbegin(), first.rend()), order;
    while (!open.empty()) {
        order.push_back(open.back());
        open.pop_back();
        const auto& children = file.model.nodes[order.back()].children;
        open.insert(open.end(), children.rbegin(), children.rend());
    }
    return order;
}

} // namespace

namespace {

// visit(node, path) for everything below these roots: depth first, children in their order.
template <class Visit> void walk(Conversion& to, const std::vector<size_t>& first, Visit visit) {
    std::vector<std::pair<size_t, Path>> open;
    for (auto it = first.rbegin(); it != first.rend(); ++it) open.emplace_back(*it, Path());
    while (!open.empty()) {
        const auto [index, parent] = open.back();
        open.pop_back();
        const Path path = pathOf(to, index, parent);
        visit(index, path);
        const auto& children = to.file.model.nodes[index].children;
        for (auto it = children.rbegin(); it != children.rend(); ++it) open.emplace_back(size_t(*it), path);
    }
}

// The ways of the joints of all skins that these nodes wear. Joints may lie in another scene.
void followJoints(Conversion& to, const std::vector<size_t>& nodes) {
    const GltfFile& file = to.file;
    std::vector<bool> joint(file.model.nodes.size()), child(file.model.nodes.size());
    bool any = false;
    std::set<int> skins;
    for (const size_t node : nodes)
        if (const tinygltf::Node& n = file.model.nodes[node]; n.mesh >= 0 && n.skin >= 0 && skins.insert(n.skin).second)
            for (const size_t j : jointsOf(file, size_t(n.skin))) joint[j] = any = true;
    if (!any) return;
    for (const tinygltf::Node& n : file.model.nodes)
        for (const int c : n.children) child[size_t(c)] = true;
    std::vector<size_t> tops;
    for (size_t i = 0; i < child.size(); ++i)
        if (!child[i]) tops.push_back(i);
    size_t moving = 0;
    walk(to, tops, [&](size_t node, const Path& path) {
        if (!joint[node]) return;
        moving += !path.rests();
        if (moving > maxJoints)
            file.fail(fmt::format("/nodes/{}", node), fmt::format("brings the joints that move while the shutter is open above {}. Close "
                                                                  "the shutter or split the scene.",
                                                                  maxJoints));
        to.joints.emplace(node, path);
    });
}

} // namespace

void convertNodes(Conversion& to) {
    const std::vector<size_t> first = roots(to.file, to.options.scene), order = inOrder(to.file, first);
    readMeshes(to, order);
    followJoints(to, order);
    walk(to, first, [&](size_t node, const Path& path) { convertNode(to, node, path); });
    to.read.clear();
}

} // namespace chiaro::gltf
