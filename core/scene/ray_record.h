// RayRecord: the rays of a render as they went to Embree, call by call, so that they can be asked again without the render
// (Accel::replay). What Embree alone takes for them, over what the render took, is the share of the render that no code of ours can save.
// Off, a record costs one well-predicted branch a call; on, every thread writes into blocks of its own.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace chiaro {

class Accel;

// The calls that Accel makes; each is asked again by the same one.
enum class RayCall : uint8_t { coherent, wide, single, surface, shadowWide, shadowSingle };
inline constexpr int rayCalls = 6;
std::string_view rayCallName(RayCall) noexcept; // "camera, 16 coherent"
constexpr bool isWide(RayCall c) noexcept { return c == RayCall::coherent || c == RayCall::wide || c == RayCall::shadowWide; }

// What calls asked and were told. distances: the sum of the bits of all distances, modulo 2^64, so that it does not depend on the order.
struct RayAnswers {
    uint64_t calls = 0, rays = 0, hits = 0, distances = 0; // hits of shadow rays: those that are stopped
    RayAnswers& operator+=(const RayAnswers& o) noexcept {
        calls += o.calls, rays += o.rays, hits += o.hits, distances += o.distances;
        return *this;
    }
    friend bool operator==(const RayAnswers&, const RayAnswers&) = default;
};

// As Embree takes them: the time is a share of the shutter, id feeds the filter of cut-out geometry.
struct SingleRay {
    float ox, oy, oz, tnear, dx, dy, dz, tfar, time;
    uint32_t id;
};
struct alignas(64) WideRays {
    static constexpr std::size_t size = 16;
    float ox[size], oy[size], oz[size], tnear[size], dx[size], dy[size], dz[size], time[size], tfar[size];
    uint32_t id[size];
    int valid[size]; // -1: asked
};
// Consecutive calls of one kind by one thread.
struct RayBlock {
    static constexpr std::size_t mostRays = 16384;
    const Accel* accel = nullptr;
    RayCall call = RayCall::single;
    uint64_t order = 0; // of blocks, as they were begun
    std::vector<SingleRay> single;
    std::vector<WideRays> wide;
};

class RayRecord {
public:
    // most: rays that are stored; all are counted.
    explicit RayRecord(uint64_t most);
    ~RayRecord();
    // All rays of the process between the two, of whatever thread; one record at a time. Nothing may be tracing at either moment.
    void start();
    void stop();
    // After stop():
    bool whole() const noexcept { return counted_ <= most_; }                                             // every ray was stored
    const RayAnswers& answers(RayCall c) const noexcept { return answers_[std::size_t(c)]; }              // as the render got them
    std::span<const RayBlock* const> blocks(RayCall c) const noexcept { return blocks_[std::size_t(c)]; } // in the order of the render
    uint64_t rays() const noexcept { return counted_; }

    // For Accel:
    static bool on() noexcept { return current.load(std::memory_order_relaxed) != nullptr; }
    static void add(const Accel*, RayCall, const SingleRay&, bool hit, float t);
    static void add(const Accel*, RayCall, const WideRays&, const RayAnswers&);

private:
    struct Log;
    static inline std::atomic<RayRecord*> current{nullptr};
    Log& log();
    uint64_t most_, serial_, counted_ = 0;
    std::atomic<uint64_t> stored_{0}, order_{0};
    struct Logs;
    std::unique_ptr<Logs> logs_;
    RayAnswers answers_[rayCalls];
    std::vector<const RayBlock*> blocks_[rayCalls];
};

} // namespace chiaro
