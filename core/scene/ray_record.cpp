#include "core/scene/ray_record.h"
#include <algorithm>
#include <array>
#include <bit>
#include <deque>
#include <mutex>

namespace chiaro {

std::string_view rayCallName(RayCall c) noexcept {
    static constexpr std::array<std::string_view, rayCalls> names = {"camera, 16 coherent",   "closest, 16 wide", "closest, single",
                                                                     "first surface, single", "shadow, 16 wide",  "shadow, single"};
    return names[std::size_t(c)];
}

// What one thread has written.
struct RayRecord::Log {
    RayAnswers answers[rayCalls];
    RayBlock* open[rayCalls] = {};
    std::deque<RayBlock> blocks;

    RayBlock* room(RayRecord& record, const Accel* accel, RayCall call, std::size_t rays) {
        if (record.stored_.fetch_add(rays, std::memory_order_relaxed) + rays > record.most_) return nullptr;
        RayBlock*& b = open[std::size_t(call)];
        const bool wide = isWide(call);
        if (!b || b->accel != accel || (wide ? b->wide.size() == b->wide.capacity() : b->single.size() == b->single.capacity())) {
            b = &blocks.emplace_back();
            b->accel = accel;
            b->call = call;
            b->order = record.order_.fetch_add(1);
            wide ? b->wide.reserve(RayBlock::mostRays / WideRays::size) : b->single.reserve(RayBlock::mostRays);
        }
        return b;
    }
};
struct RayRecord::Logs {
    std::mutex mutex;
    std::deque<Log> all;
};

namespace {
std::atomic<uint64_t> serials{0};
}

RayRecord::RayRecord(uint64_t most) : most_(most), serial_(serials.fetch_add(1) + 1), logs_(std::make_unique<Logs>()) {}
RayRecord::~RayRecord() { current.store(nullptr); }

void RayRecord::start() { current.store(this); }

void RayRecord::stop() {
    current.store(nullptr);
    counted_ = 0;
    for (int c = 0; c < rayCalls; ++c) {
        answers_[c] = {};
        blocks_[c].clear();
        for (const Log& log : logs_->all) answers_[c] += log.answers[c];
        counted_ += answers_[c].rays;
    }
    for (const Log& log : logs_->all)
        for (const RayBlock& b : log.blocks) blocks_[std::size_t(b.call)].push_back(&b);
    for (auto& blocks : blocks_)
        std::sort(blocks.begin(), blocks.end(), [](const RayBlock* a, const RayBlock* b) { return a->order < b->order; });
}

RayRecord::Log& RayRecord::log() {
    thread_local uint64_t owner = 0;
    thread_local Log* mine = nullptr;
    if (owner != serial_) {
        const std::lock_guard lock(logs_->mutex);
        mine = &logs_->all.emplace_back();
        owner = serial_;
    }
    return *mine;
}

void RayRecord::add(const Accel* accel, RayCall call, const SingleRay& ray, bool hit, float t) {
    RayRecord* const record = current.load(std::memory_order_relaxed);
    if (!record) return;
    Log& log = record->log();
    const bool distance = hit && call != RayCall::shadowSingle;
    log.answers[std::size_t(call)] += {1, 1, hit, distance ? std::bit_cast<uint32_t>(t) : 0};
    if (RayBlock* b = log.room(*record, accel, call, 1)) b->single.push_back(ray);
}

void RayRecord::add(const Accel* accel, RayCall call, const WideRays& rays, const RayAnswers& told) {
    RayRecord* const record = current.load(std::memory_order_relaxed);
    if (!record) return;
    Log& log = record->log();
    log.answers[std::size_t(call)] += told;
    if (RayBlock* b = log.room(*record, accel, call, told.rays)) b->wide.push_back(rays);
}

} // namespace chiaro
