#include "io/gltf_nodes.h"
#include "core/scene/motion.h"
#include "io/gltf_deform.h"
#include "io/gltf_file.h"
#include "io/gltf_path.h"
#include <fmt/format.h>
#include <utility>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

Vec3d column(const Affine& a, int j) { return {a.m[0][j], a.m[1][j], a.m[2][j]}; }

bool finite(const Affine& a) {
    for (const auto& row : a.m)
        for (const double v : row)
            if (!(std::abs(v) <= 1e18)) return false; // Embree squares coordinates in float
    return true;
}

// Whether the linear part flattens space: a zero axis, or axes in one plane up to rounding.
bool singular(const Affine& a) {
    const double product = length(column(a, 0)) * length(column(a, 1)) * length(column(a, 2));
    return !(product > 1e-60) || std::abs(a.determinant()) < 1e-9 * product;
}

// The same place and view direction without scale and shear: what is meant for cameras and lights. Keeps -Z, then +Y.
std::optional<Affine> rigid(const Affine& a) {
    const double sizeZ = length(column(a, 2));
    if (!(sizeZ > 0)) return {};
    const Vec3d z = column(a, 2) * (1 / sizeZ), up = column(a, 1), y0 = up - z * dot(up, z);
    const double sizeY = length(y0);
    if (!(sizeY > 1e-12 * length(up))) return {};
    const Vec3d y = y0 * (1 / sizeY), x = cross(y, z);
    Affine r;
    const Vec3d axes[3] = {x, y, z};
    for (int j = 0; j < 3; ++j) {
        r.m[0][j] = axes[j].x;
        r.m[1][j] = axes[j].y;
        r.m[2][j] = axes[j].z;
    }
    for (int i = 0; i < 3; ++i) r.m[i][3] = a.m[i][3];
    return r;
}

// The same all along a path. Where the scale is zero, the axes of the last sound place stand in; empty: there is none.
std::optional<Path> rigid(const Path& path) {
    std::optional<Affine> last;
    for (size_t i = 0; i < path.maps().size() && !last; ++i) last = rigid(path[i]);
    if (!last) return {};
    return path.each([&](const Affine& m) {
        if (const auto sound = rigid(m)) return *(last = sound);
        for (int i = 0; i < 3; ++i) last->m[i][3] = m.m[i][3];
        return *last;
    });
}

// How many steps a thing of this size needs along the path; says once where they do not suffice.
size_t segments(Conversion& to, size_t index, const Path& path, double radius) {
    const Segments s = segmentsFor(path, radius);
    if (s.off > 1e-2 && !std::exchange(to.uneven, true))
        to.file.warn(
            fmt::format("/nodes/{} jumps or turns too fast while the shutter is open: in {} steps its blur is off by {:.2g} of its way "
                        "and size. Shorten --shutter.",
                        index, Motion::mostKeys - 1, s.off));
    return s.count;
}

// Of a mesh, about its own origin.
double radiusOf(Conversion& to, int mesh) {
    to.radii.resize(to.scene.meshes.size(), -1);
    double& radius = to.radii[size_t(mesh)];
    if (radius >= 0) return radius;
    radius = 0;
    for (const PrimitiveDesc& p : to.scene.meshes[size_t(mesh)].primitives)
        for (size_t step = 0; step <= p.steps.size(); ++step)
            for (const Vec3& v : step == 0 ? p.positions : p.steps[step - 1].positions) radius = std::max(radius, length(cast<double>(v)));
    return radius;
}

void addInstance(Conversion& to, size_t index, int mesh, const Path& path, size_t steps, int element = -1) {
    const std::string place = fmt::format("/nodes/{}", index);
    const auto& maps = path.maps();
    if (!std::all_of(maps.begin(), maps.end(), finite))
        to.file.fail(place, "places its mesh beyond 1e18 m, or not at a number. Mend the transforms and export it again.");
    if (std::all_of(maps.begin(), maps.end(), singular)) return to.file.warn(place + " has a scale of zero; its mesh is not drawn.");
    if (to.scene.instances.size() >= maxInstances)
        to.file.fail(place, fmt::format("brings the scene above {} instances. Split the scene.", maxInstances));
    to.scene.instances.push_back({mesh, path.opening(), to.file.model.nodes[index].name, motionAlong(path, steps)});
    to.origin.instances.push_back({index, element, mesh});
}

