// Renders that are interrupted and go on: the same bits as without, whatever stopped them, wherever it did, with any number of threads.
#include "integrators/registry.h"
#include "io/checkpoint.h"
#include "tests/cli/resume_kit.h"
#include "tests/statistics.h"

using namespace chiaro;
using namespace program;
using resume::bytesOf;
using resume::Run;
using resume::samePixels;
using resume::throughFile;

namespace {

void checkInterrupted(const std::string& integrator, uint64_t seed) {
    CAPTURE(integrator);
    const Scene& scene = resume::sceneFor(integrator);
    const Folder folder;
    constexpr uint32_t samples = 13;
    const auto [whole, seconds] = [&] { // one executor at a time: the smallest would limit the others
        Run once(scene, integrator, 1);
        auto all = once.begin();
        const double taken = once.render(*all, samples).seconds;
        return std::pair(std::move(all), taken);
    }();
    stats::Random u(seed);
    std::unique_ptr<Film> film;
    std::string state;
    int cuts = 0;
    for (int i = 0; !film || film->done() < samples; ++i) {
        Run run(scene, integrator, 1 + unsigned(u() * 3));
        const bool resumed = film != nullptr;
        if (!film) film = run.begin();
        const bool stopped = i < 6; // the seventh goes to the end
        const uint32_t end = i % 3 == 2 ? std::min(samples, film->done() + 1 + uint32_t(u() * 3)) : samples;
        run.render(*film, end, stopped ? int(1e6 * seconds * double(u()) / 2) : -1, resumed ? &state : nullptr);
        cuts += film->done() < samples;
        state = run.state();
        film = throughFile(folder, *film, state);
    }
    MESSAGE(integrator << " was cut " << cuts << " times");
    CHECK(bytesOf(*film) == bytesOf(*whole));
}

int killsWanted() {
    const char* asked = std::getenv("CHIARO_KILLS");
    return asked ? std::atoi(asked) : 5;
}

} // namespace

