// Samples that are no numbers: counted, located, and brought back by the very command that is printed.
#include "io/picture.h"
#include "tests/cli/program.h"
#include <nlohmann/json.hpp>

using namespace program;
using chiaro::Picture;

namespace {

// A lamp of 1e12 cd/m2 over a floor: a film holds less than 2^36 = 6.9e10. The name wants quoting.
const char* const hot = "a lamp's.gltf";
std::string hotScene() {
    std::string text = triangle(R"({"name": "wall", "doubleSided": true}, {"name": "lamp", "emissiveFactor": [1, 1, 1], "doubleSided": true,
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 1e12}}})",
                                R"(, "extensionsUsed": ["KHR_materials_emissive_strength"],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}}])");
    const auto replace = [&](const std::string& from, const std::string& to) { text.replace(text.find(from), from.size(), to); };
    replace(R"([{"nodes": [0]}])", R"([{"nodes": [0, 1, 2]}])");
    replace(R"([{"mesh": 0}])", R"([{"mesh": 0}, {"mesh": 1, "translation": [0.4, 0.4, 0.3], "scale": [0.3, 0.3, 0.3]},
        {"camera": 0, "name": "the eye", "translation": [0.4, 0.4, 1.5]}])");
    replace(R"([{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}])",
            R"([{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]},
                {"primitives": [{"attributes": {"POSITION": 0}, "material": 1}]}])");
    return text;
}

// A line for the shell, with chiaro in the path as a user has it.
Outcome shell(const Folder& folder, const std::string& line) {
    fs::create_directories(folder / "bin");
    if (!fs::exists(folder / "bin/chiaro")) fs::create_symlink(fs::absolute(std::getenv("CHIARO")), folder / "bin/chiaro");
    folder.write("line.sh", line + "\n");
    const std::string all = "cd '" + folder.path().string() + "' && PATH=\"$PWD/bin:$PATH\" sh line.sh >.out 2>.err";
    const int status = std::system(all.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readAll(folder / ".out"), readAll(folder / ".err")};
}

std::string attribute(const Picture& p, const char* name) {
    const chiaro::MetadataValue* v = p.attribute(name);
    return v && std::holds_alternative<std::string>(*v) ? std::get<std::string>(*v) : std::string();
}

} // namespace

TEST_SUITE("ledger") {

    TEST_CASE("every integrator tells what brings its dropped samples back, and it does") {
        if (absent()) return;
        const Folder folder;
        folder.write(hot, hotScene());
        int dropped = 0;
        const auto list = nlohmann::json::parse(run(folder, {"integrators", "--json"}).out);
        for (const auto& entry : list.is_array() ? list : list["integrators"]) {
            const std::string name = entry["name"];
            CAPTURE(name);
            const std::string options = name == "photon" || name == "sppm" ? ":count=2000" : name == "path" ? ":rr-depth=2" : "";
            const Outcome o = run(folder, {"render",   hot,      "-i", name + options, "--size",  "12x12",      "--spp",
                                           "2",        "--seed", "5",  "-c",           "the eye", "--sampler",  "independent",
                                           "--filter", "box",    "-o", "p.exr",        "--json",  "--progress", "none"});
            CAPTURE(o.err);
            REQUIRE(o.code == 0);
            const auto summary = nlohmann::json::parse(o.out);
            const Picture p = chiaro::readPicture(folder / "p.exr");
            CHECK(attribute(p, "chiaro:dropped") == std::to_string(summary["dropped"].get<uint64_t>()));
            if (summary["dropped"] == 0) {
                CHECK(summary["ledger"].empty());
                continue;
            }
            ++dropped;
            CHECK(!summary["ledger"].empty());
            CHECK(contains(attribute(p, "chiaro:ledger"), " sample "));
            const std::size_t at = o.err.find("Reproduce: ");
            REQUIRE(at != std::string::npos);
            const std::string command = o.err.substr(at + 11, o.err.find('\n', at) - at - 11);
            CAPTURE(command);
            CHECK(contains(command, "chiaro "));
            CHECK(contains(command, "--seed 5"));
            const Outcome again = shell(folder, command);
            CAPTURE(again.out);
            CAPTURE(again.err);
            CHECK(again.code == 0);
            if (contains(command, "chiaro trace"))
                CHECK(contains(again.out, "adds "));
            else if (contains(command, "--crop"))
                CHECK(contains(again.err, "dropped"));
            else
                CHECK(contains(again.err, ": left out of pictures"));
            if (contains(command, "--sample "))
                for (const auto& line : summary["ledger"])
                    if (line.contains("replay") && contains(line["replay"], "--pixel"))
                        CHECK(contains(shell(folder, line["replay"]).err, ": left out of pictures"));
        }
        CHECK(dropped >= 5);
    }

    TEST_CASE("a sample again tells its value and its path") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = run(folder, {"render", "@cornell", "--size", "32x32", "--pixel", "16,20", "--sample", "3", "--seed", "2"});
        CHECK(o.code == 0);
        CHECK(contains(o.out, "\n\npath   @cornell camera \"main\" pixel 16,20 seed 2\nsample 3\n"));
        CHECK(contains(o.out, "   1 hit \""));
        const std::string value = o.out.substr(0, o.out.find('\n'));
        CHECK(contains(o.out, "value " + value));
        const Outcome json = run(folder, {"render", "@cornell", "--size", "32x32", "--pixel", "16,20", "--sample", "3", "--json", "-q"});
        CHECK(nlohmann::json::parse(json.out)["trace"].is_object());
        const Outcome light = run(folder, {"render", "@cornell", "-i", "light", "--pixel", "1,1"});
        CHECK(light.code == 3);
        CHECK(contains(light.err, "chiaro trace --sample N"));
    }

    TEST_CASE("numbers that are none in a texture are mended where they are read, with a warning") {
        if (absent()) return;
        const Folder folder;
        Picture p;
        p.width = p.height = 2;
        p.window = {0, 0, 2, 2};
        const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
        p.add("R") = {inf, 1, 1, 1};
        p.add("G") = {nan, 1, 1, 1};
        p.add("B") = {-inf, 1, 1, 1};
        chiaro::writeExr(folder / "hot.exr", p);
        std::string text = triangle(R"({"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}, "doubleSided": true})",
                                    R"(, "textures": [{"source": 0}], "images": [{"uri": "hot.exr"}])");
        folder.write("t.gltf", text);
        const Outcome o = run(folder, {"render", "t.gltf", "--size", "16x16", "--spp", "4", "-o", "o.exr"});
        CAPTURE(o.err);
        CHECK(o.code == 0);
        CHECK(contains(o.err, "/images/0/uri holds 3 numbers that are not finite; they became 0."));
        CHECK(contains(o.err, "   0 non-finite"));
    }

} // TEST_SUITE
