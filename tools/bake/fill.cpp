#include "tools/bake/fill.h"

namespace chiaro::bake {
namespace {

void add(MapTexel& to, const MapTexel& t, float w) {
    to.irradiance += t.irradiance * w;
    to.outgoing += t.outgoing * w;
    to.opacity += t.opacity * w;
}
MapTexel scaled(const MapTexel& t, float w) { return {t.irradiance * w, t.outgoing * w, t.opacity * w, true}; }

// One ring more: the mean of the known among the eight neighbours. Its texels are known only when the ring is whole.
uint64_t grow(std::span<MapTexel> map, uint32_t size) {
    std::vector<std::pair<std::size_t, MapTexel>> ring;
    for (uint32_t y = 0; y < size; ++y)
        for (uint32_t x = 0; x < size; ++x) {
            if (map[std::size_t(y) * size + x].known) continue;
            MapTexel sum{.opacity = 0};
            float n = 0;
            for (uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < size; ++v)
                for (uint32_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < size; ++u)
                    if (const MapTexel& t = map[std::size_t(v) * size + u]; t.known) {
                        const float w = u == x || v == y ? 2.f : 1.f;
                        add(sum, t, w);
                        n += w;
                    }
            if (n > 0) ring.emplace_back(std::size_t(y) * size + x, scaled(sum, 1 / n));
        }
    for (const auto& [at, t] : ring) map[at] = t;
    return ring.size();
}

void pull(std::span<MapTexel> map, uint32_t size) {
    if (size <= 1) return;
    const uint32_t half = (size + 1) / 2;
    std::vector<MapTexel> coarse(std::size_t(half) * half, MapTexel{.opacity = 0});
    std::vector<float> count(coarse.size(), 0);
    bool whole = true;
    for (uint32_t y = 0; y < size; ++y)
        for (uint32_t x = 0; x < size; ++x) {
            const MapTexel& t = map[std::size_t(y) * size + x];
            whole = whole && t.known;
            if (!t.known) continue;
            const std::size_t at = std::size_t(y / 2) * half + x / 2;
            add(coarse[at], t, 1);
            ++count[at];
        }
    if (whole) return;
    for (std::size_t i = 0; i < coarse.size(); ++i)
        if (count[i] > 0) coarse[i] = scaled(coarse[i], 1 / count[i]);
    pull(coarse, half);
    for (uint32_t y = 0; y < size; ++y)
        for (uint32_t x = 0; x < size; ++x)
            if (MapTexel& t = map[std::size_t(y) * size + x]; !t.known) t = coarse[std::size_t(y / 2) * half + x / 2];
}

} // namespace

uint64_t fillUnknown(std::span<MapTexel> map, uint32_t size, uint32_t rings) {
    uint64_t filled = 0;
    for (uint32_t i = 0; i < rings; ++i) filled += grow(map, size);
    bool any = false;
    for (const MapTexel& t : map) any = any || t.known;
    if (any) pull(map, size);
    return filled;
}

} // namespace chiaro::bake
