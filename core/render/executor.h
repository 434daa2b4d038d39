// Executor: the only parallel loops of the program. oneTBB behind one small header (plain threads under ThreadSanitizer, which cannot see
// into oneTBB). Every worker flushes denormals to zero. StopToken: the only cancellation flag; the deadline joins it.
#pragma once
#include "core/math/ray.h"
#include "core/render/function_ref.h"
#include <atomic>
#include <chrono>
#include <memory>

namespace chiaro {

class StopToken {
public:
    using Clock = std::chrono::steady_clock;
    bool requested() const noexcept { return asked_.load(std::memory_order_relaxed) || expired(); }
    bool cancelled() const noexcept { return asked_.load(std::memory_order_relaxed); } // by the user, not by the clock
    bool expired() const noexcept { return deadline_ != Clock::time_point::max() && Clock::now() >= deadline_; }
    void request() noexcept { asked_.store(true, std::memory_order_relaxed); } // safe in a signal handler
    void setDeadline(Clock::time_point t) noexcept { deadline_ = t; }          // between loops

private:
    std::atomic<bool> asked_{false};
    Clock::time_point deadline_ = Clock::time_point::max();
};

class Executor {
public:
    explicit Executor(unsigned threads = 0); // 0: all cores
    ~Executor();
    unsigned threads() const noexcept { return threads_; }
    // fn(tile) for every 16 x 16 tile of the rectangle, in Morton order. A stop skips the tiles that have not begun; null runs to the end.
    void tiles(Rect, FunctionRef<void(Rect)> fn, const StopToken* stop) const;
    // fn(i) for every i < count; false where a stop skipped some.
    bool chunks(uint64_t count, FunctionRef<void(uint64_t)> fn, const StopToken* stop) const;

private:
    struct Arena;
    unsigned threads_;
    std::unique_ptr<Arena> arena_;
};

} // namespace chiaro
