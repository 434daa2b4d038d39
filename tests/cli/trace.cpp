// chiaro trace and the layers of cost as a user meets them.
#include "io/picture.h"
#include "program.h"
#include <nlohmann/json.hpp>
#include <sstream>

using namespace program;
using chiaro::Picture;
using chiaro::readPicture;

namespace {

// R G B behind "value ", and those of `render --pixel`.
std::vector<float> numbers(const std::string& text, const std::string& after) {
    const std::size_t at = text.rfind(after);
    std::vector<float> all(3, -1);
    if (at == std::string::npos) return all;
    std::istringstream in(text.substr(at + after.size()));
    for (float& v : all) in >> v;
    return all;
}

} // namespace

TEST_SUITE("trace") {

    TEST_CASE("the value is the one that render replays") {
        if (absent()) return;
        const Folder folder;
        for (const char* sample : {"0", "5"}) {
            const std::vector<std::string> common = {"@cornell-spheres", "--size", "64x64", "--pixel", "40,44", "--sample", sample, "-q"};
            std::vector<std::string> render = {"render"}, trace = {"trace"};
            render.insert(render.end(), common.begin(), common.end());
            trace.insert(trace.end(), common.begin(), common.end());
            const Outcome r = run(folder, render), t = run(folder, trace);
            CHECK(r.code == 0);
            CHECK(t.code == 0);
            CHECK(t.err.empty());
            CAPTURE(t.out);
            CHECK(numbers(t.out, "value ") == numbers("value " + r.out, "value "));
            CHECK(!contains(t.out, "sum to"));
            CHECK(contains(t.out, "   0 camera at ("));
            CHECK(contains(t.out, "   1 hit \""));
        }
    }

    TEST_CASE("text, JSON and lines of several integrators and samples") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = run(folder, {"trace", "@cornell", "--size", "32x32", "--pixel", "16,20", "--spp", "3", "--sample", "2", "-i",
                                       "path,path:nee=off,normals", "--json", "-o", "{scene}.glb", "--max-depth", "3"});
        CHECK(o.code == 0);
        CHECK(contains(o.err, "wrote    cornell.glb"));
        const auto json = nlohmann::json::parse(o.out);
        CHECK(json["pixel"] == nlohmann::json::array({16, 20}));
        CHECK(json["files"] == nlohmann::json::array({"cornell.glb"}));
        REQUIRE(json["integrators"].size() == 3);
        for (const auto& side : json["integrators"]) {
            REQUIRE(side["samples"].size() == 3);
            for (std::size_t i = 0; i < 3; ++i) {
                const auto& s = side["samples"][i];
                CHECK(s["sample"] == 2 + i);
                // The value is that of the picture, the sum that of the path alone: what runs in lanes adds up in another order.
                for (std::size_t c = 0; c < 3; ++c)
                    CHECK(s["rgb"][c].get<float>() == doctest::Approx(s["sum"][c].get<float>()).epsilon(1e-6));
                CHECK(s["depth"].get<int>() <= 3);
                CHECK(s["vertices"][0]["parent"].is_null());
                CHECK(s["vertices"][0]["kind"] == "surface");
                float sum = 0; // in floats, as the sample was added up
                for (const auto& v : s["vertices"]) sum += v["contribution"][0].get<float>();
                CHECK(sum == s["sum"][0].get<float>());
            }
        }
        CHECK(json["integrators"][1]["integrator"] == "path:nee=off");
        const Outcome info = run(folder, {"info", "cornell.glb"});
        CHECK(info.code == 0);
        CHECK(contains(info.out + info.err, "has a primitive of points or lines, which is not drawn"));
        const Outcome text = run(folder, {"trace", "@cornell", "--size", "32x32", "--pixel", "16,20", "-i", "path,normals", "-q"});
        CHECK(contains(text.out, "\n\nnormals   @cornell camera \"main\" pixel 16,20 seed 0\n"));
        CHECK(contains(text.out, "La "));
    }

    TEST_CASE("light paths that end at the eye name their class") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = run(folder, {"trace", "@cornell", "--size", "32x32", "--pixel", "16,16", "-i", "light", "--spp", "16", "--json"});
        REQUIRE(o.code == 0);
        const auto json = nlohmann::json::parse(o.out);
        int eyes = 0;
        for (const auto& s : json["integrators"][0]["samples"])
            for (const auto& v : s["vertices"])
                if (v["kind"] == "eye") {
                    ++eyes;
                    CHECK(v["event"] == "DR");
                    CHECK(v["path"].get<std::string>().starts_with("La DR "));
                }
        CHECK(eyes > 0);
        const Outcome text = run(folder, {"trace", "@cornell", "--size", "32x32", "--pixel", "16,16", "-i", "light", "--spp", "16", "-q"});
        CHECK(contains(text.out, "[La DR E]"));
    }

    TEST_CASE("what cannot be traced is said in one line") {
        if (absent()) return;
        const Folder folder;
        struct Row {
            std::vector<std::string> words;
            int code;
            const char* message;
        };
        const Row rows[] = {
            {{"trace", "@cornell"}, 64, "trace needs --pixel X,Y"},
            {{"trace", "@cornell", "--pixel", "400,3", "--size", "32x32"}, 64, "inside the picture of 32x32"},
            {{"trace", "@cornell", "--pixel", "4;3"}, 64, "a pixel like 119,518"},
            {{"trace", "@cornell", "--pixel", "4,3", "-i", "pth"}, 64, "did you mean path?"},
            {{"trace", "@cornell", "--pixel", "4,3", "-i", "path,path"}, 64, "named twice"},
            {{"trace", "@cornell", "--pixel", "4,3", "-o", "no/such/file.glb"}, 4, "cannot write"},
            {{"trace", "@cornell", "--pixel", "4,3", "-o", "file.gltf"}, 64, "with this ending"},
            {{"trace", "@cornell", "--pixel", "4,3", "-o", "-"}, 64, "does not go to stdout"},
            {{"trace", "@cornell", "--pixel", "4,3", "--spp", "5000"}, 64, "from 1 to 4096"},
            {{"trace", "@cornell", "--pixl", "4,3"}, 64, "did you mean --pixel?"},
            {{"trace", "absent.glb", "--pixel", "4,3"}, 4, "no such file"},
        };
        for (const Row& row : rows) {
            const Outcome o = run(folder, row.words);
            CAPTURE(row.message);
            CAPTURE(o.err);
            CHECK(o.code == row.code);
            CHECK(o.out.empty());
            CHECK(contains(o.err, row.message));
        }
    }

    TEST_CASE("layers of a picture are those of --aov") {
        if (absent()) return;
        const Folder folder;
        const auto picture = [&](const std::string& name, std::vector<std::string> more) {
            std::vector<std::string> words = {"render", "@cornell", "--size", "24x24", "--spp", "2", "-q", "-o", name};
            words.insert(words.end(), more.begin(), more.end());
            const Outcome o = run(folder, words);
            CAPTURE(o.err);
            CHECK(o.code == 0);
            return readPicture(folder / name);
        };
        const Picture plain = picture("plain.exr", {}), cost = picture("cost.exr", {"--aov", "cost", "-o", "cost.png"}),
                      none = picture("none.exr", {"--aov", "none"}), all = picture("all.exr", {"--aov", "all"}),
                      single = picture("single.exr", {"-i", "path:wide=off"}); // a clock looks at one path at a time
        for (const char* name : {"albedo.R", "normal.X", "Z"}) {
            CHECK(plain.find(name) != nullptr);
            CHECK(all.find(name) != nullptr);
            CHECK(none.find(name) == nullptr);
            CHECK(cost.find(name) == nullptr);
        }
        for (const char* name : {"cost.time", "cost.rays", "cost.depth"}) {
            CHECK(plain.find(name) == nullptr);
            REQUIRE(cost.find(name) != nullptr);
            for (const float v : *cost.find(name)) CHECK(v >= 0);
        }
        CHECK(*cost.find("cost.rays") == *all.find("cost.rays"));
        for (const char* name : {"R", "G", "B", "error.R", "samples"}) {
            CHECK(*single.find(name) == *cost.find(name)); // bits: no value is a NaN
            CHECK(*single.find(name) == *all.find(name));
            CHECK(*plain.find(name) == *none.find(name));
        }
        for (const char* name : {"cost.png", "cost.cost.time.png", "cost.cost.rays.png", "cost.cost.depth.png"})
            CHECK(fs::exists(folder / name));
        const Outcome typo = run(folder, {"render", "@cornell", "--aov", "albedo,cots"});
        CHECK(typo.code == 64);
        CHECK(contains(typo.err, "did you mean cost?"));
        CHECK(run(folder, {"render", "@cornell", "--aov", "none,cost"}).code == 64);
    }
}