// EXT_mesh_gpu_instancing: one instance for each element of its accessors, inside the node's own frame.
void addInstances(Conversion& to, size_t index, int mesh, const Path& path, const json& attributes) {
    const GltfFile& file = to.file;
    size_t count = 0;
    std::vector<float> values[3];
    const char* const names[3] = {"TRANSLATION", "ROTATION", "SCALE"};
    for (int k = 0; k < 3; ++k) {
        if (!attributes.contains(names[k])) continue;
        const std::string place = fmt::format("/nodes/{}/extensions/EXT_mesh_gpu_instancing/attributes/{}", index, names[k]);
        const size_t accessor = attributes[names[k]];
        const Accessor& a = file.accessors[accessor];
        const std::string type = k == 1 ? "VEC4" : "VEC3";
        if (a.type != type) file.fail(place, fmt::format("has type {}, must be {}. Export the file again.", a.type, type));
        if (count && a.count != count)
            file.fail(place, fmt::format("has {} elements, the others have {}. Export the file again.", a.count, count));
        count = a.count;
        if (count > maxInstances - to.scene.instances.size())
            file.fail(place, fmt::format("brings the scene above {} instances. Split the scene.", maxInstances));
        values[k] = readFloats(file, accessor);
    }
    std::vector<Affine> locals;
    double radius = 0; // of all of them together
    for (size_t i = 0; i < count; ++i) {
        const auto q = numbers<4>(values[1], {0, 0, 0, 1}, i * 4);
        if (!isRotation(q))
            file.fail(fmt::format("/nodes/{}/extensions/EXT_mesh_gpu_instancing/attributes/ROTATION", index),
                      fmt::format("element {} is no quaternion. Export the file again.", i));
        const auto t = numbers<3>(values[0], {0, 0, 0}, i * 3), s = numbers<3>(values[2], {1, 1, 1}, i * 3);
        locals.push_back(compose(t, q, s));
        const double scale = std::max(std::abs(s[0]), std::max(std::abs(s[1]), std::abs(s[2])));
        radius = std::max(radius, std::hypot(t[0], t[1], t[2]) + scale * radiusOf(to, mesh));
    }
    const size_t steps = segments(to, index, path, radius);
    for (size_t i = 0; i < locals.size(); ++i)
        addInstance(to, index, mesh, path.each([&](const Affine& m) { return m * locals[i]; }), steps, int(i));
}

void addCamera(Conversion& to, size_t index, const Path& path) {
    const tinygltf::Node& node = to.file.model.nodes[index];
    const json& from = list(to.file, "cameras")[size_t(node.camera)];
    const std::string& type = from["type"].get_ref<const std::string&>();
    const std::string place = fmt::format("/cameras/{}", node.camera);
    if (type != "perspective" && type != "orthographic")
        to.file.fail(place + "/type", fmt::format("{} is neither perspective nor orthographic. Export the file again.", shown(type)));
    if (!from.contains(type)) to.file.fail(place, fmt::format("has no \"{}\". Export the file again.", type));
    const json& lens = from[type];
    CameraDesc camera;
    camera.name = from.value("name", std::string());
    if (camera.name.empty()) camera.name = node.name;
    if (type == "perspective") {
        camera.yfov = lens["yfov"];
        camera.aspect = std::max(lens.value("aspectRatio", 0.0), 0.0);
        if (!(camera.yfov > 0 && camera.yfov < 3.14159265358979))
            to.file.fail(place + "/perspective/yfov", fmt::format("is {}, must lie between 0 and pi. Export the file again.", camera.yfov));
    } else {
        camera.projection = Projection::orthographic;
        camera.xmag = std::abs(lens["xmag"].get<double>());
        camera.ymag = std::abs(lens["ymag"].get<double>());
        if (!(camera.xmag > 0 && camera.ymag > 0)) to.file.fail(place + "/orthographic", "has an extent of zero. Export the file again.");
        camera.aspect = camera.xmag / camera.ymag;
    }
    const auto frames = rigid(path);
    if (!frames) return to.file.warn(fmt::format("/nodes/{} has a scale of zero; its camera is left out.", index));
    camera.toWorld = frames->opening();
    camera.motion = motionAlong(*frames, segments(to, index, *frames, 0));
    to.scene.cameras.push_back(std::move(camera));
}

