#include "core/render/executor.h"
#include <algorithm>
#include <thread>
#include <vector>
#include <xmmintrin.h>
#ifdef CHIARO_SANITIZE_THREAD
#else
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace chiaro {
namespace {

constexpr uint32_t tileSize = 16;

// Denormals cost hundreds of cycles and carry no light.
void flushDenormals() noexcept { _mm_setcsr(_mm_getcsr() | 0x8040); }

uint64_t spread(uint32_t x) noexcept { // bit i to bit 2i
    uint64_t result = 0;
    for (int bit = 0; bit < 32; ++bit) result |= uint64_t(x >> bit & 1) << (2 * bit);
    return result;
}

std::vector<Rect> mortonTiles(Rect area) {
    const uint32_t columns = (area.width() + tileSize - 1) / tileSize, rows = (area.height() + tileSize - 1) / tileSize;
    std::vector<std::pair<uint64_t, Pixel>> order;
    order.reserve(std::size_t(columns) * rows);
    for (uint32_t row = 0; row < rows; ++row)
        for (uint32_t column = 0; column < columns; ++column) order.push_back({spread(column) | spread(row) << 1, {column, row}});
    std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Rect> tiles;
    tiles.reserve(order.size());
    for (const auto& [code, tile] : order) {
        const uint32_t x = area.x0 + tile.x * tileSize, y = area.y0 + tile.y * tileSize;
        tiles.push_back({x, y, std::min(x + tileSize, area.x1), std::min(y + tileSize, area.y1)});
    }
    return tiles;
}

} // namespace

#ifdef CHIARO_SANITIZE_THREAD
struct Executor::Arena {
    explicit Arena(unsigned) {}
};
#else
struct Executor::Arena {
    explicit Arena(unsigned threads) : limit(tbb::global_control::max_allowed_parallelism, threads), arena(int(threads)) {}
    tbb::global_control limit; // more threads than cores are allowed: results must not depend on their number
    tbb::task_arena arena;
};
#endif

Executor::Executor(unsigned threads)
    : threads_(threads ? threads : std::max(1u, std::thread::hardware_concurrency())), arena_(std::make_unique<Arena>(threads_)) {
    flushDenormals();
}
Executor::~Executor() = default;

bool Executor::chunks(uint64_t count, FunctionRef<void(uint64_t)> fn, const StopToken* stop) const {
    std::atomic<bool> skipped{false};
    const auto one = [&](uint64_t i) {
        if (stop && stop->requested()) {
            skipped.store(true, std::memory_order_relaxed);
            return;
        }
        flushDenormals();
        fn(i);
    };
#ifdef CHIARO_SANITIZE_THREAD
    std::atomic<uint64_t> next{0};
    std::vector<std::thread> workers;
    for (unsigned t = 0; t < threads_; ++t)
        workers.emplace_back([&] {
            for (uint64_t i; (i = next.fetch_add(1)) < count;) one(i);
        });
    for (std::thread& w : workers) w.join();
#else
    arena_->arena.execute([&] { tbb::parallel_for(uint64_t(0), count, one, tbb::simple_partitioner()); });
#endif
    return !skipped.load();
}

void Executor::tiles(Rect area, FunctionRef<void(Rect)> fn, const StopToken* stop) const {
    const std::vector<Rect> all = mortonTiles(area);
    chunks(
        all.size(), [&](uint64_t i) { fn(all[i]); }, stop);
}

} // namespace chiaro
