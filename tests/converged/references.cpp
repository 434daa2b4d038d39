// The stored references: their format, their refusals, and the one way to make them.
#include "tests/converged/comparison.h"
#include <algorithm>
#include <cstdlib>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fstream>
#include <functional>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr uint64_t referenceSeed = 1'000'000;
constexpr uint32_t referenceReplicates = 128;

std::string refusal(const std::function<void()>& f) {
    try {
        f();
    } catch (const std::runtime_error& e) { return e.what(); }
    return {};
}

ReferenceFile blank(const Stage& stage) { return {stage.name, stage.camera.name, stage.scene->hash(), Design().size, 8, {}}; }
Reference rendered(const Stage& stage, const Paths& paths, Design d) {
    const judge::Replicates r = replicatesOf(stage, chooseIntegrator("path"), paths, d);
    Reference reference;
    reference.paths = paths;
    reference.integrator = "path";
    reference.version = CHIARO_VERSION;
    const char* commit = std::getenv("CHIARO_COMMIT");
    reference.commit = commit && *commit ? commit : "unknown";
    reference.firstSeed = d.firstSeed;
    reference.spp = d.spp;
    reference.replicates = d.replicates;
    reference.evidence = r.evidence(r.badTiles());
    return reference;
}

void compareWithOld(const Stage& stage, const ReferenceFile& made) {
    std::ifstream in(referencePath(stage.name), std::ios::binary);
    if (!in) return;
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const ReferenceFile old = referenceFromJson(text, referencePath(stage.name).string());
    for (const Reference& r : made.entries) {
        const Reference* before = old.find(r.paths);
        if (!before || before->evidence.tiles.size() != r.evidence.tiles.size()) continue;
        const judge::Agreement a = judge::decide(r.evidence, before->evidence, {});
        fmt::print("  new against old, all but {}: {}\n  z of the tiles:", r.paths.misses, judge::describe(a));
        for (const float z : a.tileZ) fmt::print(" {:+.1f}", z);
        fmt::print("\n");
    }
}

} // namespace

TEST_SUITE("references") {
    TEST_CASE("a reference is read as it was written") {
        const Stage stage("@cornell");
        ReferenceFile file = blank(stage);
        file.entries.push_back(rendered(stage, entrants()[0].paths, {32, 1, 3, 5, 1}));
        const ReferenceFile again = referenceFromJson(toJson(file), "x.json");
        CHECK(toJson(again) == toJson(file));
        const Reference &a = file.entries[0], *b = again.find(entrants()[0].paths);
        REQUIRE(b);
        CHECK(b->evidence.tiles.size() == 16);
        CHECK(b->evidence.tiles[5].mean == doctest::Approx(a.evidence.tiles[5].mean).epsilon(1e-6));
        CHECK(b->evidence.image[3].error == doctest::Approx(a.evidence.image[3].error).epsilon(1e-6));
        CHECK(b->evidence.image[0].dof == 2);
        CHECK(b->firstSeed == 5);
        CHECK(judge::decide(a.evidence, b->evidence, {}).image.p == doctest::Approx(1).epsilon(1e-3));
    }

    TEST_CASE("what does not fit is refused, with the command that makes it anew") {
        const Stage stage("@cornell"), other("@furnace");
        const ReferenceFile file = blank(stage);
        CHECK(refusal([&] { requireSameScene(file, stage); }).empty());
        std::string said[] = {
            refusal([&] { requireSameScene(file, other); }),
            refusal([&] { referenceFromJson("{\"format\": 1", "x.json"); }),
            refusal([&] { referenceFromJson("{\"format\": 99}", "x.json"); }),
            refusal([&] { referenceFromJson("{\"format\": 1, \"scene\": \"@cornell\", \"hash\": \"zz\"}", "x.json"); }),
        };
        for (const std::string& message : said) {
            CAPTURE(message);
            CHECK(message.find("sh tools/references.sh") != message.npos);
        }
        CHECK(said[0].find("another @furnace") != said[0].npos);
        CHECK(said[1].find("x.json") != said[1].npos);
    }

    TEST_CASE("the furnace's formula knows the paths") {
        CHECK(furnaceRadiance({"L (D|G|S)* E", ""}) == doctest::Approx(2));
        CHECK(furnaceRadiance({"L D? E", ""}) == doctest::Approx(1.5));
        CHECK(furnaceRadiance({"L (D|G|S)* E", "L E"}) == doctest::Approx(1));
        CHECK(furnaceRadiance({"L D D E", ""}) == doctest::Approx(0.25));
    }

    TEST_CASE("every built-in scene has a row, and rows know which paths are left") {
        for (const BuiltinScene& b : builtinScenes())
            CHECK(std::count_if(rows().begin(), rows().end(), [&](const Row& r) { return r.scene == b.name; }) > 0);
        const Entrant path(chooseIntegrator("path"));
        CHECK(Row{"@cornell", ""}.paths(path) == path.paths);
        CHECK(Row{"@cornell", "L E"}.paths(path)->misses == path.paths.misses + "|L E");
        CHECK_FALSE(Row{"@cornell", "L .* E"}.paths(path));
    }

    TEST_CASE("every scene has a reference of its present content, with provenance") {
        for (const BuiltinScene& b : builtinScenes()) {
            if (b.name == "@furnace") continue; // by formula
            const Stage stage(b.name);
            const ReferenceFile file = loadReference(stage);
            CHECK(file.scene == b.name);
            CHECK(std::filesystem::file_size(referencePath(b.name)) < 50'000);
            for (const Row& row : rows()) {
                if (row.scene != b.name) continue;
                for (const Entrant& e : entrants()) {
                    const std::optional<Paths> paths = row.paths(e);
                    if (!paths) continue;
                    CAPTURE(std::string(e.choice.entry->name));
                    const Reference* r = file.find(*paths);
                    REQUIRE(r);
                    CHECK(r->replicates >= 64);
                    CHECK(r->commit != "unknown");
                }
            }
        }
    }

    // Run by tools/references.sh only, of the scenes that CHIARO_SCENES names; empty: of all.
    TEST_CASE("make the references" * doctest::skip()) {
        Design d;
        d.replicates = referenceReplicates;
        d.firstSeed = referenceSeed;
        d.threads = 0;
        const char* chosen = std::getenv("CHIARO_SCENES");
        const std::string wanted = chosen && *chosen ? fmt::format(" {} ", chosen) : "";
        for (const BuiltinScene& b : builtinScenes()) {
            if (b.name == "@furnace" || (!wanted.empty() && wanted.find(fmt::format(" {} ", b.name)) == wanted.npos)) continue;
            const Stage stage(b.name);
            ReferenceFile file = blank(stage);
            for (const Row& row : rows())
                for (const Entrant& e : entrants())
                    if (const auto paths = row.paths(e); row.scene == b.name && paths && !file.find(*paths))
                        file.entries.push_back(rendered(stage, *paths, d));
            fmt::print("{}: {} sets of paths, {} x {} spp\n", b.name, file.entries.size(), d.replicates, d.spp);
            compareWithOld(stage, file);
            std::ofstream(referencePath(b.name), std::ios::binary) << toJson(file);
        }
    }
} // TEST_SUITE
