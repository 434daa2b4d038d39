// Meshes that change their shape while the shutter is open, in pictures: against closed forms, many still frames, and skins and morph
// targets as glTF files hold them.
#include "io/gltf.h"
#include "tests/io/gltf_builder.h"
#include "tests/render/blur.h"
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr Interval second{0, 1};

CameraDesc down(double x, double y = 0) { return probe({x, y, 0}, {0, 0, -1}); }
const Settings dense{.width = 4, .height = 4, .spp = 1 << 14};

template <class Map> PrimitiveDesc bent(PrimitiveDesc p, int steps, Map map) {
    const std::vector<Vec3> base = p.positions;
    p.normals.clear();
    for (int i = 0; i <= steps; ++i) {
        ShapeDesc s;
        for (const Vec3& v : base) s.positions.push_back(cast<float>(map(double(i) / steps, cast<double>(v))));
        if (i == 0)
            p.positions = s.positions;
        else
            p.steps.push_back(std::move(s));
    }
    return p;
}
// As it is at a moment, at rest: vertices go linearly from step to step.
SceneDesc frozen(SceneDesc s, double time) {
    for (MeshDesc& mesh : s.meshes)
        for (PrimitiveDesc& p : mesh.primitives) {
            if (p.steps.empty()) continue;
            const double place = time * double(p.steps.size());
            const auto first = std::min(std::size_t(place), p.steps.size() - 1);
            const std::vector<Vec3> a = first == 0 ? p.positions : p.steps[first - 1].positions, &b = p.steps[first].positions;
            const float f = float(place - double(first));
            for (std::size_t i = 0; i < p.positions.size(); ++i) p.positions[i] = a[i] * (1 - f) + b[i] * f;
            p.steps.clear();
        }
    s.shutter = {};
    return s;
}
// A floor, a sheet above it that rolls up, and a lamp that grows and bends: shadows, direct light and an emitter that changes at once.
SceneDesc stage() {
    SceneDesc s;
    s.shutter = second;
    const int grey = shapes::add(s, shapes::diffuse("grey", Spectrum(0.6f))), lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(20)));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 3), grey);
    shapes::add(s, "sheet",
                bent(shapes::box({0.6, 0.05, 0.6}), 8,
                     [](double t, const Vec3d& p) {
                         return Vec3d{p.x * (1 - 0.7 * t), 1 + p.y + t * p.x * p.x, p.z * (1 + 0.5 * t)};
                     }),
                grey);
    shapes::add(s, "lamp",
                bent(plate({0, 0, 0}, {0, -1, 0}, 0.3), 4,
                     [](double t, const Vec3d& p) {
                         return Vec3d{p.x * (1 + 2 * t) - 1 + 2 * t, 2 + 0.5 * t * p.x, p.z + 0.5};
                     }),
                lamp);
    return s;
}

