// Pictures of other renderers (../shared/references, where it exists): image means and block means agree within the tolerance that the
// index states. They tell that units, cameras, lights, depth and materials are read as meant.
#include "io/gltf.h"
#include "io/image_read.h"
#include "tests/scene_kit.h"
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

using namespace chiaro;
using namespace chiaro::test;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

const fs::path shared = "../shared";

Json readJson(const fs::path& file) {
    std::ifstream in(file);
    return Json::parse(in);
}

// The scene as its sheet describes it.
std::unique_ptr<const Scene> load(const fs::path& file) {
    Diagnostics notes;
    SceneDesc desc = readGltf(file, {}, notes);
    for (MaterialDesc& m : desc.materials) m.compensated = false; // theirs are not
    const Json sheet = readJson(file.parent_path() / "scene.json");
    if (sheet.contains("environment")) {
        desc.environment = readEnvironment(file.parent_path() / sheet["environment"]["file"].get<std::string>(), notes);
        desc.environment->scale = sheet["environment"]["scale"];
    }
    return Scene::compile(std::move(desc), notes, {}, nullptr, ClosureTable::make);
}

struct Difference {
    double mean = 0, blockMedian = 0; // relative, the worst channel
};
Difference compare(const Film& film, const Json& reference) {
    constexpr uint32_t blocks = 8;
    const Spectrum mean = meanOf(film);
    const Rect all = film.layout().crop;
    Difference d;
    for (std::size_t c = 0; c < 3; ++c) d.mean = std::max(d.mean, std::fabs(double(mean[c]) / reference["mean"][c].get<double>() - 1));
    std::vector<double> differences;
    for (uint32_t by = 0; by < blocks; ++by)
        for (uint32_t bx = 0; bx < blocks; ++bx) {
            const Rect r{bx * all.width() / blocks, by * all.height() / blocks, (bx + 1) * all.width() / blocks,
                         (by + 1) * all.height() / blocks};
            Rgb<double> sum(0);
            for (uint32_t y = r.y0; y < r.y1; ++y)
                for (uint32_t x = r.x0; x < r.x1; ++x)
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += double(film.mean({x, y})[c]) / double(r.area());
            const auto expected = reference["blocks_8x8"][by * blocks + bx].get<std::vector<double>>();
            const double brightest = *std::max_element(expected.begin(), expected.end());
            if (brightest < 1e-3) continue; // black in the reference
            double worst = 0;
            for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::fabs(sum[c] - expected[c]) / brightest);
            differences.push_back(worst);
        }
    std::sort(differences.begin(), differences.end());
    d.blockMedian = differences.empty() ? 0 : differences[differences.size() / 2];
    return d;
}

// The scenes of the index whose place is k modulo n: several suites share them, so that they run side by side.
void compareSome(std::size_t k, std::size_t n) {
    if (!fs::exists(shared / "references" / "index.json")) {
        MESSAGE("SKIPPED: no ../shared/references beside the project");
        return;
    }
    const Json index = readJson(shared / "references" / "index.json");
    std::size_t place = 0;
    for (const auto& [name, reference] : index.items()) {
        if (place++ % n != k) continue;
        CAPTURE(name);
        const auto scene = load(shared / reference["scene"].get<std::string>());
        const uint32_t spp = name == "door-ajar" || name == "lamp-room" ? 112 : 64; // the noise stays well inside the tolerances
        const Settings how{reference["width"], reference["height"],   spp, {}, 1, 0, SamplerKind::sobol,
                           FilterKind::box,    reference["max_depth"]};
        const Rendering r = rendered(*scene, scene->cameras()[0], how);
        const Difference d = compare(*r.film, reference);
        MESSAGE(name << ": mean " << d.mean << ", blocks " << d.blockMedian);
        CHECK(d.mean <= reference["tolerance"]["mean_relative"].get<double>());
        CHECK(d.blockMedian <= reference["tolerance"]["block_relative_median"].get<double>());
    }
}

} // namespace

TEST_SUITE("references-1") {
    TEST_CASE("other renderers' pictures, part 1 of 5") { compareSome(0, 5); }
}
TEST_SUITE("references-2") {
    TEST_CASE("other renderers' pictures, part 2 of 5") { compareSome(1, 5); }
}
TEST_SUITE("references-3") {
    TEST_CASE("other renderers' pictures, part 3 of 5") { compareSome(2, 5); }
}
TEST_SUITE("references-4") {
    TEST_CASE("other renderers' pictures, part 4 of 5") { compareSome(3, 5); }
}
TEST_SUITE("references-5") {
    TEST_CASE("other renderers' pictures, part 5 of 5") { compareSome(4, 5); }
}
