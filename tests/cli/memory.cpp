// What does not fit is refused before it is begun, by every command that loads a scene; the peak is told.
#include "tools/cli/memory.h"
#include "io/picture.h"
#include "tests/cli/program.h"
#include "tests/io/gltf_builder.h"
#include <OpenImageIO/imageio.h>

using program::absent;
using program::contains;
using program::Outcome;
using program::run;

namespace {

using Words = std::vector<std::string>;

std::string largeScene() { // 20,000 triangles
    chiaro::test::Builder b;
    std::vector<float> positions;
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < 20'000; ++i)
        for (uint32_t k = 0; k < 3; ++k) {
            positions.insert(positions.end(), {float(i % 100) + 0.5f * float(k == 1), float(i / 100) + 0.5f * float(k == 2), 0});
            indices.push_back(3 * i + k);
        }
    b.node({{"mesh", b.mesh({{"POSITION", b.accessor(positions, 3, "VEC3")}}, {{"indices", b.accessor(indices, 1, "SCALAR")}})}});
    return b.asGlb();
}

} // namespace

TEST_SUITE("cli-memory") {

    TEST_CASE("a scene that does not fit is refused by every command, before anything is written") {
        if (absent()) return;
        const program::Folder folder;
        folder.write("large.glb", largeScene());
        for (Words words : {Words{"render"}, Words{"compare", "-i", "path,whitted"}, Words{"agree", "-i", "whitted,path"},
                            Words{"trace", "--pixel", "1,1"}, Words{"bake"}, Words{"info"}, Words{"ff"}}) {
            words.insert(words.begin() + 1, "large.glb");
            words.insert(words.end(), {"--max-memory", "2M"});
            CAPTURE(words[0]);
            const Outcome o = run(folder, words);
            CAPTURE(o.err);
            CHECK(o.code == 6);
            CHECK(contains(o.err, "error: large.glb needs about 4 MB"));
            CHECK(contains(o.err, "--max-memory is 2 MB. Use fewer triangles, or instances of shared meshes, or --max-memory 4M."));
        }
        const Outcome file = run(folder, {"info", "large.glb", "--max-memory", "500k"});
        CHECK(file.code == 64); // 1M is the least
        for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
            CHECK((entry.path().filename() == "large.glb" || entry.path().filename().string().starts_with(".")));
    }

    TEST_CASE("so are textures and environments, by their headers") {
        if (absent()) return;
        const program::Folder folder;
        constexpr int edge = 2048;
        for (const char* name : {"large.png", "sky.hdr"}) {
            const auto out = OIIO::ImageOutput::create((folder / name).string());
            REQUIRE(out);
            const std::vector<float> grey(std::size_t(edge) * edge * 3, 0.5f);
            const bool png = std::string(name).ends_with("png");
            REQUIRE(
                out->open((folder / name).string(), OIIO::ImageSpec(edge, edge, 3, png ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT)));
            REQUIRE(out->write_image(OIIO::TypeDesc::FLOAT, grey.data()));
        }
        folder.write("t.gltf", program::triangle(R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})",
                                                 R"(, "textures": [{"source": 0}], "images": [{"uri": "large.png"}])"));
        const Outcome textures = run(folder, {"render", "t.gltf", "--max-memory", "10M"});
        CAPTURE(textures.err);
        CHECK(textures.code == 6);
        CHECK(contains(textures.err, "(textures 22 MB)"));
        CHECK(contains(textures.err, "Make the textures smaller"));
        const Outcome sky = run(folder, {"render", "@cornell", "--env", "sky.hdr", "--max-memory", "100M"});
        CAPTURE(sky.err);
        CHECK(sky.code == 6);
        CHECK(contains(sky.err, "needs about"));
        CHECK(run(folder, {"render", "t.gltf", "--size", "8x8", "--spp", "1", "--max-memory", "40M", "-q"}).code == 0);
        chiaro::test::Builder many;
        nlohmann::json drawn = nlohmann::json::array();
        const auto positions = many.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, "VEC3");
        for (int i = 0; i < 2200; ++i)
            drawn.push_back(
                {{"attributes", {{"POSITION", positions}}}, {"material", many.add("materials", {{"name", std::to_string(i)}})}});
        many.node({{"mesh", many.add("meshes", {{"primitives", drawn}})}});
        folder.write("many.glb", many.asGlb());
        const Outcome materials = run(folder, {"info", "many.glb", "--max-memory", "3M"});
        CAPTURE(materials.err);
        CHECK(materials.code == 6);
        CHECK(contains(materials.err, "materials 5 MB"));
        CHECK(contains(materials.err, "Use fewer materials"));
    }

    TEST_CASE("a picture is weighed beside its scene; the peak is told") {
        if (absent()) return;
        const program::Folder folder;
        folder.write("large.glb", largeScene());
        const Outcome o = run(folder, {"render", "large.glb", "--size", "200x200", "--max-memory", "4M"});
        CAPTURE(o.err);
        CHECK(o.code == 6);
        CHECK(contains(o.err, "of the scene, --max-memory is 4 MB"));
        const Outcome done = run(folder, {"render", "large.glb", "--size", "16x16", "--spp", "1", "--json"});
        CHECK(contains(done.err, "non-finite   peak "));
        const auto memory = nlohmann::json::parse(done.out)["memory"];
        CHECK(memory["peak"].get<double>() > memory["scene"]["total"].get<double>());
        CHECK(memory["scene"]["geometry"].get<double>() == 20'000 * 3 * 12.0 + 12 + 20'000 * 12.0);
        const Outcome info = run(folder, {"info", "large.glb"});
        CHECK(contains(info.out, "bytes a triangle without textures"));
    }

    TEST_CASE("an allocation that fails all the same ends with exit code 6 and a line") {
        if (absent()) return;
        const program::Folder folder;
        const std::string line = "cd '" + folder.path().string() + "' && ulimit -v 3000000 && '" + std::getenv("CHIARO") +
                                 "' render @cornell --size 16000x16000 --max-memory 1T -t 1 --spp 1 -o o.exr 2>err";
        const int status = std::system(line.c_str());
        CAPTURE(program::readAll(folder / "err"));
        CHECK(WEXITSTATUS(status) == 6);
        CHECK(contains(program::readAll(folder / "err"), "error: not enough memory. "));
    }

    TEST_CASE("the machine's memory, and what this process took") {
        CHECK(chiaro::cli::machineBytes() > 100'000'000);
        CHECK(chiaro::cli::peakBytes() > 1'000'000);
        CHECK(chiaro::cli::peakBytes() < chiaro::cli::machineBytes());
    }

} // TEST_SUITE