// A glTF file with one emissive quad (corners given) of radiance 1, seen from both sides.
struct Shining : Builder {
    json attributes, more;
    explicit Shining(const std::vector<float>& corners) {
        attributes = {{"POSITION", accessor<float>(corners, 3, "VEC3")}};
        root["materials"] = {
            {{"emissiveFactor", {1, 1, 1}}, {"doubleSided", true}, {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}}}}};
        more = {{"indices", accessor<uint8_t>({0, 1, 2, 0, 2, 3}, 1, "SCALAR")}, {"material", 0}};
    }
    void animate(int node, const char* path, const std::vector<float>& times, const std::vector<float>& values) {
        const bool weights = std::string(path) == "weights", turns = std::string(path) == "rotation";
        json& a = root["animations"][0];
        const int output = accessor<float>(values, weights ? 1 : turns ? 4 : 3, weights ? "SCALAR" : turns ? "VEC4" : "VEC3");
        a["samplers"].push_back({{"input", accessor<float>(times, 1, "SCALAR")}, {"output", output}});
        a["channels"].push_back({{"sampler", a["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
    }
    std::unique_ptr<const Scene> compiledOver(const Folder& folder, Interval shutter, const Executor* run = nullptr) const {
        Diagnostics notes;
        GltfOptions options;
        options.shutter = shutter;
        options.run = run;
        SceneDesc desc = read(folder, notes, options);
        CHECK(notes.warnings().empty());
        return Scene::compile(std::move(desc), notes, {}, run, ClosureTable::make);
    }
};

} // namespace

TEST_SUITE("deform") {
    TEST_CASE("a morph that draws a bar out at unit speed: a linear ramp, whatever part of the animation the shutter sees") {
        const Folder folder("ramp");
        Shining b({-5, -50, 0, 0, -50, 0, 0, 50, 0, -5, 50, 0});
        b.more["targets"] = {{{"POSITION", b.accessor<float>({0, 0, 0, 4, 0, 0, 4, 0, 0, 0, 0, 0}, 3, "VEC3")}}};
        b.animate(b.node({{"mesh", b.mesh(b.attributes, b.more)}}), "weights", {0, 4}, {0, 1});
        const auto scene = b.compiledOver(folder, second);
        for (const double x : {-0.05, 0.125, 0.5, 0.9, 1.05}) {
            CAPTURE(x);
            checkEqual(measure(*scene, down(x), dense), std::clamp(1 - x, 0., 1.), 1e-2, 1e-4);
        }
        checkEqual(measure(*b.compiledOver(folder, {1, 3}), down(1.5), dense), 0.75, 1e-2, 1e-4);
    }

    TEST_CASE("a skin that turns a needle by a quarter: the share of the time in which it covers a place") {
        // Both joints turn together: the needle keeps its length and crosses radius 0.98 for 0.02 / 0.98 of a radian at each angle.
        const Folder folder("needle");
        Shining b({0, -0.01f, 0, 1, -0.01f, 0, 1, 0.01f, 0, 0, 0.01f, 0});
        const int joint = b.node(json::object());
        b.add("skins", {{"joints", {joint}}});
        b.attributes["JOINTS_0"] = b.accessor<uint8_t>(std::vector<uint8_t>(16), 4, "VEC4");
        b.attributes["WEIGHTS_0"] = b.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4, "VEC4");
        b.node({{"mesh", b.mesh(b.attributes, b.more)}, {"skin", 0}, {"translation", {77, 0, 0}}});
        const float h = float(std::sqrt(0.5));
        b.animate(joint, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, h, h});
        const auto scene = b.compiledOver(folder, second);
        const double r = 0.98, crossing = 2 * std::asin(0.01 / r) / (pi64 / 2);
        for (const double angle : {0.3, pi64 / 4, 1.2}) {
            CAPTURE(angle);
            checkEqual(measure(*scene, down(r * std::cos(angle), r * std::sin(angle)), dense), crossing, 2e-2, 1e-3);
        }
    }

    TEST_CASE("a skin of two joints that opens a hinge: the shadow on the floor is the mean over the time") {
        // Seen from above along its own fold: a flap of length 1 from x = 0, whose far end is at cos(a) when it has turned by a.
        const Folder folder("hinge");
        Shining b({0, -50, 0, 1, -50, 0, 1, 50, 0, 0, 50, 0});
        const int flap = b.add("nodes", json::object());
        const int base = b.node({{"children", {flap}}});
        b.add("skins", {{"joints", {base, flap}}});
        b.attributes["JOINTS_0"] = b.accessor<uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, 4, "VEC4");
        b.attributes["WEIGHTS_0"] = b.accessor<uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, 4, "VEC4", true);
        b.node({{"mesh", b.mesh(b.attributes, b.more)}, {"skin", 0}});
        const float h = float(std::sqrt(0.5));
        b.animate(flap, "rotation", {0, 1}, {0, 0, 0, 1, 0, -h, 0, h});
        const auto scene = b.compiledOver(folder, second);
        // The reader follows the end of the flap to 5e-4 of its way of sqrt(2): so much of x, and as much more of the share as acos is
        // steep.
        for (const double x : {0.2, 0.5, 0.8}) {
            CAPTURE(x);
            const double share = std::acos(x) / (pi64 / 2), off = 5e-4 * std::sqrt(2.) / std::sqrt(1 - x * x) / (pi64 / 2);
            checkEqual(measure(*scene, probe({x, 0, 0}, {0, 0, -1}, 10), dense), share, 1e-2, off / share);
        }
    }

    TEST_CASE("a lamp and a sheet that bend: light samples, both strategies and particles agree, and equal many still frames") {
        checkBlur(stage(), frozen);
    }

    TEST_CASE("a closed furnace that breathes is exact") {
        SceneDesc inside;
        inside.shutter = second;
        const int glow = shapes::add(inside, shapes::lamp("wall", Spectrum(0.5f), Spectrum(0.5f)));
        shapes::add(inside, "wall",
                    bent(shapes::insideOut(shapes::sphere(1, 3)), 6,
                         [](double t, const Vec3d& p) {
                             return Vec3d{p.x * (1 + t), p.y * (1 - 0.4 * t) + 0.2 * t * p.x, p.z + 0.1 * std::sin(6 * t)};
                         }),
                    glow);
        checkEqual(measure(*compiled(std::move(inside)), perspective({0.1, 0, 0}, {1, 0.2, 0}, 1.2),
                           {.width = 16, .height = 16, .spp = 128}, "path:rr-depth=64"),
                   1, 2e-3, 1e-4);
    }

    TEST_CASE("the same bits for any number of threads, of reading and of rendering") {
        const auto scene = compiled(stage());
        const CameraDesc view = perspective({0, 3, 4}, {0, 0.5, 0}, 0.7);
        Settings how{.width = 48, .height = 32, .spp = 8};
        const Rendering one = rendered(*scene, view, how);
        how.threads = 4;
        CHECK(samePicture(*one.film, *rendered(*scene, view, how).film));
        const Folder folder("threads");
        Shining b({-5, -50, 0, 0, -50, 0, 0, 50, 0, -5, 50, 0});
        b.more["targets"] = {{{"POSITION", b.accessor<float>({0, 0, 0, 4, 0, 0, 4, 0, 0, 0, 0, 0}, 3, "VEC3")}}};
        const int node = b.node({{"mesh", b.mesh(b.attributes, b.more)}});
        b.animate(node, "weights", {0, 0.3f, 1}, {0, 1, 0.5f});
        const Executor four(4);
        CHECK(b.compiledOver(folder, second)->hash() == b.compiledOver(folder, second, &four)->hash());
    }
} // TEST_SUITE
