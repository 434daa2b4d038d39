// Animation and shutter as a user meets them: options, what is told, wrong input.
#include "program.h"
#include <array>

using namespace program;

namespace {

// A square lamp of 2 m that goes 1 m a second along x, before an orthographic camera; "sink" moves it down instead.
const char* const lampFile = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0},{"camera":0,"translation":[0,0,5]}],"cameras":[{"type":"orthographic","orthographic":{"xmag":4,"ymag":4,"znear":0,"zfar":9}}],
"materials":[{"name":"lamp","emissiveFactor":[1,1,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"buffers":[{"byteLength":116,"uri":"data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAABAAIAAAACAAMAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAACAvwAAAAA="}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":8},{"buffer":0,"byteOffset":68,"byteLength":24},{"buffer":0,"byteOffset":92,"byteLength":24}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"},
{"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},{"bufferView":3,"componentType":5126,"count":2,"type":"VEC3"},{"bufferView":4,"componentType":5126,"count":2,"type":"VEC3"}],
"animations":[{"name":"slide","samplers":[{"input":2,"output":3}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]},
{"name":"sink","samplers":[{"input":2,"output":4}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]}]})";

// The radiance of one sample at a place of the lamp's plane, 8 x 8 m of it.
std::string seenAt(const Folder& folder, int x, int y, std::vector<std::string> words) {
    words.insert(words.begin(),
                 {"render", "lamp.gltf", "--size", "80x80", "--filter", "box", "--pixel", std::to_string(x) + "," + std::to_string(y)});
    const Outcome o = run(folder, words);
    CHECK_MESSAGE(o.code == 0, o.err);
    return o.out;
}
bool lit(const std::string& out) { return contains(out, "1 1 1"); }

} // namespace

TEST_SUITE("motion") {
    TEST_CASE("--frame-time and --animation put things where they are then") {
        if (absent()) return;
        const Folder folder;
        folder.write("lamp.gltf", lampFile);
        CHECK(lit(seenAt(folder, 32, 40, {})));
        CHECK_FALSE(lit(seenAt(folder, 55, 40, {})));
        CHECK(lit(seenAt(folder, 55, 40, {"--frame-time", "1"})));
        CHECK(lit(seenAt(folder, 55, 40, {"--frame-time", "7"}))); // held after its end
        CHECK_FALSE(lit(seenAt(folder, 55, 40, {"--frame-time", "1", "--animation", "none"})));
        CHECK(lit(seenAt(folder, 40, 55, {"--frame-time", "1", "--animation", "sink"})));
        CHECK(lit(seenAt(folder, 40, 55, {"--frame-time", "1", "--animation", "1"})));
    }

    TEST_CASE("what plays is told, and info lists it") {
        if (absent()) return;
        const Folder folder;
        folder.write("lamp.gltf", lampFile);
        const Outcome o = run(folder, {"render", "lamp.gltf", "--size", "16x16", "--spp", "2", "--frame-time", "0.5", "--shutter", "1/4"});
        CHECK(o.code == 0);
        CHECK_MESSAGE(contains(o.err, "time     \"slide\" at 0.5 s, shutter 0 to 0.25 s"), o.err);
        CHECK(contains(o.err, "2 animations in the scene: the first, \"slide\", plays      keep it with: --animation 0"));
        const Outcome info = run(folder, {"info", "lamp.gltf"});
        CHECK(contains(info.out, "0  \"slide\"  1 s  1 translation  plays"));
        CHECK(contains(info.out, "1  \"sink\"   1 s  1 translation\n"));
    }

    TEST_CASE("--scene and --camera choose by number or by name, in any script; folders and files too") {
        if (absent()) return;
        const Folder folder;
        std::string two = lampFile;
        const auto put = [&two](const std::string& from, const std::string& to) { two.replace(two.find(from), from.size(), to); };
        put(R"("scenes":[{"nodes":[0,1]}])", R"("scenes":[{"nodes":[0,1]},{"name":"Bühne 舞","nodes":[2,1]}])");
        put(R"({"camera":0,"translation":[0,0,5]}],)",
            R"({"camera":0,"name":"Käm","translation":[0,0,5]},{"mesh":0,"translation":[2.5,0,0]}],)");
        folder.write("lamp.gltf", two);
        CHECK(lit(seenAt(folder, 32, 40, {})));
        CHECK(lit(seenAt(folder, 32, 40, {"--scene", "0"})));
        CHECK_FALSE(lit(seenAt(folder, 32, 40, {"--scene", "1"})));
        CHECK(lit(seenAt(folder, 65, 40, {"--scene", "Bühne 舞", "--camera", "Käm"})));
        const Outcome told = run(folder, {"render", "lamp.gltf", "--size", "16x16", "--spp", "2", "-o", "Bild 舞.png"});
        CHECK(told.code == 0);
        CHECK_MESSAGE(contains(told.err, "2 scenes in the file: 0 is shown      keep it with: --scene 0"), told.err);
        const Outcome wrong = run(folder, {"info", "lamp.gltf", "--scene", "Bühne"});
        CHECK(wrong.code == 64);
        CHECK_MESSAGE(contains(wrong.err, "no scene \"Bühne\" in lamp.gltf; have 0 to 1"), wrong.err);
        CHECK(contains(run(folder, {"info", "@cornell", "--scene", "1"}).err, "@cornell is one scene"));
    }

    TEST_CASE("options without effect are said, wrong ones refused") {
        if (absent()) return;
        const Folder folder;
        folder.write("lamp.gltf", lampFile);
        const std::vector<std::string> small{"--size", "8x8", "--spp", "1"};
        const auto with = [&](const char* scene, std::vector<std::string> words) {
            words.insert(words.begin(), {"render", scene});
            words.insert(words.end(), small.begin(), small.end());
            return run(folder, words);
        };
        CHECK(contains(with("@cornell", {"--shutter", "0.5"}).err, "--shutter has no effect: nothing moves in @cornell"));
        CHECK(contains(with("lamp.gltf", {"--shutter", "0.5", "--frame-time", "2"}).err,
                       "--shutter has no effect: nothing moves in lamp.gltf"));
        CHECK(contains(with("@cornell", {"--frame-time", "1"}).err, "have no effect: @cornell has no animation"));
        for (const auto& [option, value, part] : {std::array{"--shutter", "-1", "closes before it opens"},
                                                  {"--shutter", "1:0.5", "closes before it opens"},
                                                  {"--shutter", "fast", "like 0.02 or 1/48"},
                                                  {"--shutter", "1/0", "like 0.02 or 1/48"},
                                                  {"--shutter", "0:1:2", "like 0.02 or 1/48"},
                                                  {"--frame-time", "noon", "is not a number"},
                                                  {"--animation", "slid", "did you mean \"slide\"?"}}) {
            const Outcome o = with("lamp.gltf", {std::string(option) + "=" + value});
            CHECK(o.code == 64);
            CHECK_MESSAGE(contains(o.err, part), o.err);
        }
    }
} // TEST_SUITE
