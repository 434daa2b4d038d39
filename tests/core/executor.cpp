// Parallel loops: every index and every pixel once, stop tokens, deadlines. Progress: a rest of time that is honest and never negative.
#include "core/render/executor.h"
#include "core/render/progress.h"
#include <cmath>
#include <doctest/doctest.h>
#include <vector>

using namespace chiaro;
using namespace std::chrono_literals;

namespace {

// How often each pixel of a picture of width x height is covered by the tiles of a rectangle.
std::vector<std::atomic<int>> covered(const Executor& run, Rect area, uint32_t width, uint32_t height) {
    std::vector<std::atomic<int>> count(std::size_t(width) * height);
    run.tiles(
        area,
        [&](Rect t) {
            CHECK(t.width() <= 16);
            CHECK(t.height() <= 16);
            for (uint32_t y = t.y0; y < t.y1; ++y)
                for (uint32_t x = t.x0; x < t.x1; ++x) count[std::size_t(y) * width + x].fetch_add(1);
        },
        nullptr);
    return count;
}

class Recorder : public Progress {
public:
    void render(const RenderStatus& s) noexcept override { seen.push_back(s); }
    std::vector<RenderStatus> seen;
};

} // namespace

TEST_SUITE("executor") {

    TEST_CASE("every index once, for any number of threads") {
        for (const unsigned threads : {1u, 2u, 5u}) {
            const Executor run(threads);
            CHECK(run.threads() == threads);
            for (const uint64_t n : {uint64_t(0), uint64_t(1), uint64_t(3), uint64_t(10'000)}) {
                std::vector<std::atomic<int>> count(n);
                CHECK(run.chunks(
                    n, [&](uint64_t i) { count[i].fetch_add(1); }, nullptr));
                int wrong = 0;
                for (const auto& c : count) wrong += c.load() != 1;
                CHECK(wrong == 0);
            }
        }
        CHECK(Executor().threads() >= 1);
    }

    TEST_CASE("tiles cover any rectangle exactly once, long and thin ones too") {
        const Rect areas[] = {{0, 0, 1, 1},     {0, 0, 16, 16},   {0, 0, 17, 16},  {5, 7, 70, 41}, {0, 0, 0, 0},     {10, 10, 10, 20},
                              {99, 0, 100, 50}, {0, 49, 100, 50}, {0, 0, 100, 50}, {3, 3, 83, 4},  {16, 16, 48, 32}, {1, 0, 33, 50}};
        for (const unsigned threads : {1u, 5u}) {
            const Executor run(threads);
            for (const Rect& area : areas) {
                const auto count = covered(run, area, 100, 50);
                int wrong = 0;
                for (uint32_t y = 0; y < 50; ++y)
                    for (uint32_t x = 0; x < 100; ++x) {
                        const bool inside = x >= area.x0 && x < area.x1 && y >= area.y0 && y < area.y1;
                        wrong += count[std::size_t(y) * 100 + x].load() != (inside ? 1 : 0);
                    }
                CAPTURE(area.x0);
                CAPTURE(area.y1);
                CHECK(wrong == 0);
            }
        }
        std::atomic<uint64_t> pixels{0};
        Executor(1).tiles(
            {0, 0, 16, 4'000'000}, [&](Rect t) { pixels += t.area(); }, nullptr);
        CHECK(pixels == 64'000'000);
    }

    TEST_CASE("tiles of one thread come in Morton order") {
        std::vector<Rect> order;
        Executor(1).tiles(
            {0, 0, 64, 64}, [&](Rect t) { order.push_back(t); }, nullptr);
        REQUIRE(order.size() == 16);
        const uint32_t expected[][2] = {{0, 0}, {16, 0}, {0, 16}, {16, 16}, {32, 0}, {48, 0}};
        for (std::size_t i = 0; i < 6; ++i) {
            CHECK(order[i].x0 == expected[i][0]);
            CHECK(order[i].y0 == expected[i][1]);
        }
    }

    TEST_CASE("a stop skips what has not begun and is reported") {
        for (const unsigned threads : {1u, 2u, 5u}) {
            const Executor run(threads);
            StopToken stop;
            std::atomic<int> done{0};
            const auto work = [&](uint64_t) {
                if (done.fetch_add(1) == 10) stop.request();
            };
            CHECK(!run.chunks(100'000, work, &stop));
            CHECK(done < 1000);
            CHECK(stop.requested());
            CHECK(stop.cancelled());
            done = 100;
            CHECK(!run.chunks(10, work, &stop));
            CHECK(done == 100);
            CHECK(run.chunks(10, work, nullptr)); // without a token: to the end
            CHECK(done == 110);
        }
    }

    TEST_CASE("a deadline stops like a request, but nobody cancelled") {
        StopToken stop;
        CHECK(!stop.requested());
        stop.setDeadline(StopToken::Clock::now() + 1h);
        CHECK(!stop.requested());
        stop.setDeadline(StopToken::Clock::now() - 1ms);
        CHECK(stop.requested());
        CHECK(stop.expired());
        CHECK(!stop.cancelled());
        std::atomic<int> done{0};
        CHECK(!Executor(2).chunks(
            100, [&](uint64_t) { ++done; }, &stop));
        CHECK(done == 0);
        stop.setDeadline(StopToken::Clock::time_point::max());
        CHECK(!stop.requested());
    }
}

TEST_SUITE("progress") {

    TEST_CASE("the rest of the time follows the work, is never negative, and falls under steady work") {
        // A render of 100 samples a pixel, one second each: the clock is moved back instead of waiting.
        double last = infinity;
        for (uint32_t done = 0; done <= 100; done += 5) {
            Recorder p;
            p.beginPass(
                {Progress::Clock::now() - std::chrono::seconds(done), double(infinity), 0, 100, done, std::min(done + 5, 100u), 0.1});
            REQUIRE(p.seen.size() == 1);
            const RenderStatus& s = p.seen[0];
            CHECK(s.spp == done);
            CHECK(s.sppTarget == 100);
            CHECK(s.noise == 0.1);
            if (done == 0) {
                CHECK(s.secondsLeft < 0); // not known
                continue;
            }
            CHECK(s.secondsLeft == doctest::Approx(100.0 - done).epsilon(0.02));
            CHECK(s.secondsLeft >= 0);
            CHECK(s.secondsLeft <= last);
            last = s.secondsLeft;
        }
    }

    TEST_CASE("a time budget bounds the rest, also before the first sample, and never below zero") {
        const struct {
            double elapsed, budget;
            uint32_t done, target;
            double left;
        } cases[] = {{0, 30, 0, 0, 30},     {10, 30, 5, 0, 20},    {40, 30, 5, 0, 0},
                     {10, 30, 50, 100, 10}, {10, 30, 10, 100, 20}, {50, 30, 99, 100, 0}};
        for (const auto& k : cases) {
            Recorder p;
            p.beginPass(
                {Progress::Clock::now() - std::chrono::milliseconds(int(k.elapsed * 1000)), k.budget, 0, k.target, k.done, k.done + 1, 0});
            CHECK(p.seen[0].secondsLeft == doctest::Approx(k.left).epsilon(0.02));
            CHECK(p.seen[0].secondsLeft >= 0);
        }
    }

    TEST_CASE("a resumed render counts its own samples; a part of a pass counts as a part") {
        Recorder p;
        p.beginPass({Progress::Clock::now() - 10s, double(infinity), 60, 100, 80, 100, 0}); // 20 samples in 10 s
        CHECK(p.seen[0].secondsLeft == doctest::Approx(10).epsilon(0.02));
        for (int i = 0; i < 4; ++i) p.advance(0.125);
        const auto shown = std::chrono::steady_clock::now();
        while (std::chrono::steady_clock::now() - shown < 120ms) p.advance(0); // reports are at least 100 ms apart
        REQUIRE(p.seen.size() >= 2);
        CHECK(p.seen[1].samples == doctest::Approx(90));
        CHECK(p.seen[1].spp == 80);
        CHECK(p.seen[1].secondsLeft == doctest::Approx(10.1 / 3).epsilon(0.05));
        p.advance(10); // more than all of it
        while (std::chrono::steady_clock::now() - shown < 250ms) p.advance(0);
        CHECK(p.seen.back().samples == 100);
        CHECK(p.seen.back().secondsLeft == 0);
    }
}
