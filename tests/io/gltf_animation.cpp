// Animations of glTF files: channels at a time in closed form, motion over the shutter, which animation plays, and files that lie.
#include "core/scene/motion.h"
#include "tests/io/gltf_builder.h"
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double pi64 = std::numbers::pi;

using Numbers = std::vector<float>;
const float diagonal = float(std::sqrt(0.5));

// A file under construction whose first animation gets channels.
struct Animated : Builder {
    int mesh() { return Builder::mesh({{"POSITION", accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, "VEC3")}}); }
    int sampler(const Numbers& times, int output, const char* how, int animation = 0) {
        json& a = root["animations"][size_t(animation)];
        a["samplers"].push_back({{"input", accessor<float>(times, 1, "SCALAR")}, {"output", output}, {"interpolation", how}});
        return int(a["samplers"].size()) - 1;
    }
    void channel(int node, const char* path, int sampler, int animation = 0) {
        root["animations"][size_t(animation)]["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
    }
    void animate(int node, const char* path, const Numbers& times, const Numbers& values, const char* how = "LINEAR", int animation = 0) {
        const bool turns = std::string(path) == "rotation";
        channel(node, path, sampler(times, accessor<float>(values, turns ? 4 : 3, turns ? "VEC4" : "VEC3"), how, animation), animation);
    }
    SceneDesc at(const Folder& folder, double time, Interval shutter = {}, const std::string& animation = "") const {
        Diagnostics notes;
        SceneDesc s = read(folder, notes, {.frameTime = time, .shutter = shutter, .animation = animation});
        for (const std::string& w : notes.warnings()) CHECK_MESSAGE(w.empty(), w);
        return s;
    }
};

void checkNear(const Vec3d& a, const Vec3d& b, double tolerance = 1e-6) {
    INFO(a.x << ", " << a.y << ", " << a.z << " for " << b.x << ", " << b.y << ", " << b.z);
    CHECK(length(a - b) <= tolerance);
}
Vec3d origin(const Affine& m) { return m.point({0, 0, 0}); }

// The way that a description's motion takes, at a time of its shutter.
Affine along(const MotionDesc& motion, const SceneDesc& s, double time) {
    REQUIRE(motion.size() >= 2);
    return Motion(motion, s.shutter).exact(time);
}

} // namespace

