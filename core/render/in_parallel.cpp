#include "core/render/in_parallel.h"
#include <exception>
#include <mutex>

namespace chiaro {

void inParallel(const Executor* run, uint64_t count, FunctionRef<void(uint64_t)> fn) {
    if (!run || run->threads() == 1 || count < 2) {
        for (uint64_t i = 0; i < count; ++i) fn(i);
        return;
    }
    std::mutex mutex;
    std::exception_ptr failure;
    std::atomic<uint64_t> lowest{~uint64_t(0)}; // what comes after it need not be done
    const auto piece = [&](uint64_t i) {
        if (i > lowest.load(std::memory_order_relaxed)) return;
        try {
            fn(i);
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (i > lowest) return;
            lowest = i;
            failure = std::current_exception();
        }
    };
    run->chunks(count, piece, nullptr);
    if (failure) std::rethrow_exception(failure);
}

} // namespace chiaro
