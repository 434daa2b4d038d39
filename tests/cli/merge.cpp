// Ranges of samples that are rendered apart and merged: the bits of the render that was never cut; and all that must be refused.
#include "integrators/registry.h"
#include "io/checkpoint.h"
#include "tests/cli/resume_kit.h"
#include "tests/statistics.h"
#include <nlohmann/json.hpp>

using namespace chiaro;
using namespace program;
using resume::samePixels;

namespace {

using Words = std::vector<std::string>;

Words joined(Words a, const Words& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

// 0, some places between, `end`: so many ranges.
std::vector<uint32_t> randomCuts(stats::Random& u, std::size_t ranges, uint32_t end) {
    std::vector<uint32_t> cuts{0, end};
    while (cuts.size() < ranges + 1)
        if (const auto cut = uint32_t(1 + u.next() % (end - 1)); std::find(cuts.begin(), cuts.end(), cut) == cuts.end())
            cuts.push_back(cut);
    std::sort(cuts.begin(), cuts.end());
    return cuts;
}

// A checkpoint with another word in its key: as another build, machine or setting would have written it.
void rewrite(const fs::path& from, const fs::path& to, const std::string& name, const std::string& value) {
    Checkpoint c = readCheckpoint(from);
    for (auto& [n, v] : c.key)
        if (n == name) v = value;
    writeCheckpoint(to, c, *c.film, c.state);
}

} // namespace

TEST_SUITE("merge") {

    TEST_CASE("every integrator whose samples do not depend on earlier ones: seven ranges in any order are the whole") {
        const Folder folder;
        stats::Random u(11);
        for (const IntegratorEntry& e : integrators()) {
            const std::string name = resume::small(e.name);
            CAPTURE(name);
            const IntegratorChoice choice = chooseIntegrator(name);
            REQUIRE(choice.entry->traits(choice.options).mergeable);
            const Scene& scene = resume::sceneFor(name);
            const auto whole = [&] { // one executor at a time: the smallest would limit the others
                resume::Run once(scene, name, 2);
                auto all = once.begin();
                once.render(*all, 17);
                return all;
            }();
            const std::vector<uint32_t> cuts = randomCuts(u, 7, 17);
            std::vector<std::unique_ptr<Film>> parts;
            for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
                resume::Run run(scene, name, 1 + unsigned(i % 3));
                auto part = run.begin(cuts[i]);
                run.render(*part, cuts[i + 1]);
                std::string state = run.state();
                parts.push_back(resume::throughFile(folder, *part, state));
            }
            for (std::size_t i = parts.size(); i > 1; --i) std::swap(parts[i - 1], parts[u.next() % i]);
            for (std::size_t i = 1; i < parts.size(); ++i) parts[0]->merge(*parts[i]);
            CHECK(parts[0]->begin() == 0);
            CHECK(parts[0]->done() == 17);
            CHECK(parts[0]->even());
            CHECK(test::samePicture(*parts[0], *whole));
        }
    }

    TEST_CASE("chiaro merge: four and seven parts in any order give the pixels and the recipe of the render that was not cut") {
        if (absent()) return;
        const Folder folder;
        stats::Random u(12);
        struct Case {
            const char* integrator;
            std::size_t parts;
        };
        for (const Case& c : {Case{"path", 7}, {"light", 4}, {"sppm:count=2k,caustic-count=500", 4}}) {
            const Words common = {"render", "@cornell-spheres", "--size", "20x14", "-i", c.integrator, "-q"};
            CAPTURE(c.integrator);
            REQUIRE(run(folder, joined(common, {"--spp", "17", "-o", "whole.exr", "--exposure", "1"})).code == 0);
            const std::vector<uint32_t> cuts = randomCuts(u, c.parts, 17);
            Words parts;
            for (std::size_t i = 0; i < c.parts; ++i) {
                parts.push_back("p" + std::to_string(i) + ".chk");
                const std::string range = std::to_string(cuts[i]) + ":" + std::to_string(cuts[i + 1]);
                const Outcome o = run(folder, joined(common, {"--sample-range", range, "-o", parts.back()}));
                CAPTURE(o.err);
                REQUIRE(o.code == 0);
            }
            for (std::size_t i = c.parts; i > 1; --i) std::swap(parts[i - 1], parts[u.next() % i]);
            const Outcome o = run(folder, joined(joined({"merge"}, parts), {"-o", "merged.exr", "--exposure", "1", "-q"}));
            CAPTURE(o.err);
            CHECK(o.code == 0);
            CHECK(samePixels(folder, "whole.exr", "merged.exr"));
            CHECK(resume::sameRecipe(readPicture(folder / "whole.exr"), readPicture(folder / "merged.exr")));
        }
    }

