// Layout: where every triangle of the baked parts lies in the light map. A layout that a part brings along (TEXCOORD_1, else TEXCOORD_0)
// is kept where it lies in the unit square and does not overlap itself; where the layouts of all parts fill one square together without
// overlap, they are kept to the letter, else each becomes one chart of the common map, scaled evenly. Parts without such a layout are cut
// into charts (tools/bake/chart.h). Texels are as large everywhere as the charts allow. Texel (x, y) has its corner at (x, y), row 0 first.
#pragma once
#include "tools/bake/chart.h"

namespace chiaro::bake {

enum class UvChoice : uint8_t { automatic, keep, fresh };
struct LayoutSettings {
    uint32_t size = 0;     // texels along the map; 0: as density asks
    double density = 0;    // texels a metre; 0: as many as the size holds
    uint32_t padding = 2;  // texels between charts
    uint32_t most = 16384; // texels along the map, at most
    UvChoice uv = UvChoice::automatic;
};

struct PartLayout {
    uint32_t part = 0;                          // of Scene::parts()
    int kept = -1;                              // the UV set that it follows; -1: charts of its own
    bool literal = false;                       // that set, unchanged, is the layout
    uint64_t overlapping = 0;                   // cells of the set that it brought which two triangles share
    std::vector<std::array<Point2, 3>> corners; // of each triangle, in texels
    std::vector<uint32_t> chart;                // of each triangle, counted over all parts; none: it has no area
};
inline constexpr uint32_t noChart = ~0u;

struct Layout {
    uint32_t size = 0;  // texels along the map
    double density = 0; // texels a metre, the mean
    uint32_t charts = 0, keptParts = 0;
    bool literal = false;
    uint64_t overlapping = 0; // texels whose centre two triangles claim
    std::vector<PartLayout> parts;
};

// Throws Error(Exit::usage) where charts cannot be put into the size that was asked for, Error(Exit::resources) beyond `most`,
// Error(Exit::unsupported) where a part's own layout is to be kept and cannot be.
Layout makeLayout(const Scene&, std::span<const uint32_t> parts, const LayoutSettings&, float time);

} // namespace chiaro::bake
