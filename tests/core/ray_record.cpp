// The recorder of rays: what it has stored, asked again, gives the answers of the first time, bit by bit, for every kind of call.
#include "core/scene/ray_record.h"
#include "core/math/warp.h"
#include "core/render/executor.h"
#include "core/scene/accel.h"
#include "scenes/builtin.h"
#include "tests/scene_kit.h"
#include <array>
#include <doctest/doctest.h>

using namespace chiaro;

namespace {

Ray rayAt(uint64_t i) {
    const auto number = [&](uint64_t k) { return float(hashCombine(i, k) >> 40) * 0x1p-24f; };
    return {{4 * number(0) - 2, 4 * number(1) - 2, 4 * number(2) - 2}, 0, uniformSphere(Point2{number(3), number(4)}), infinity, 0};
}

// Every kind of call, with full and with partial packets.
void askEverything(const Scene& scene, uint64_t first) {
    RayPacket packet{};
    for (std::size_t k = 0; k < RayPacket::size; ++k) packet.set(k, rayAt(first + k));
    std::array<Hit, RayPacket::size> hits;
    std::array<uint8_t, RayPacket::size> stopped;
    scene.intersect(packet, hits, true);
    scene.intersect(packet, std::span(hits).first(5), false);
    scene.occluded(packet, std::span(stopped).first(11));
    scene.intersect(rayAt(first + 20));
    scene.firstSurface(rayAt(first + 21));
    scene.occluded(rayAt(first + 22));
}
constexpr std::array<uint64_t, rayCalls> raysOfEach = {16, 5, 1, 1, 11, 1}; // of askEverything, by call

RayAnswers replayed(const RayRecord& record, RayCall call) {
    RayAnswers all;
    for (const RayBlock* b : record.blocks(call)) all += Accel::replay(*b);
    return all;
}

std::unique_ptr<const Scene> room(bool seenThrough) {
    SceneDesc desc = findBuiltin("@cornell-spheres")->make();
    if (seenThrough)
        for (MaterialDesc& m : desc.materials) m.alphaMode = AlphaMode::blend, m.alpha = 0.6f;
    return test::compiled(std::move(desc));
}

} // namespace

TEST_SUITE("ray record") {
    TEST_CASE("asked again, every call has the same answers") {
        for (const bool seenThrough : {false, true}) { // with our filter for cut-out surfaces in it, which looks at the ray's identity
            CAPTURE(seenThrough);
            const auto scene = room(seenThrough);
            constexpr uint64_t rounds = 1000;
            for (const unsigned threads : {1u, 3u}) {
                const Executor run(threads);
                RayRecord record(1'000'000);
                record.start();
                run.chunks(
                    rounds, [&](uint64_t i) { askEverything(*scene, 100 * i); }, nullptr);
                record.stop();
                CHECK(record.whole());
                CHECK(record.rays() == rounds * 35);
                for (int c = 0; c < rayCalls; ++c) {
                    const RayCall call{uint8_t(c)};
                    CAPTURE(rayCallName(call));
                    const RayAnswers& told = record.answers(call);
                    CHECK(told.calls == rounds);
                    CHECK(told.rays == rounds * raysOfEach[std::size_t(c)]);
                    CHECK(told.hits > 0);
                    CHECK((told.distances > 0) == (call != RayCall::shadowWide && call != RayCall::shadowSingle));
                    CHECK(replayed(record, call) == told);
                    RayAnswers read;
                    for (const RayBlock* b : record.blocks(call)) read += Accel::readThrough(*b);
                    CHECK(read.rays == told.rays);
                    CHECK(read.hits == 0);
                }
            }
        }
    }

    TEST_CASE("the order of one thread is kept") {
        const auto scene = room(false);
        RayRecord record(100'000);
        record.start();
        for (uint64_t i = 0; i < 40'000; ++i) scene->intersect(rayAt(i));
        record.stop();
        uint64_t next = 0, wrong = 0;
        REQUIRE(record.blocks(RayCall::single).size() == 3);
        for (const RayBlock* b : record.blocks(RayCall::single))
            for (const SingleRay& r : b->single) wrong += r.ox != rayAt(next++).o.x;
        CHECK(wrong == 0);
        CHECK(next == 40'000);
    }

    TEST_CASE("beyond its room it counts on; rays that Embree never saw are not in it; off it is off") {
        const auto scene = room(false);
        RayRecord small(10);
        small.start();
        for (uint64_t i = 0; i < 50; ++i) scene->intersect(rayAt(i));
        scene->intersect(Ray{{0, 0, NAN}, 0, {0, 0, 1}, infinity, 0});
        scene->occluded(Ray{{0, 0, 0}, 0, {0, 0, NAN}, infinity, 0});
        small.stop();
        scene->intersect(rayAt(0));
        CHECK(small.rays() == 50);
        CHECK(!small.whole());
        CHECK(small.answers(RayCall::shadowSingle).rays == 0);
        CHECK(small.blocks(RayCall::single).size() == 1);
        RayRecord next(100); // by the same thread
        next.start();
        scene->intersect(rayAt(0));
        next.stop();
        CHECK(next.rays() == 1);
        CHECK(next.whole());
    }

    TEST_CASE("two scenes lie in blocks apart") {
        const auto a = room(false), b = test::compiled(findBuiltin("@cornell")->make());
        RayRecord record(1000);
        record.start();
        for (uint64_t i = 0; i < 20; ++i) (i % 2 ? *a : *b).intersect(rayAt(i));
        record.stop();
        CHECK(replayed(record, RayCall::single) == record.answers(RayCall::single));
    }
}
