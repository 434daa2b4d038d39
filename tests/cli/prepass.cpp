// Pre-passes in the commands: who takes one, what it covers, what it costs whom; and the real ones as a user asks for them.
#include "io/picture.h"
#include "scenes/builtin.h"
#include "tests/cli/prepass_kit.h"
#include "tests/cli/program.h"
#include "tests/scene_kit.h"
#include "tools/cli/agree_settings.h"
#include "tools/cli/agree_stage.h"
#include "tools/cli/compare_run.h"
#include "tools/cli/integrator_list.h"
#include "tools/cli/unseen_paths.h"
#include <nlohmann/json.hpp>

using namespace chiaro;
using namespace chiaro::cli;
using program::contains, program::absent, program::Folder, program::run, program::Outcome;
using Json = nlohmann::json;

namespace {

CameraDesc firstCamera(const Scene& scene) { return scene.cameras()[0]; }

// The cornell box at 12 x 12, ready for contests and stages.
struct Small {
    Small() : scene(test::compiled(findBuiltin("@cornell")->make())) {
        view.camera = Camera(firstCamera(*scene), 12, 12, {});
        view.width = view.height = 12;
        view.crop = {0, 0, 12, 12};
        settings.equal = Equal::spp;
        settings.spp = 4;
        settings.seeds = 2;
    }
    Job job() { return {{*scene, classes, {}, 0, SamplerKind::sobol, run, stop, progress, notes}, view, nullptr}; }
    std::unique_ptr<const Scene> scene;
    View view;
    PathClasses classes;
    Executor run{2};
    StopToken stop;
    Progress progress;
    Diagnostics notes;
    CompareSettings settings;
};
std::vector<Contestant> contested(Small& s, PrepassSolver& solver, const std::string& list) {
    std::vector<Contestant> all;
    for (const IntegratorChoice& c : chooseIntegrators(list)) all.emplace_back(c, s.classes, s.view, solver.choice());
    const Job job = s.job();
    Contest contest(s.settings, job, s.stop, all, solver);
    Course course(s.progress, 1, true);
    contest.run(course, {});
    return all;
}
double meanOf(const Contestant& c) { return c.film->meanLuminance().value; }

// Those of the registry.
std::vector<std::string> registered() {
    std::vector<std::string> all;
    for (const PrepassEntry& e : prepasses()) all.emplace_back(e.name);
    if (all.empty()) std::cout << "SKIPPED: the registry has no pre-pass\n";
    return all;
}
std::vector<float> beauty(const Folder& folder, const std::string& file) {
    const chiaro::Picture p = readPicture(folder / file);
    std::vector<float> all;
    for (const char* c : {"R", "G", "B"}) all.insert(all.end(), p.find(c)->begin(), p.find(c)->end());
    return all;
}

} // namespace

