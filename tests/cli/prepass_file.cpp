// Solved pre-passes on disk, and who is given what: one solution a key, whatever is wrong with a file said in one line.
#include "io/solution_file.h"
#include "scenes/builtin.h"
#include "tests/cli/prepass_kit.h"
#include "tests/cli/program.h"
#include "tests/scene_kit.h"

using namespace chiaro;
using namespace chiaro::cli;
using program::contains;

namespace {

Exit codeOf(FunctionRef<void()> f) {
    try {
        f();
    } catch (const Error& e) { return e.code; }
    return Exit::done;
}
std::string messageOf(FunctionRef<void()> f) {
    try {
        f();
    } catch (const Error& e) { return e.what(); }
    return {};
}

const SolutionKey keyA{{"scene", "@cornell"}, {"hash", "0123"}}, keyB{{"scene", "a room.gltf"}, {"hash", "4567"}};
void save(const std::filesystem::path& file, const SolutionKey& key, double seconds, std::vector<float> numbers) {
    addSolution(file, key, seconds, [&](Writer& w) { w.array(numbers); });
}

// All that a pre-pass is solved from, of the cornell box and another scene.
struct Bench {
    explicit Bench(const std::string& name = "@cornell") : request(fake::scene(name)), scene(test::compiled(findBuiltin(name)->make())) {}
    Work work(uint64_t seed = 0) { return {*scene, classes, {}, seed, SamplerKind::sobol, run, stop, progress, notes}; }
    SceneRequest request;
    std::unique_ptr<const Scene> scene;
    PathClasses classes;
    Executor run{1};
    StopToken stop;
    Progress progress;
    Diagnostics notes;
};

} // namespace