TEST_SUITE("resume") {

    TEST_CASE("every integrator, cut at any moment, with any number of threads") {
        uint64_t seed = 1;
        for (const IntegratorEntry& e : integrators()) checkInterrupted(resume::small(e.name), ++seed);
        for (const char* more :
             {"sppm:count=2k,caustic-count=500,schedule=pixel", "whitted:aa=adaptive,aa-samples=12", "whitted:aa=jitter"})
            checkInterrupted(more, ++seed);
    }

    TEST_CASE("kill -9 at random moments, then --resume: same pixels ($CHIARO_KILLS: how often, 5 without)") {
        if (absent()) return;
        const Folder folder;
        const std::vector<std::string> scene = {"render", "@cornell-spheres", "--size", "48x30", "--split", "direct,indirect"};
        auto words = scene;
        words.insert(words.end(), {"--spp", "250", "-o", "whole.exr", "-q"});
        const auto begun = std::chrono::steady_clock::now();
        REQUIRE(run(folder, words).code == 0);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        stats::Random u(uint64_t(std::getenv("CHIARO_KILLS") ? time(nullptr) : 1));
        const int wanted = killsWanted();
        int kills = 0, resumed = 0;
        for (int again = 0; kills < wanted && again < 20 * wanted; ++again) {
            const bool there = fs::exists(folder / "cut.chk");
            auto first = scene;
            first.insert(first.end(), {"--spp", "250", "-o", "cut.exr", "-o", "cut.png", "--checkpoint-every", "20ms", "-q"});
            const std::vector<std::string> next = {"render", "@cornell-spheres", "--resume", "cut.chk", "-q"};
            Running running(folder, there ? next : first);
            resumed += there;
            // The first may die before there is anything to go on from; those after it die at a random moment behind the first checkpoint.
            if (kills > 0 && !there) running.awaitFile(folder / "cut.chk");
            usleep(useconds_t(1e6 * seconds * (0.05 + 0.5 * double(u()))));
            running.send(SIGKILL);
            const Outcome o = running.wait();
            if (o.code == 0) { // it was faster: from the beginning, with what was killed on the way behind it
                REQUIRE(samePixels(folder, "whole.exr", "cut.exr"));
                fs::remove(folder / "cut.chk");
                continue;
            }
            CHECK(o.code == 1000 + SIGKILL);
            ++kills;
            if (fs::exists(folder / "cut.chk")) CHECK_NOTHROW(readCheckpoint(folder / "cut.chk"));
            if (fs::exists(folder / "cut.exr")) CHECK_NOTHROW(readPicture(folder / "cut.exr"));
        }
        MESSAGE(kills << " times killed, " << resumed << " times resumed");
        CHECK(kills == wanted);
        CHECK(resumed > 0);
        if (fs::exists(folder / "cut.chk")) REQUIRE(run(folder, {"render", "@cornell-spheres", "--resume", "cut.chk", "-q"}).code == 0);
        CHECK(samePixels(folder, "whole.exr", "cut.exr"));
        CHECK(resume::sameRecipe(readPicture(folder / "whole.exr"), readPicture(folder / "cut.exr")));
        for (const auto& entry : fs::directory_iterator(folder.path()))
            CHECK_MESSAGE(!contains(entry.path().filename().string(), ".tmp"), entry.path().string(), " was left behind");
    }

    TEST_CASE("SIGTERM, then the command that is printed") {
        if (absent()) return;
        const Folder folder;
        const std::vector<std::string> scene = {"render", "@cornell", "--size", "32x32", "--seed", "3"};
        auto cut = scene;
        cut.insert(cut.end(), {"--spp", "1M", "-t", "1", "-o", "a cut.exr", "--progress", "json"});
        Running running(folder, cut);
        REQUIRE(running.awaitStderr("{\"progress\""));
        running.send(SIGTERM);
        const Outcome o = running.wait();
        CAPTURE(o.err);
        CHECK(o.code == 5);
        CHECK(contains(o.err, "/1000000 spp; wrote a cut.exr, a cut.chk. Continue: chiaro render @cornell --resume 'a cut.chk'"));
        CHECK(readPicture(folder / "a cut.exr").width == 32);
        // Beyond the pass that was cut, which is at most twice as long as the one before: some pixels have its samples.
        const std::string end = std::to_string(4 * readCheckpointHead(folder / "a cut.chk").done + 7);
        const Outcome go = run(folder, {"render", "@cornell", "--resume", "a cut.chk", "--spp", end, "-t", "2"});
        CAPTURE(go.err);
        CHECK(go.code == 0);
        CHECK(contains(go.err, "resume   a cut.chk"));
        CHECK(contains(go.err, "seed 3"));
        auto whole = scene;
        whole.insert(whole.end(), {"--spp", end, "-o", "whole.exr", "-q"});
        REQUIRE(run(folder, whole).code == 0);
        CHECK(samePixels(folder, "whole.exr", "a cut.exr"));
    }

    TEST_CASE("a checkpoint goes on with other budgets and pictures, not with other settings") {
        if (absent()) return;
        const Folder folder;
        const std::vector<std::string> common = {"render", "@cornell", "--size", "24x24", "-q"};
        const auto with = [&](std::vector<std::string> more) {
            auto words = common;
            words.insert(words.end(), more.begin(), more.end());
            return run(folder, words);
        };
        CHECK(with({"--spp", "8", "-o", "eight.exr", "-o", "some.chk"}).code == 0);
        CHECK(with({"--spp", "20", "-o", "twenty.exr"}).code == 0);
        CHECK(!fs::exists(folder / "twenty.chk")); // nothing interrupted it, nobody asked for one
        const auto go = [&](std::vector<std::string> more) {
            std::vector<std::string> words = {"render", "@cornell", "--resume", "some.chk"};
            words.insert(words.end(), more.begin(), more.end());
            return run(folder, words);
        };
        fs::remove(folder / "eight.exr");
        const std::string kept = readAll(folder / "some.chk");
        CHECK(go({"-q"}).code == 0); // nothing is left to do: the pictures again
        CHECK(fs::exists(folder / "eight.exr"));
        CHECK(readAll(folder / "some.chk") == kept);
        struct Case {
            std::vector<std::string> words;
            const char* part;
        };
        for (const Case& c : std::vector<Case>{{{"--seed", "1"}, "some.chk: rendered with --seed 0, not 1"},
                                               {{"--size", "25x24"}, "with --size 24x24, not 25x24"},
                                               {{"-i", "ao"}, "with -i path, not ao"},
                                               {{"--sampler", "independent"}, "with --sampler sobol, not independent"},
                                               {{"--max-depth", "3"}, "with --max-depth unlimited, not 3"},
                                               {{"--aov", "cost"}, "with --aov neither cost nor photons, not cost"},
                                               {{"--split", "bounces"}, "with --split none, not bounces"},
                                               {{"--camera", "auto"}, "with --camera \"main\""},
                                               {{"--env", "white"}, "another scene"}}) {
            const Outcome o = go(c.words);
            CAPTURE(o.err);
            CHECK(o.code == 3);
            CHECK(contains(o.err, c.part));
            CHECK(readAll(folder / "some.chk") == kept);
        }
        CHECK(contains(run(folder, {"render", "@furnace", "--resume", "some.chk"}).err, "another scene (@cornell"));
        CHECK(go({"--spp", "20", "-o", "more.exr", "-q", "-t", "3"}).code == 0);
        CHECK(samePixels(folder, "twenty.exr", "more.exr"));
        CHECK(readCheckpointHead(folder / "some.chk").done == 20);
    }

    TEST_CASE("what is no checkpoint, or a damaged one, is one clear error") {
        if (absent()) return;
        const Folder folder;
        CHECK(run(folder, {"render", "@cornell", "--size", "8x6", "--spp", "3", "-o", "a.chk", "-q"}).code == 0);
        const std::string good = readAll(folder / "a.chk");
        stats::Random u(5);
        const auto code = [&](const std::string& bytes) {
            folder.write("b.chk", bytes);
            try {
                readCheckpoint(folder / "b.chk");
            } catch (const Error& e) {
                CHECK(std::string(e.what()).find('\n') == std::string::npos);
                return e.code;
            }
            return Exit::done;
        };
        CHECK(code(good) == Exit::done);
        for (std::size_t length = 0; length < good.size(); length += 1 + length / 97) CHECK(code(good.substr(0, length)) == Exit::file);
        for (int i = 0; i < 400; ++i) {
            std::string bad = good;
            bad[u.next() % bad.size()] ^= char(1 << (u.next() & 7));
            CHECK(code(bad) == Exit::file);
        }
        CHECK(code(good + good.substr(21)) == Exit::file); // two in one
        for (const char* text : {"", "no", "chiaro checkpoint 1\n", "chiaro solution 1\n"}) {
            folder.write("b.chk", text);
            const Outcome o = run(folder, {"render", "@cornell", "--resume", "b.chk"});
            CAPTURE(o.err);
            CHECK(o.code == 4);
            CHECK(contains(o.err, "error: b.chk: "));
        }
        const Outcome near = run(folder, {"render", "@cornell", "--resume", "c.chk"});
        CHECK(near.code == 4);
        CHECK(contains(near.err, "no such file; similar here: "));
    }

} // TEST_SUITE
