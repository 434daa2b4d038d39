// The error table: one clear line on stderr, nothing on stdout, the right exit code.
#include "program.h"

using namespace program;

namespace {

struct Row {
    std::vector<std::string> words;
    int code;
    std::string message; // a part of the line
};

void check(const Folder& folder, const Row& row) {
    std::string typed;
    for (const std::string& w : row.words) typed += " " + w;
    CAPTURE(typed);
    const Outcome o = run(folder, row.words);
    CHECK(o.code == row.code);
    CHECK(o.out.empty());
    CAPTURE(o.err);
    CHECK(contains(o.err, row.message));
    const std::size_t at = o.err.find("error: ");
    REQUIRE(at != std::string::npos);
    CHECK(o.err.find('\n', at) == o.err.size() - 1); // one line, the last
    CHECK(o.err.find("error: ", at + 1) == std::string::npos);
}

} // namespace

TEST_SUITE("errors") {

    TEST_CASE("unknown words are answered with the nearest") {
        if (absent()) return;
        const Folder folder;
        check(folder, {{"render", "@cornell", "--ssp", "4"}, 64, "error: unknown option --ssp; did you mean --spp? (chiaro help render)"});
        check(folder, {{"render", "@cornell", "--ssp=4"}, 64, "unknown option --ssp; did you mean --spp?"});
        check(folder, {{"info", "@cornell", "--jsn"}, 64, "unknown option --jsn; did you mean --json? (chiaro help info)"});
        check(folder, {{"rendr", "@cornell"}, 64, "unknown command \"rendr\"; did you mean render?"});
        check(folder, {{"--spp", "4"}, 64, "unknown option --spp"});
        check(folder, {{"render", "@cornel"}, 64, "did you mean @cornell?"});
        check(folder, {{"render", "@cornell", "-i", "pathtracer"}, 64, "no integrator \"pathtracer\"; have path, "});
        check(folder, {{"render", "@cornell", "-i", "pathtracer"}, 64, "did you mean path?"});
        check(folder, {{"render", "@cornell", "-i", "path:rr-dept=3"}, 64, "did you mean rr-depth?"});
        check(folder, {{"integrators", "norms"}, 64, "did you mean normals?"});
        check(folder, {{"help", "unit"}, 64, "did you mean units?"});
        check(folder, {{"render", "@cornell", "--view", "Standrd"}, 64, "no view \"Standrd\"; have \"Standard\", \"ACES 1.0 SDR\""});
        check(folder, {{"render", "@cornell", "--view", "Standrd"}, 64, "did you mean \"Standard\"?"});
        check(folder, {{"render", "@cornell", "-c", "mian"}, 64, "did you mean \"main\"?"});
    }

    TEST_CASE("operands") {
        if (absent()) return;
        const Folder folder;
        check(folder, {{"render"}, 64, "render needs SCENE"});
        check(folder, {{"render", "@cornell", "more"}, 64, "unexpected argument \"more\""});
        check(folder, {{"render", "@cornell", "--spp"}, 64, "--spp needs a value N"});
        check(folder, {{"render", "@cornell", "--sample", "3"}, 64, "add --pixel"});
        CHECK(run(folder, {}).code == 64);
    }

} // TEST_SUITE

// A suite of its own: a hundred starts of the program.
TEST_SUITE("values") {

    TEST_CASE("values of the wrong form or range") {
        if (absent()) return;
        const Folder folder;
        const std::vector<std::pair<std::string, std::vector<std::string>>> bad = {
            {"--spp", {"abc", "0", "-3", "1.5", "1e30", ""}},
            {"--time", {"5x", "0", "-3s", "s", "inf"}},
            {"--max-depth", {"-1", "x", "70000"}},
            {"--rr-depth", {"-1", "x"}},
            {"--size", {"640", "640x", "0x10", "10x0", "640x480x2", "99999x10", "-1x5"}},
            {"--crop", {"10x10", "0x5+1+1", "10x10+510+0", "10x10+0", "10x10+-1+0"}},
            {"--pixel", {"3", "3,", "512,0", "0,512", "-1,0", "1,2,3"}},
            {"--seed", {"-1", "x", "99999999999999999999"}},
            {"--threads", {"0", "-2", "two", "99999"}},
            {"--sampler", {"sobl", ""}},
            {"--filter", {"boxx"}},
            {"--isa", {"avx3"}},
            {"--missing-texture", {"gray"}},
            {"--env-rotate", {"x", "nan", "1e9"}},
            {"--env-scale", {"-1", "nan", "inf"}},
            {"--exposure", {"x", "nan", "1000"}},
            {"--progress", {"barr"}},
        };
        for (const auto& [option, values] : bad)
            for (const std::string& value : values) check(folder, {{"render", "@cornell", option, value}, 64, option});
    }

} // TEST_SUITE