    TEST_CASE("parts merge to parts: pictures, layers, costs, and a render that goes on from them") {
        if (absent()) return;
        const Folder folder;
        const Words common = {"render", "@cornell", "--size", "24x24", "--split", "bounces", "--max-depth", "4", "--aov", "all", "-q"};
        for (const char* range : {"0:3", "3:8", "8:12"})
            REQUIRE(run(folder, joined(common, {"--sample-range", range})).code == 0); // named by themselves
        CHECK(fs::exists(folder / "cornell.3-8.chk"));
        CHECK(!fs::exists(folder / "cornell.exr"));
        REQUIRE(run(folder, joined(common, {"--spp", "12", "-o", "whole.exr", "-o", "whole.png"})).code == 0);
        REQUIRE(run(folder, joined(common, {"--spp", "16", "-o", "sixteen.exr"})).code == 0);
        REQUIRE(run(folder, {"merge", "cornell.8-12.chk", "cornell.3-8.chk", "-o", "late.chk", "-q"}).code == 0);
        const Outcome o = run(folder, {"merge", "late.chk", "cornell.0-3.chk", "-o", "all.chk", "-o", "{scene}-{integrator}-{spp}.exr",
                                       "-o", "merged.png", "--json"});
        CAPTURE(o.err);
        REQUIRE(o.code == 0);
        CHECK(contains(o.err, "2 parts, samples 0:12 of @cornell"));
        const auto summary = nlohmann::json::parse(o.out);
        CHECK(summary["samples"] == nlohmann::json{0, 12});
        CHECK(summary["checkpoint"] == "all.chk");
        CHECK(samePixels(folder, "whole.exr", "cornell-path-12.exr"));
        CHECK(readPicture(folder / "merged.png").planes == readPicture(folder / "whole.png").planes);
        CHECK(fs::exists(folder / "merged.cost.rays.png"));
        REQUIRE(run(folder, {"render", "@cornell", "--resume", "all.chk", "--spp", "16", "-o", "on.exr", "-q"}).code == 0);
        CHECK(samePixels(folder, "sixteen.exr", "on.exr"));
        CHECK(run(folder, {"merge", "all.chk", "--aov", "none", "-o", "bare.exr", "-q"}).code == 0);
        CHECK(!readPicture(folder / "bare.exr").find("Z"));
    }