void addLight(Conversion& to, size_t index, const Path& path, const json& from, const std::string& place) {
    PunctualDesc light;
    const std::string &kind = from["type"].get_ref<const std::string&>(), nodeName = to.file.model.nodes[index].name;
    light.name = from.value("name", nodeName);
    light.kind = kind == "point" ? PunctualKind::point : kind == "spot" ? PunctualKind::spot : PunctualKind::directional;
    if (kind != "point" && kind != "spot" && kind != "directional")
        to.file.fail(place + "/type", fmt::format("{} is none of point, spot, directional. Export the file again.", shown(kind)));
    const double intensity = from.value("intensity", 1.0);
    const auto color = numbers<3>(from.value("color", json::array()), {1, 1, 1});
    for (size_t c = 0; c < 3; ++c) {
        const double value = color[c] * intensity;
        if (!(value >= 0 && value <= 3e38))
            to.file.fail(place, fmt::format("has colour x intensity {}, must not be negative. Export the file again.", value));
        light.intensity[c] = float(value);
    }
    light.range = light.kind == PunctualKind::directional ? 0 : std::max(from.value("range", 0.0), 0.0);
    if (light.kind == PunctualKind::spot) {
        const json spot = from.value("spot", json::object());
        const double outer = spot.value("outerConeAngle", light.outerCone), inner = spot.value("innerConeAngle", 0.0);
        light.outerCone = std::clamp(outer, 1e-4, 1.5707963267948966);
        light.innerCone = std::clamp(inner, 0.0, light.outerCone);
        if (light.outerCone != outer || light.innerCone != inner)
            to.file.warn(fmt::format("{}/spot has cones {} and {}, must be 0 <= inner < outer <= pi/2; {} and {} are used.", place, inner,
                                     outer, light.innerCone, light.outerCone));
    }
    const auto frames = rigid(path);
    if (!frames && light.kind != PunctualKind::point)
        return to.file.warn(fmt::format("/nodes/{} has a scale of zero; its light is left out.", index));
    const Path way = frames.value_or(path.each([](const Affine& m) {
        Affine position;
        for (int i = 0; i < 3; ++i) position.m[i][3] = m.m[i][3];
        return position;
    }));
    light.toWorld = way.opening();
    light.motion = motionAlong(way, segments(to, index, way, 0));
    to.scene.lights.push_back(std::move(light));
}

} // namespace

void convertNode(Conversion& to, size_t index, const Path& path) {
    const GltfFile& file = to.file;
    const tinygltf::Node& node = file.model.nodes[index];
    const json& extensions = file.json["nodes"][index].value("extensions", json::object());
    if (node.mesh >= 0) {
        const bool many = extensions.contains("EXT_mesh_gpu_instancing");
        Deformation deformation = deformationOf(to, index);
        if (many && std::exchange(deformation.skin, -1) >= 0)
            file.warn(fmt::format("/nodes/{} has EXT_mesh_gpu_instancing and a skin; the skin is not applied.", index));
        const DeformedMesh own = deformation ? convertDeformed(to, index, deformation, path) : DeformedMesh{convertMesh(to, node.mesh), {}};
        const int mesh = own.mesh;
        if (mesh < 0 || to.scene.meshes[size_t(mesh)].primitives.empty()) {
            // nothing to draw; the mesh said why
        } else if (deformation.skin >= 0) {
            addInstance(to, index, mesh, Path({own.place}), 0);
        } else if (many) {
            addInstances(to, index, mesh, path, extensions["EXT_mesh_gpu_instancing"]["attributes"]);
        } else {
            addInstance(to, index, mesh, path, segments(to, index, path, radiusOf(to, mesh)));
        }
    }
    const bool isFinite = std::all_of(path.maps().begin(), path.maps().end(), finite);
    if ((node.camera >= 0 || !extensions.empty()) && !isFinite)
        file.fail(fmt::format("/nodes/{}", index), "lies beyond 1e18 m. Mend the transforms and export it again.");
    if (node.camera >= 0) addCamera(to, index, path);
    if (extensions.contains("KHR_lights_punctual")) {
        const size_t light = extensions["KHR_lights_punctual"]["light"];
        addLight(to, index, path, file.json["extensions"]["KHR_lights_punctual"]["lights"][light],
                 fmt::format("/extensions/KHR_lights_punctual/lights/{}", light));
    }
}

} // namespace chiaro::gltf