TEST_SUITE("gltf_animation") {
    TEST_CASE("translation, rotation, scale at three times; held before the first key and after the last") {
        const Folder folder("trs-animation");
        Animated b;
        const int node = b.node({{"mesh", b.mesh()}, {"translation", {9, 9, 9}}});
        b.animate(node, "translation", {1, 3}, {0, 0, 0, 4, 2, 0});
        b.animate(node, "rotation", {1, 3}, {0, 0, 0, 1, 0, 0, diagonal, diagonal});
        b.animate(node, "scale", {1, 3}, {1, 1, 1, 3, 3, 3});
        for (const auto& [time, share] : {std::pair{0., 0.}, {1., 0.}, {1.5, .25}, {2., .5}, {3., 1.}, {7., 1.}}) {
            CAPTURE(time);
            const SceneDesc s = b.at(folder, time);
            const Affine& m = s.instances[0].toWorld;
            CHECK(s.instances[0].motion.empty());
            const double angle = share * pi64 / 2, size = 1 + 2 * share;
            checkNear(origin(m), {4 * share, 2 * share, 0});
            checkNear(m.vector({1, 0, 0}), Vec3d{std::cos(angle), std::sin(angle), 0} * size);
        }
        checkNear(origin(b.at(folder, 2, {}, "none").instances[0].toWorld), {9, 9, 9});
    }

    TEST_CASE("STEP holds, CUBICSPLINE is Hermite's cubic, rotations go the short way") {
        const Folder folder("interpolation");
        Animated b;
        const int step = b.node({{"mesh", b.mesh()}}), cubic = b.node({{"mesh", 0}}), turn = b.node({{"mesh", 0}}),
                  spline = b.node({{"mesh", 0}});
        b.animate(step, "translation", {0, 1, 2}, {1, 0, 0, 2, 0, 0, 3, 0, 0}, "STEP");
        // In-tangent, value, out-tangent at each of two keys, two seconds apart.
        b.animate(cubic, "translation", {0, 2}, {7, 7, 7, 0, 0, 0, 1, 0, 0, 0, 3, 0, 4, 0, 0, 7, 7, 7}, "CUBICSPLINE");
        // The same rotation twice, the second time as -q of a little more: 340 degrees the long way.
        const float s = float(std::sin(0.1)), c = float(std::cos(0.1));
        b.animate(turn, "rotation", {0, 2}, {0, 0, s, c, 0, 0, s, -c});
        b.animate(spline, "rotation", {0, 2}, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}, "CUBICSPLINE");
        for (const auto& [time, x] : {std::pair{0.999, 1.}, {1., 2.}, {1.5, 2.}, {2., 3.}})
            checkNear(origin(b.at(folder, time).instances[0].toWorld), {x, 0, 0});
        const SceneDesc half = b.at(folder, 1);
        // p = (2t3-3t2+1) p0 + d (t3-2t2+t) out0 + (3t2-2t3) p1 + d (t3-t2) in1 at t = 1/2, d = 2
        checkNear(origin(half.instances[1].toWorld), {0.5 * 4 + 2 * 0.125 * 1, -2 * 0.125 * 3, 0});
        checkNear(half.instances[2].toWorld.vector({1, 0, 0}), {1, 0, 0});
        checkNear(half.instances[3].toWorld.vector({1, 0, 0}), {0, 1, 0}); // normalized: half way from 0 to 180 degrees
    }

    TEST_CASE("normalized integers are rotations") {
        const Folder folder("normalized");
        Animated b;
        const int bytes = b.node({{"mesh", b.mesh()}}), shorts = b.node({{"mesh", 0}});
        b.channel(bytes, "rotation", b.sampler({0, 1}, b.accessor<int8_t>({0, 0, 0, 127, 0, 0, 90, 90}, 4, "VEC4", true), "LINEAR"));
        b.channel(shorts, "rotation",
                  b.sampler({0, 1}, b.accessor<int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170}, 4, "VEC4", true), "LINEAR"));
        for (const InstanceDesc& i : b.at(folder, 1).instances) checkNear(i.toWorld.vector({1, 0, 0}), {0, 1, 0});
        for (const InstanceDesc& i : b.at(folder, 0.5).instances) checkNear(i.toWorld.vector({1, 0, 0}), {diagonal, diagonal, 0});
    }

    TEST_CASE("two animated nodes, one under the other: a planet and its moon, with camera and light") {
        const Folder folder("moon");
        Animated b;
        b.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}}};
        b.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}}};
        const int moon = b.add("nodes", {{"mesh", b.mesh()}, {"translation", {1, 0, 0}}});
        const int eye = b.add("nodes", {{"camera", 0}, {"translation", {0, 0, 1}}, {"scale", {2, 2, 2}}});
        const int lamp = b.add("nodes", {{"translation", {0, 1, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
        const int spin = b.add("nodes", {{"children", {moon}}});
        const int planet = b.node({{"children", {spin, eye, lamp}}});
        // The planet turns about y by 90 degrees in a second and moves along x; the moon's node turns about z by 90.
        b.animate(planet, "rotation", {0, 1}, {0, 0, 0, 1, 0, diagonal, 0, diagonal});
        b.animate(planet, "translation", {0, 1}, {0, 0, 0, 10, 0, 0});
        b.animate(spin, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, diagonal, diagonal});
        const auto aboutY = [](double a, const Vec3d& p) {
            return Vec3d{std::cos(a) * p.x + std::sin(a) * p.z, p.y, -std::sin(a) * p.x + std::cos(a) * p.z};
        };
        const SceneDesc open = b.at(folder, 0.25, {-0.25f, 0.5f});
        CHECK(open.shutter.open == -0.25f);
        CHECK(open.shutter.close == 0.5f);
        for (const double t : {0., 0.25, 0.4, 0.75}) {
            CAPTURE(t);
            const double a = t * pi64 / 2;
            const Vec3d moonAt = Vec3d{10 * t, 0, 0} + aboutY(a, {std::cos(a), std::sin(a), 0});
            const Vec3d eyeAt = Vec3d{10 * t, 0, 0} + aboutY(a, {0, 0, 1}), lampAt{10 * t, 1, 0};
            const SceneDesc still = b.at(folder, t);
            checkNear(origin(still.instances[0].toWorld), moonAt);
            checkNear(origin(still.cameras[0].toWorld), eyeAt);
            checkNear(origin(still.lights[0].toWorld), lampAt);
            checkNear(still.lights[0].toWorld.vector({0, 0, -1}), aboutY(a, {0, 0, -1}));
            const double relative = t - 0.25;
            checkNear(origin(along(open.instances[0].motion, open, relative)), moonAt, 2e-4);
            checkNear(along(open.instances[0].motion, open, relative).vector({1, 0, 0}), aboutY(a, {std::cos(a), std::sin(a), 0}), 2e-4);
            const Affine camera = along(open.cameras[0].motion, open, relative);
            checkNear(origin(camera), eyeAt, 2e-4);
            checkNear(camera.vector({0, 0, -1}), aboutY(a, {0, 0, -1}), 1e-5);
            checkNear(origin(along(open.lights[0].motion, open, relative)), lampAt, 2e-4);
        }
    }

    TEST_CASE("as few steps as follow the way closely") {
        const Folder folder("steps");
        Animated b;
        const int straight = b.node({{"mesh", b.mesh()}}), turning = b.node({{"mesh", 0}}), bent = b.node({{"mesh", 0}}),
                  still = b.node({{"mesh", 0}});
        b.animate(straight, "translation", {0, 4}, {0, 0, 0, 8, 0, 0});
        b.animate(turning, "rotation", {0, 4}, {0, 0, 0, 1, 0, 0, 1, 0});
        b.animate(bent, "translation", {0, 1, 2}, {0, 0, 0, 1, 0, 0, 1, 1, 0});
        b.animate(still, "translation", {0, 1}, {5, 5, 5, 5, 5, 5});
        const SceneDesc s = b.at(folder, 0, {0, 2});
        CHECK(s.instances[0].motion.size() == 2);
        CHECK(s.instances[1].motion.size() == 2); // one great arc
        CHECK(s.instances[2].motion.size() == 3); // the corner lies on a step
        CHECK(s.instances[3].motion.empty());
        checkNear(origin(s.instances[3].toWorld), {5, 5, 5});
        Diagnostics notes;
        Animated jump = b;
        jump.animate(still, "scale", {0, 1.3f}, {1, 1, 1, 2, 2, 2}, "STEP");
        const SceneDesc jumping = jump.read(folder, notes, {.shutter = {0, 2}});
        CHECK(jumping.instances[3].motion.size() == 129);
        CHECK(warns(notes, "jumps or turns too fast"));
    }

    TEST_CASE("an object that is hidden by a scale of zero for a part of the shutter") {
        const Folder folder("hidden");
        Animated b;
        const int node = b.node({{"mesh", b.mesh()}});
        b.animate(node, "scale", {0, 1}, {1, 1, 1, 0, 0, 0}, "STEP");
        Diagnostics notes;
        CHECK(b.read(folder, notes, {.frameTime = 2}).instances.empty());
        CHECK(warns(notes, "scale of zero"));
        const SceneDesc s = b.at(folder, 0, {0, 2});
        CHECK(s.instances[0].motion.size() == 129);
    }

    TEST_CASE("which animation plays") {
        const Folder folder("which");
        Animated b;
        const int a = b.node({{"mesh", b.mesh()}}), c = b.node({{"mesh", 0}});
        b.animate(a, "translation", {0}, {1, 0, 0}, "LINEAR", 0);
        b.animate(a, "translation", {0}, {2, 0, 0}, "LINEAR", 1);
        b.animate(c, "translation", {0, 2.5f}, {3, 0, 0, 3, 0, 0}, "LINEAR", 1);
        b.root["animations"][0]["name"] = "walk";
        b.root["animations"][1]["name"] = "run";
        const auto places = [&](const std::string& which) {
            Diagnostics notes;
            const SceneDesc s = b.read(folder, notes, {.animation = which});
            return std::pair{origin(s.instances[0].toWorld).x, origin(s.instances[1].toWorld).x};
        };
        using Two = std::pair<double, double>;
        CHECK(places("") == Two{1, 0});
        CHECK(places("walk") == Two{1, 0});
        CHECK(places("run") == Two{2, 3});
        CHECK(places("1") == Two{2, 3});
        CHECK(places("all") == Two{1, 3});
        CHECK(places("none") == Two{0, 0});
        Diagnostics notes;
        GltfContents found;
        readGltf(folder.write("scene.glb", b.asGlb()), {.animation = "run"}, notes, &found);
        REQUIRE(found.animations.size() == 2);
        CHECK(found.animations[1].name == "run");
        CHECK(found.animations[1].seconds == 2.5);
        CHECK(found.animations[1].channels.at("translation") == 2);
        CHECK(found.animations[1].used);
        CHECK_FALSE(found.animations[0].used);
        const Failure wrong = failure(folder.write("scene.glb", b.asGlb()), {.animation = "ran"});
        CHECK(wrong.code == Exit::usage);
        CHECK(wrong.message.find("did you mean \"run\"?") != std::string::npos);
    }

    TEST_CASE("what is not applied is said") {
        const Folder folder("unapplied");
        Animated b;
        const int node = b.node({{"mesh", b.mesh()}}),
                  fixed = b.node({{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1}}});
        b.animate(node, "weights", {0}, {0, 0, 0});
        b.animate(fixed, "translation", {0}, {5, 0, 0});
        b.animate(node, "translation", {0}, {1, 0, 0});
        b.animate(node, "translation", {0}, {2, 0, 0});
        b.animate(node, "colour", {0}, {2, 0, 0});
        b.animate(node, "pointer", {0}, {2, 0, 0});
        b.animate(node, "scale", {0}, {2, 2, 2});
        json& channels = b.root["animations"][0]["channels"];
        channels.back()["target"].erase("node");
        channels[5]["target"]["extensions"]["KHR_animation_pointer"] = {{"pointer", "/nodes/0/translation"}};
        Diagnostics notes;
        const SceneDesc s = b.read(folder, notes);
        CHECK(origin(s.instances[0].toWorld).x == 1);
        CHECK(origin(s.instances[1].toWorld).x == 2);
        CHECK(notes.warnings().size() == 6);
        for (const char* part : {"animates morph targets of /nodes/0, which has none", "has a matrix", "twice", "animates \"colour\"",
                                 "KHR_animation_pointer", "without a target"})
            CHECK_MESSAGE(warns(notes, part), part);
    }

    TEST_CASE("animations that lie are one error line") {
        const Folder folder("lies");
        const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
        const auto fails = [&](const char* part, auto spoil) {
            Animated b;
            b.animate(b.node({{"mesh", b.mesh()}}), "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
            spoil(b);
            const Failure f = failure(folder.write("lie.glb", b.asGlb()));
            CAPTURE(f.message);
            CHECK(f.code == Exit::file);
            CHECK_MESSAGE(f.message.find(part) != std::string::npos, part);
            CHECK(f.message.find('\n') == std::string::npos);
        };
        const auto replace = [](const char* what, int accessor, Animated& b) { b.root["animations"][0]["samplers"][0][what] = accessor; };
        fails("not before the last", [&](Animated& b) { replace("input", b.accessor<float>({1, 0}, 1, "SCALAR"), b); });
        fails("time 1 is nan", [&](Animated& b) { replace("input", b.accessor<float>({0, nan}, 1, "SCALAR"), b); });
        fails("time 0 is -inf", [&](Animated& b) { replace("input", b.accessor<float>({-inf, 0}, 1, "SCALAR"), b); });
        fails("number 4 is inf", [&](Animated& b) { replace("output", b.accessor<float>({0, 0, 0, 0, inf, 0}, 3, "VEC3"), b); });
        fails("SCALAR of floats", [&](Animated& b) { replace("input", b.accessor<uint16_t>({0, 1}, 1, "SCALAR"), b); });
        fails("must be VEC3", [&](Animated& b) { replace("output", b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1}, 4, "VEC4"), b); });
        fails("3 elements, its 2 times need 2", [&](Animated& b) { replace("output", b.accessor<float>(Numbers(9), 3, "VEC3"), b); });
        fails("need 6", [&](Animated& b) { b.root["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; });
        fails("none of LINEAR", [&](Animated& b) { b.root["animations"][0]["samplers"][0]["interpolation"] = "WAVY"; });
        fails("has 1 samplers", [&](Animated& b) { b.root["animations"][0]["channels"][0]["sampler"] = 7; });
        fails("/target/node", [&](Animated& b) { b.root["animations"][0]["channels"][0]["target"]["node"] = 7; });
        fails("has no \"target\"", [&](Animated& b) { b.root["animations"][0]["channels"][0].erase("target"); });
        fails("has no \"samplers\"", [&](Animated& b) { b.root["animations"][0].erase("samplers"); });
        fails("has no \"output\"", [&](Animated& b) { b.root["animations"][0]["samplers"][0].erase("output"); });
        fails("accessors", [&](Animated& b) { replace("output", 99, b); });
        fails("no quaternion", [&](Animated& b) { b.animate(0, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 0, 0}); });
        fails("more than", [&](Animated& b) { // no bytes behind two billion keys
            const json nothing = {{"componentType", 5126}, {"count", 2'000'000'000}, {"type", "SCALAR"}};
            json values = nothing;
            values["type"] = "VEC3";
            replace("input", b.add("accessors", nothing), b);
            replace("output", b.add("accessors", values), b);
        });
    }
} // TEST_SUITE