    TEST_CASE("what does not make one picture is refused, and says which parts and why") {
        if (absent()) return;
        const Folder folder;
        const auto part = [&](const char* file, const char* range, const Words& more = {}) {
            const Outcome o = run(folder, joined({"render", "@cornell", "--size", "8x8", "--sample-range", range, "-o", file, "-q"}, more));
            REQUIRE_MESSAGE(o.code == 0, o.err);
        };
        part("a.chk", "0:2");
        part("b.chk", "2:4");
        part("c.chk", "4:6");
        part("late.chk", "3:5");
        part("seed.chk", "2:4", {"--seed", "9"});
        part("size.chk", "2:4", {"--size", "9x8"});
        part("method.chk", "2:4", {"-i", "ao"});
        part("dark.chk", "2:4", {"--env", "white"});
        rewrite(folder / "b.chk", folder / "version.chk", "version", "9.9.9");
        rewrite(folder / "b.chk", folder / "isa.chk", "isa", "mmx");
        struct Case {
            Words files;
            const char* part;
        };
        for (const Case& c : std::vector<Case>{
                 {{"a.chk", "c.chk"}, "samples 2:4 are missing between a.chk (0:2) and c.chk (4:6). Render them: --sample-range 2:4"},
                 {{"b.chk", "c.chk"}, "samples 0:2 are missing before b.chk (2:4)"},
                 {{"late.chk", "b.chk", "a.chk"}, "b.chk (2:4) and late.chk (3:5) overlap: samples 3:4 are in both"},
                 {{"a.chk", "a.chk"}, "overlap: samples 0:2"},
                 {{"a.chk", "seed.chk"}, "a.chk and seed.chk do not belong together: the first was rendered with --seed 0, not 9"},
                 {{"a.chk", "size.chk"}, "with --size 8x8, not 9x8"},
                 {{"a.chk", "method.chk"}, "with -i path, not ao"},
                 {{"a.chk", "version.chk"}, "by chiaro "},
                 {{"a.chk", "dark.chk"}, "a.chk and dark.chk are of different scenes"}}) {
            const Outcome o = run(folder, joined(joined({"merge"}, c.files), {"-o", "no.exr"}));
            CAPTURE(o.err);
            CHECK(o.code == 3);
            CHECK(contains(o.err, c.part));
            CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
            CHECK(!fs::exists(folder / "no.exr"));
        }
        const Outcome isa = run(folder, {"merge", "a.chk", "isa.chk", "-o", "isa.exr", "-q"});
        CHECK(isa.code == 0);
        CHECK(contains(isa.err, "warning: a.chk was rendered with "));
        CHECK(run(folder, {"merge", "a.chk", "isa.chk", "-o", "isa.exr", "-q", "--strict"}).code == 1);
        CHECK(run(folder, {"merge", "a.chk", "gone.chk"}).code == 4);
        CHECK(run(folder, {"merge", "isa.exr"}).code == 4);
        CHECK(run(folder, {"merge"}).code == 64);
        for (const Words& usage : std::vector<Words>{{"--sample-range", "4"},
                                                     {"--sample-range", "4:4"},
                                                     {"--sample-range", "4:2"},
                                                     {"--sample-range", "a:b"},
                                                     {"--sample-range", "0:8", "--spp", "4"},
                                                     {"--sample-range", "0:8", "--noise", "2%"}})
            CHECK(run(folder, joined({"render", "@cornell"}, usage)).code == 64);
        for (const char* remembers : {"sppm:schedule=pixel", "whitted:aa=adaptive"}) {
            const Outcome o = run(folder, {"render", "@cornell", "-i", remembers, "--sample-range", "0:4"});
            CHECK(o.code == 3);
            CHECK(contains(o.err, "remembers what earlier samples found"));
        }
    }

    TEST_CASE("a part that was stopped is refused with the command that finishes it, and then fits") {
        if (absent()) return;
        const Folder folder;
        const Words common = {"render", "@cornell", "--size", "300x300", "-i", "path"};
        Running running(folder, joined(common, {"--sample-range", "4:4000", "-o", "a.chk", "--progress", "json"}));
        REQUIRE(running.awaitStderr("{\"progress\""));
        running.send(SIGINT);
        const Outcome o = running.wait();
        CAPTURE(o.err);
        REQUIRE(o.code == 5);
        CHECK(contains(o.err, " of 4:4000; wrote a.chk. Continue: chiaro render @cornell --resume a.chk"));
        const CheckpointHead head = readCheckpointHead(folder / "a.chk");
        CHECK(head.begin == 4);
        const Outcome refused = run(folder, {"merge", "a.chk", "-o", "b.chk"});
        if (!head.even) {
            CHECK(refused.code == 3);
            CHECK(contains(refused.err, "a.chk was stopped inside a pass"));
            CHECK(contains(refused.err, "Finish it: chiaro render @cornell --resume a.chk"));
        }
    }

} // TEST_SUITE
