// What a user may see of photons: --aov photons and --photon-map.
#include "io/picture.h"
#include "program.h"
#include <cstring>
#include <nlohmann/json.hpp>

using namespace program;

namespace {

std::vector<std::string> render(const std::string& integrator, std::vector<std::string> more) {
    std::vector<std::string> words{"render", "@cornell", "-i", integrator, "--size", "16x16", "--spp", "1", "-o", "p.exr"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}
nlohmann::json glbHead(const fs::path& file) {
    const std::string bytes = readAll(file);
    uint32_t length = 0;
    REQUIRE(bytes.size() > 20);
    std::memcpy(&length, bytes.data() + 12, 4);
    return nlohmann::json::parse(bytes.substr(20, length));
}

} // namespace

TEST_SUITE("photon-output") {
    TEST_CASE("the layers of density estimates are in the picture where they are asked for") {
        if (absent()) return;
        const Folder folder;
        for (const char* aov : {"photons", "all"}) {
            CAPTURE(aov);
            REQUIRE(run(folder, render("photon", {"--aov", aov})).code == 0);
            const chiaro::Picture p = chiaro::readPicture(folder / "p.exr");
            for (const char* name : {"photons.density", "photons.radius", "photons.count"}) {
                const std::vector<float>* plane = p.find(name);
                REQUIRE(plane);
                double sum = 0;
                for (const float v : *plane) {
                    CHECK(v >= 0);
                    sum += double(v);
                }
                CHECK(sum > 0);
            }
        }
        REQUIRE(run(folder, render("path", {"--aov", "all"})).code == 0);
        CHECK(chiaro::readPicture(folder / "p.exr").find("photons.count") == nullptr);
    }

    TEST_CASE("the photon map is a cloud of coloured points") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = run(folder, render("photon", {"--photon-map", "m.glb"}));
        REQUIRE(o.code == 0);
        CHECK(contains(o.err, "photons in m.glb"));
        const nlohmann::json head = glbHead(folder / "m.glb");
        REQUIRE(head["meshes"].size() > 0);
        const nlohmann::json& points = head["meshes"][0]["primitives"][0];
        CHECK(points["mode"] == 0);
        const std::size_t position = points["attributes"]["POSITION"], color = points["attributes"]["COLOR_0"];
        CHECK(head["accessors"][position]["count"] == head["accessors"][color]["count"]);
        CHECK(std::to_string(head["accessors"][position]["count"].get<uint64_t>()) == head["nodes"][0]["extras"]["photons"]);
    }

    TEST_CASE("who has no photons says so in one line") {
        if (absent()) return;
        const Folder folder;
        for (const std::vector<std::string>& more : {std::vector<std::string>{"--photon-map", "m.glb"}, {"--aov", "photons"}}) {
            const Outcome o = run(folder, render("path", more));
            CHECK(o.code == 3);
            CHECK(contains(o.err, "path has no photons; those that have: photon"));
            CHECK_FALSE(fs::exists(folder / "p.exr"));
        }
        const Outcome o = run(folder, render("photon", {"--photon-map", "m.ply"}));
        CHECK(o.code == 64);
        CHECK(contains(o.err, ".glb"));
        CHECK(run(folder, render("photon", {"--photon-map", "no/such/folder/m.glb"})).code == 4);
    }
} // TEST_SUITE
