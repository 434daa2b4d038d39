#include "tools/bake/pack.h"
#include <algorithm>
#include <numeric>
#include <tuple>

namespace chiaro::bake {
namespace {

struct Step { // of the skyline: from x to the next step it is y high
    uint32_t x, y, w;
};

// Where a rectangle of width w rests when its left edge is at step i; none beyond the right end.
std::optional<uint32_t> restsAt(const std::vector<Step>& line, std::size_t i, uint32_t w, uint32_t side) {
    if (line[i].x + uint64_t(w) > side) return {};
    uint32_t y = 0;
    for (uint32_t left = w; i < line.size(); ++i) {
        y = std::max(y, line[i].y);
        if (line[i].w >= left) break;
        left -= line[i].w;
    }
    return y;
}

void cover(std::vector<Step>& line, std::size_t i, Extent e, uint32_t y) {
    const uint32_t x = line[i].x, end = x + e.w;
    std::size_t last = i;
    while (last < line.size() && line[last].x + line[last].w <= end) ++last;
    if (last < line.size()) {
        const uint32_t cut = end - line[last].x;
        line[last].x += cut;
        line[last].w -= cut;
    }
    line.erase(line.begin() + std::ptrdiff_t(i), line.begin() + std::ptrdiff_t(last));
    line.insert(line.begin() + std::ptrdiff_t(i), {x, y + e.h, e.w});
    if (i + 1 < line.size() && line[i + 1].y == line[i].y) {
        line[i].w += line[i + 1].w;
        line.erase(line.begin() + std::ptrdiff_t(i) + 1);
    }
    if (i > 0 && line[i - 1].y == line[i].y) {
        line[i - 1].w += line[i].w;
        line.erase(line.begin() + std::ptrdiff_t(i));
    }
}

} // namespace

std::optional<std::vector<Pixel>> pack(std::span<const Extent> all, uint32_t side) {
    uint64_t area = 0;
    for (const Extent& e : all) area += uint64_t(e.w) * e.h;
    if (area > uint64_t(side) * side) return {};
    std::vector<uint32_t> order(all.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return std::tuple(all[b].h, all[b].w, a) < std::tuple(all[a].h, all[a].w, b); });
    std::vector<Pixel> places(all.size());
    std::vector<Step> line{{0, 0, side}};
    for (const uint32_t r : order) {
        const Extent e = all[r];
        std::size_t best = line.size();
        uint32_t low = ~0u;
        for (std::size_t i = 0; i < line.size(); ++i)
            if (const auto y = restsAt(line, i, e.w, side); y && *y < low && *y + uint64_t(e.h) <= side) best = i, low = *y;
        if (best == line.size()) return {};
        places[r] = {line[best].x, low};
        cover(line, best, e, low);
    }
    return places;
}

} // namespace chiaro::bake