TEST_SUITE("errors") {

    TEST_CASE("scene files") {
        if (absent()) return;
        const Folder folder;
        folder.write("scene_v2.glb", "glTF");
        check(folder, {{"render", "scene.glb"}, 4, "scene.glb: no such file"});
        check(folder, {{"render", "scene.glb"}, 4, "scene_v2.glb"});
        check(folder, {{"render", "@cornell", "--env", "sky.hdr"}, 4, "sky.hdr"});
        folder.write(
            "basis.gltf",
            R"({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_texture_basisu"], "extensionsUsed": ["KHR_texture_basisu"]})");
        check(folder, {{"render", "basis.gltf"},
                       3,
                       "basis.gltf needs KHR_texture_basisu, which this build cannot read. Try: gltf-transform ktxdecompress"});
        // A header that promises more than there is.
        folder.write("short.glb", std::string("glTF\x02\0\0\0\x00\x40\x01\0\x00\x30\x01\0JSON{}", 22));
        check(folder, {{"render", "short.glb"}, 4, "short.glb: "});
        folder.write("none.glb", "");
        check(folder, {{"render", "none.glb"}, 4, "none.glb: "});
        folder.write("text.gltf", "this is no JSON");
        check(folder, {{"info", "text.gltf"}, 4, "text.gltf: "});
        folder.write("picture.exr", "this is no picture");
        check(folder, {{"info", "picture.exr"}, 4, "picture.exr: "});
    }

    TEST_CASE("an absent texture, and the way out") {
        if (absent()) return;
        const Folder folder;
        folder.write("room.gltf", triangle(R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})",
                                           R"(, "textures": [{"source": 0}], "images": [{"uri": "tex/wood.png"}])"));
        check(folder, {{"render", "room.gltf"}, 4, "tex/wood.png"});
        check(folder, {{"render", "room.gltf"}, 4, "--missing-texture grey"});
        const Outcome grey = run(folder, {"render", "room.gltf", "--missing-texture", "grey", "--spp", "1", "--size", "16x16"});
        CHECK(grey.code == 0);
        CHECK(contains(grey.err, "warning: "));
        CHECK(run(folder, {"render", "room.gltf", "--missing-texture", "grey", "--spp", "1", "--size", "16x16", "--strict"}).code == 1);
    }

    TEST_CASE("outputs are checked before rendering") {
        if (absent()) return;
        const Folder folder;
        const std::string nothingLost = "checked before rendering, nothing lost.";
        check(folder, {{"render", "@cornell", "-o", "no/such/a.exr"}, 4, nothingLost});
        check(folder, {{"render", "@cornell", "-o", "no/such/a.exr"}, 4, "cannot write no/such/a.exr (no folder no/such)"});
        fs::create_directory(folder / "folder.png");
        check(folder, {{"render", "@cornell", "-o", "folder.png"}, 4, "cannot write folder.png (is a directory); " + nothingLost});
        check(folder, {{"render", "@cornell", "-o", "/proc/a.exr"}, 4, "cannot write /proc/a.exr"});
        check(folder, {{"render", "@cornell", "-o", "a.jpg"}, 64, "writes .exr and .png"});
        check(folder, {{"render", "@cornell", "-o", "-"}, 64, "does not go to stdout"});
        check(folder, {{"render", "@cornell", "-o", "a.exr", "-o", "a.exr"}, 64, "named twice"});
        if (geteuid() == 0) {
            MESSAGE("not checked as root, who may write everywhere: a folder without permission");
            return;
        }
        fs::create_directory(folder / "closed");
        fs::permissions(folder / "closed", fs::perms::owner_read | fs::perms::owner_exec);
        check(folder, {{"render", "@cornell", "-o", "closed/a.exr"}, 4, "cannot write closed/a.exr (permission denied); " + nothingLost});
    }

    TEST_CASE("a picture beyond the memory is refused with a size that fits") {
        if (absent()) return;
        const Folder folder;
        check(folder, {{"render", "@cornell", "--size", "65536x65536"}, 6, "Try --size "});
    }

    TEST_CASE("colour configurations") {
        if (absent()) return;
        const Folder folder;
        check(folder, {{"render", "@cornell", "--ocio", "none.ocio"}, 4, "none.ocio"});
        folder.write("bad.ocio", "ocio_profile_version: 2\nroles: [");
        check(folder, {{"render", "@cornell", "--ocio", "bad.ocio"}, 4, "bad.ocio"});
    }

    TEST_CASE("configuration files") {
        if (absent()) return;
        const Folder folder;
        folder.write("typo.json", R"({"ssp": 3})");
        check(folder, {{"render", "@cornell", "--config", "typo.json"}, 64, "typo.json: unknown option \"ssp\"; did you mean \"spp\"?"});
        folder.write("broken.json", "{");
        check(folder, {{"render", "@cornell", "--config", "broken.json"}, 4, "broken.json: not valid JSON"});
        folder.write("list.json", R"({"spp": [1, 2]})");
        check(folder, {{"render", "@cornell", "--config", "list.json"}, 64, "takes one value"});
        folder.write("range.json", R"({"spp": -1})");
        check(folder, {{"render", "@cornell", "--config", "range.json"}, 64, "--spp"});
        check(folder, {{"render", "@cornell", "--config", "absent.json"}, 4, "absent.json"});
    }

} // TEST_SUITE