TEST_SUITE("prepass_file") {

    TEST_CASE("several solutions in a file come back as they were") {
        const program::Folder folder;
        const auto file = folder / "s.prepass";
        save(file, keyA, 1.25, {1, 2, 3});
        save(file, keyB, 0.1, {});
        const auto all = readSolutions(file);
        REQUIRE(all.size() == 2);
        CHECK(all[0].key == keyA);
        CHECK(all[1].key == keyB);
        CHECK(all[0].seconds == 1.25);
        CHECK(all[1].seconds == 0.1);
        std::vector<float> numbers;
        loadSolution(file, all[0], [&](Reader& r) { numbers = r.array<float>(); });
        CHECK(numbers == std::vector<float>{1, 2, 3});
        loadSolution(file, all[1], [&](Reader& r) { numbers = r.array<float>(); });
        CHECK(numbers.empty());
        CHECK(codeOf([&] { loadSolution(file, all[0], [](Reader&) {}); }) == Exit::file); // left over
        CHECK(codeOf([&] { loadSolution(file, all[1], [](Reader& r) { r.value<double>(), r.value<double>(); }); }) ==
              Exit::file); // too short
        CHECK(codeOf([&] { save(file, {{"two words", "x"}}, 1, {}); }) == Exit::internal);
        CHECK(codeOf([&] { save(file, {{"a", "x\ny"}}, 1, {}); }) == Exit::internal);
        CHECK(readSolutions(file).size() == 2);
    }

    TEST_CASE("every kind of damage is one clear error") {
        const program::Folder folder;
        const auto file = folder / "s.prepass";
        save(file, keyA, 1.25, {1, 2, 3});
        const std::string good = program::readAll(file);
        for (std::size_t length = 0; length < good.size(); ++length) {
            folder.write("s.prepass", good.substr(0, length));
            CAPTURE(length);
            CHECK(codeOf([&] { readSolutions(file); }) == Exit::file);
        }
        for (std::size_t at = 0; at < good.size(); ++at)
            for (const int bit : {0, 7}) {
                std::string bad = good;
                bad[at] = char(bad[at] ^ (1 << bit));
                folder.write("s.prepass", bad);
                CAPTURE(at);
                CHECK(codeOf([&] { readSolutions(file); }) == Exit::file);
            }
        folder.write("s.prepass", good + "x");
        CHECK(codeOf([&] { readSolutions(file); }) == Exit::file);
        folder.write("s.prepass", "a picture, perhaps, or a scene");
        CHECK(contains(messageOf([&] { readSolutions(file); }), "no file of solved pre-passes"));
        CHECK(codeOf([&] { save(file, keyB, 1, {}); }) == Exit::file); // what is no solution is not written over
        CHECK(program::readAll(file) == "a picture, perhaps, or a scene");
        CHECK(codeOf([&] { readSolutions(folder.path()); }) == Exit::file);
        CHECK(contains(messageOf([&] { readSolutions(folder / "s.prepas"); }), "similar here: s.prepass"));
    }

    TEST_CASE("solved once a key, and for every seed anew") {
        Bench b;
        PrepassSolver solver(fake::settings({}, "scale=2"), b.request);
        fake::solved = 0;
        const SolvedPrepass first = solver.solve(b.work(1)), again = solver.solve(b.work(1)), other = solver.solve(b.work(2));
        CHECK(fake::solved == 2);
        CHECK(first.field == again.field);
        CHECK(again.seconds == first.seconds);
        CHECK(first.seconds >= fake::solveSeconds);
        CHECK(fake::valueIn(first) == 2 * fake::valueOf(1));
        CHECK(fake::valueIn(other) == 2 * fake::valueOf(2));
        CHECK(first.facts.size() == 1);
        CHECK(first.facts[0].subject == "fake");
        CHECK(b.notes.warnings() == std::vector<std::string>{"the field is not real"});
        CHECK(b.notes.facts().empty());
        b.classes = PathClasses::make({.paths = "L D D E", .split = {}, .within = {}, .without = {}});
        solver.solve(b.work(2));
        CHECK(fake::solved == 3);
        b.stop.request();
        CHECK(!solver.solve(b.work(3)).field);
        CHECK(!PrepassSolver({}, b.request).solve(b.work()).field);
    }

    TEST_CASE("kept in a file: loaded where it fits, refused where it does not") {
        const program::Folder folder;
        const auto file = folder / "c.prepass";
        Bench b;
        fake::solved = fake::loaded = 0;
        const SolvedPrepass first = PrepassSolver(fake::settings(file), b.request).solve(b.work(1));
        CHECK(!first.loaded);
        REQUIRE(std::filesystem::exists(file));
        const SolvedPrepass second = PrepassSolver(fake::settings(file), b.request).solve(b.work(1));
        CHECK(second.loaded);
        CHECK(second.seconds == first.seconds);
        CHECK(fake::valueIn(second) == fake::valueIn(first));
        CHECK(fake::solved == 1);
        CHECK(fake::loaded == 1);

        const auto refused = [&](const PrepassSettings& s, Bench& bench, uint64_t seed) {
            return codeOf([&] { PrepassSolver(s, bench.request).solve(bench.work(seed)); }) == Exit::unsupported
                       ? messageOf([&] { PrepassSolver(s, bench.request).solve(bench.work(seed)); })
                       : std::string("taken");
        };
        CHECK(contains(refused(fake::settings(file), b, 2), "with --seed 1, not 2"));
        CHECK(contains(refused(fake::settings(file, "scale=3"), b, 1), "as --prepass fake, not fake:scale=3"));
        Bench spheres("@cornell-spheres");
        const std::string scene = refused(fake::settings(file), spheres, 1);
        CHECK(contains(scene, "solved for another scene (@cornell "));
        CHECK(contains(scene, "@cornell-spheres"));
        Bench later;
        later.request.frameTime = 0.5;
        CHECK(contains(refused(fake::settings(file), later, 1), "at --frame-time 0, not 0.5"));
        Bench renamed;
        renamed.request.operand = "./copy.gltf"; // the same content under another name
        CHECK(PrepassSolver(fake::settings(file), renamed.request).solve(renamed.work(1)).loaded);
        CHECK(fake::solved == 1);

        b.classes = PathClasses::make({.paths = "L D D E", .split = {}, .within = {}, .without = {}});
        CHECK(!PrepassSolver(fake::settings(file), b.request).solve(b.work(1)).loaded); // other light paths: added
        CHECK(readSolutions(file).size() == 2);
        CHECK(PrepassSolver(fake::settings(file), b.request).solve(b.work(1)).loaded);

        const std::string good = program::readAll(file);
        folder.write("c.prepass", good.substr(0, good.size() / 2));
        CHECK(codeOf([&] { PrepassSolver(fake::settings(file), b.request).solve(b.work(1)); }) == Exit::file);
        CHECK(codeOf([&] { PrepassSolver(fake::settings(file), b.request).checkFile(); }) == Exit::file);
        CHECK(codeOf([&] { PrepassSolver(fake::settings(folder / "none/c"), b.request).checkFile(); }) == Exit::file);
        b.stop.request();
        CHECK(!PrepassSolver(fake::settings(folder / "stopped"), b.request).solve(b.work(1)).field);
        CHECK(!std::filesystem::exists(folder / "stopped"));
    }

} // TEST_SUITE