TEST_SUITE("prepass") {

    TEST_CASE("who takes one, and what it is called") {
        const PrepassSettings s = fake::settings({}, "scale=3");
        const auto all = chooseIntegrators("whitted,path,distributed");
        CHECK(takesPrepass(all[0]));
        CHECK(!takesPrepass(all[1]));
        CHECK(takersText(all) == "whitted, distributed; path takes none");
        CHECK(nameWith(all[0], s.get()) == "whitted + fake:scale=3");
        CHECK(nameWith(all[1], s.get()) == "path");
        CHECK(fileName(all[0], s.get()) == "whitted+fake-scale-3");
        CHECK(!traitsWith(all[2], s.get()).unbiased);
        CHECK(traitsWith(all[2], nullptr).unbiased);
        CHECK(contains(traitsWith(all[0], s.get()).covers, "(L (D|G|S)+ D)"));
        CHECK(traitsWith(all[1], s.get()).covers == traitsWith(all[1], nullptr).covers);
        requireTaker(s, all);
        try {
            requireTaker(s, {all[1]});
            CHECK(false);
        } catch (const Error& e) {
            CHECK(e.code == Exit::unsupported);
            CHECK(contains(e.what(), "path takes no pre-pass"));
        }
    }

    TEST_CASE("what it shows is covered, and no longer missing") {
        const auto box = test::compiled(findBuiltin("@cornell")->make());
        const PrepassSettings s = fake::settings();
        const IntegratorChoice whitted = chooseIntegrator("whitted:area=sample"), path = chooseIntegrator("path");
        CHECK(contains(unseenPaths(*box, whitted, {}).value_or(""), "La D D E"));
        CHECK(!contains(unseenPaths(*box, whitted, {}, s.get()).value_or(""), "La D D E"));
        CHECK(howJudged(whitted, *box, {}).missing == "La D D E");
        const Judged judged = howJudged(whitted, *box, {}, s.get());
        CHECK(contains(judged.covers, "L (D|G|S)+ D"));
        CHECK(judged.missing != "La D D E");
        const auto subjects = makeSubjects({whitted, path}, {}, true, s.get());
        CHECK(subjects[0].name == "whitted:area=sample + fake");
        CHECK(contains(subjects[0].judgedOn, "L (D|G|S)+ D"));
        CHECK(!subjects[0].traits.unbiased);
        CHECK(subjects[1].name == "path");
        CHECK(subjects[1].traits.unbiased);
    }

    TEST_CASE("agree looks at the limit of a field that converges") {
        const PrepassChoice field = choosePrepass("radiosity:patches=500");
        const auto subjects = makeSubjects(chooseIntegrators("whitted,path"), {}, true, &field);
        REQUIRE(subjects[0].levels.size() == 3);
        CHECK(subjects[0].traits.convergesOver == "patches");
        CHECK(subjects[0].parameter == std::vector<double>{500, 1000, 2000});
        REQUIRE(subjects[0].fields.size() == 3);
        CHECK(prepassRecipe(subjects[0].fields[2]) == "radiosity"); // 2,000 is the default
        CHECK(!subjects[0].paired);
        CHECK(!subjects[1].converging());
        const PrepassChoice sized = choosePrepass("radiosity:size=.2");
        CHECK(makeSubjects(chooseIntegrators("distributed"), {}, true, &sized)[0].traits.convergesOver == "size");
        // One solution from a file has no limit.
        CHECK(!makeSubjects(chooseIntegrators("whitted"), {}, true, &field, true)[0].converging());
    }

    TEST_CASE("a contest solves it for every seed, and bills it to each who uses it") {
        Small s;
        PrepassSolver solver(fake::settings(), fake::scene("@cornell"));
        fake::solved = 0;
        const auto all = contested(s, solver, "whitted,path,distributed");
        CHECK(fake::solved == 2); // two seeds; the two that use it share it
        for (const std::size_t i : {0u, 2u}) {
            CHECK(all[i].prepassSeconds() >= 2 * fake::solveSeconds);
            CHECK(all[i].seconds() > all[i].prepassSeconds());
            REQUIRE(all[i].facts.size() >= 1);
            CHECK(all[i].facts[0].subject == "fake");
        }
        CHECK(all[1].facts.empty());
        CHECK(all[1].prepassSeconds() == 0);
        CHECK(s.notes.warnings() == std::vector<std::string>{"the field is not real"});
        PrepassSolver none({}, fake::scene("@cornell"));
        const auto alone = contested(s, none, "whitted,path,distributed");
        CHECK(meanOf(all[2]) > meanOf(alone[2]) + 0.1);
        CHECK(meanOf(all[1]) == meanOf(alone[1]));
        CHECK(alone[0].facts.empty());
    }

    TEST_CASE("one that is kept serves all seeds, and is billed once") {
        const Folder folder;
        Small s;
        PrepassSolver solver(fake::settings(folder / "c"), fake::scene("@cornell"));
        fake::solved = 0;
        const auto all = contested(s, solver, "whitted,distributed");
        CHECK(fake::solved == 1);
        // As if it had taken a hundred seconds: each is billed that, once, whatever his seeds.
        const auto stored = readSolutions(folder / "c").front();
        addSolution(folder / "d", stored.key, 100, [](Writer& w) { w.value(fake::valueOf(0)); });
        PrepassSolver again(fake::settings(folder / "d"), fake::scene("@cornell"));
        const auto later = contested(s, again, "whitted,distributed");
        CHECK(fake::solved == 1);
        CHECK(meanOf(later[1]) == meanOf(all[1]));
        for (const Contestant& c : later) {
            CHECK(c.prepassSeconds() >= 100);
            CHECK(c.prepassSeconds() < 150);
            CHECK(c.seconds() >= c.prepassSeconds());
        }
    }

    TEST_CASE("equal time counts it, and so does the choice of seeds") {
        const Folder folder;
        Small s;
        s.settings.equal = Equal::time;
        s.settings.seconds = 20;
        s.settings.seeds.reset();
        PrepassSolver(fake::settings(folder / "c"), fake::scene("@cornell")).solve(s.job());
        const auto stored = readSolutions(folder / "c").front();
        addSolution(folder / "d", stored.key, 100, [](Writer& w) { w.value(1.f); });
        PrepassSolver solver(fake::settings(folder / "d"), fake::scene("@cornell"));
        std::vector<Contestant> all;
        all.emplace_back(chooseIntegrator("whitted"), s.classes, s.view, solver.choice());
        const Job job = s.job();
        Contest contest(s.settings, job, s.stop, all, solver);
        contest.pilot();
        CHECK(all[0].sharedPrepass == 100);
        CHECK(contest.chooseSeeds(s.notes) == 2); // as few as there may be
        CHECK(contains(s.notes.warnings().back(), "its pre-pass included"));
        Course course(s.progress, 1, false);
        contest.run(course, {});
        CHECK(all[0].spp() == 2); // no time was left for more than one sample of each seed
        CHECK(all[0].prepassSeconds() >= 100);
    }

    TEST_CASE("agree solves it for every replicate") {
        Small s;
        PrepassSolver solver(fake::settings(), fake::scene("@cornell"));
        auto subjects = makeSubjects(chooseIntegrators("distributed,path:mis=off"), {}, true, solver.choice());
        subjects[0].prepass = &solver;
        fake::solved = 0;
        const Stage stage =
            renderStage(s.job(), s.stop, subjects, {.number = 1, .replicates = 3, .spp = 1, .takesPart = {true, true}}, s.progress);
        CHECK(stage.rounds == 3);
        CHECK(fake::solved == 3);
        CHECK(stage.trials[0].seconds() >= 3 * fake::solveSeconds);
    }

    TEST_CASE("amounts of memory") {
        CHECK(parseMemory("max-memory", "500M") == 500'000'000);
        CHECK(parseMemory("max-memory", "32G") == 32'000'000'000);
        CHECK(parseMemory("max-memory", "1.5GB") == 1'500'000'000);
        for (const char* bad : {"", "G", "-1G", "32X", "1k", "lots", "1e9T", "nan"}) CHECK_THROWS_AS(parseMemory("max-memory", bad), Error);
    }

} // TEST_SUITE

TEST_SUITE("prepass_program") {

    TEST_CASE("wrong input is one line") {
        if (absent()) return;
        const Folder folder;
        const auto check = [&](std::vector<std::string> words, int code, const std::string& text) {
            const Outcome o = run(folder, words);
            CAPTURE(o.err);
            CHECK(o.code == code);
            CHECK(contains(o.err, text));
            CHECK(std::count(o.err.begin(), o.err.end(), '\n') <= 4);
        };
        check({"render", "@furnace", "--prepass", "nonsense"}, 64, "no pre-pass \"nonsense\"");
        check({"render", "@furnace", "-i", "whitted", "--prepass-file", "none.prepass"}, 64, "there is nothing in it yet");
        check({"render", "@furnace", "-i", "whitted", "--max-memory", "few"}, 64, "--max-memory");
        check({"render", "@furnace", "--size", "4000x4000", "--max-memory", "50M"}, 6, "--max-memory is 50 MB");
        folder.write("text.prepass", "text");
        check({"render", "@furnace", "-i", "whitted", "--prepass-file", "text.prepass"}, 4, "no file of solved pre-passes");
        check({"help", "prepas"}, 64, "did you mean prepass?");
        CHECK(contains(run(folder, {"help", "prepass"}).out, "--prepass-file"));
    }

    TEST_CASE("the real ones: solved, kept, loaded, refused") {
        if (absent()) return;
        for (const std::string& recipe : registered()) {
            CAPTURE(recipe);
            const Folder folder;
            const auto render = [&](std::vector<std::string> words, const std::string& out, const std::string& scene = "@cornell") {
                words.insert(words.begin(), {"render", scene, "-i", "distributed", "--size", "24x24", "--spp", "2", "-o", out});
                return run(folder, words);
            };
            const Outcome first = render({"--prepass", recipe, "--prepass-file", "c.prepass"}, "a.exr");
            CAPTURE(first.err);
            REQUIRE(first.code == 0);
            CHECK(contains(first.err, "kept in c.prepass"));
            CHECK(!contains(first.err, "La D D E"));
            const Outcome second = render({"--prepass-file", "c.prepass", "--json", "-c", "auto"}, "b.exr");
            CAPTURE(second.err);
            REQUIRE(second.code == 0);
            CHECK(contains(second.err, "loaded from c.prepass"));
            CHECK(Json::parse(second.out)["prepass"] == recipe);
            const Outcome same = render({"--prepass-file", "c.prepass"}, "c.exr"), fresh = render({"--prepass", recipe}, "d.exr");
            REQUIRE(same.code == 0);
            REQUIRE(fresh.code == 0);
            CHECK(beauty(folder, "a.exr") == beauty(folder, "c.exr"));
            CHECK(beauty(folder, "a.exr") == beauty(folder, "d.exr"));
            CHECK(readPicture(folder / "a.exr").attribute("chiaro:prepass"));
            const Outcome none = render({}, "e.exr");
            REQUIRE(none.code == 0);
            CHECK(contains(none.err, "La D D E"));
            const Outcome seed = render({"--prepass", recipe, "--prepass-file", "c.prepass", "--seed", "3"}, "f.exr");
            CHECK(seed.code == 3);
            CHECK(contains(seed.err, "--seed 0, not 3"));
            const Outcome scene = render({"--prepass-file", "c.prepass"}, "f.exr", "@cornell-spheres");
            CHECK(scene.code == 3);
            CHECK(contains(scene.err, "solved for another scene"));
            const Outcome path = run(folder, {"render", "@cornell", "-i", "path", "--prepass", recipe});
            CHECK(path.code == 3);
            CHECK(contains(path.err, "path takes no pre-pass"));
            const Outcome one = run(folder, {"render", "@cornell", "-i", "distributed", "--size", "24x24", "--prepass-file", "c.prepass",
                                             "--pixel", "12,12", "--sample", "1"});
            const Outcome trace = run(folder, {"trace", "@cornell", "-i", "distributed,path", "--size", "24x24", "--prepass-file",
                                               "c.prepass", "--pixel", "12,12", "--sample", "1"});
            CAPTURE(trace.err);
            REQUIRE(one.code == 0);
            REQUIRE(trace.code == 0);
            CHECK(contains(trace.out, "distributed + " + recipe));
            CHECK(contains(trace.out, one.out.substr(0, one.out.find(' '))));
        }
    }

    TEST_CASE("the real ones in compare and agree") {
        if (absent()) return;
        for (const std::string& recipe : registered()) {
            CAPTURE(recipe);
            const Folder folder;
            const Outcome o = run(folder, {"compare", "@cornell", "-i", "distributed,path", "--prepass", recipe, "--size", "16x16", "--spp",
                                           "8", "--seeds", "2", "--ref", "none", "-o", "out", "--progress", "none"});
            CAPTURE(o.err);
            REQUIRE(o.code == 0);
            CHECK(contains(o.err, "for distributed; path takes none"));
            const Json j = Json::parse(program::readAll(folder / "out" / "results.json"));
            CHECK(j["entries"][0]["name"] == "distributed + " + recipe);
            CHECK(j["entries"][0]["prepassSeconds"].get<double>() > 0);
            CHECK(j["entries"][1]["prepassSeconds"] == 0); // path takes no field, whatever it prepares itself
            CHECK(contains(j["entries"][0]["render"].get<std::string>(), "--prepass " + recipe));
            CHECK(!contains(j["entries"][1]["render"].get<std::string>(), "--prepass"));
            CHECK(std::filesystem::exists(folder / "out" / ("distributed+" + recipe + ".exr")));
            const Outcome alone = run(folder, {"compare", "@cornell", "-i", "path", "--prepass", recipe});
            CHECK(alone.code == 3);
        }
    }

} // TEST_SUITE
