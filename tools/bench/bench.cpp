#include "tools/bench/bench.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace chiaro::bench {

std::span<const Suite> suites() {
    static constexpr std::array all = {
        Suite{"rays", "rays of every kind, traced by Embree alone", "@cornell,@cornell-spheres,@caustic", "", raysSuite},
        Suite{"integrators", "samples and rays of every integrator", "@cornell,@cornell-spheres", "", integratorsSuite},
        Suite{"replay", "Embree alone on the very rays of a render, over the render", "@cornell,@cornell-spheres", "path,whitted",
              replaySuite},
        Suite{"split", "where the time of a render goes: rays, shading, lights, textures, film", "@cornell,@cornell-spheres",
              "path,whitted,distributed", splitSuite},
        Suite{"triangles", "growth with triangles: building, memory, rays of every kind", "", "", trianglesSuite, trianglesPlot},
        Suite{"photons", "photons traced, sorted and gathered", "@cornell,@caustic", "", photonsSuite},
        Suite{"radiosity", "every solver over growing numbers of patches", "@cornell", "", radiositySuite, radiosityPlot},
    };
    return all;
}

Panel panelOf(const Table& table, std::string title, std::size_t xColumn, std::size_t yColumn) {
    const auto named = [&](std::size_t i) {
        const Column& c = table.columns[i];
        return c.unit.empty() ? c.name : fmt::format("{}, {}", c.name, c.unit);
    };
    Panel panel{std::move(title), named(xColumn), named(yColumn), {}};
    const bool several = std::any_of(table.rows.begin(), table.rows.end(), [&](const Row& r) { return r.scene != table.rows[0].scene; });
    for (const Row& r : table.rows) {
        const std::string name = several ? r.subject + " " + r.scene : r.subject;
        auto at = std::find_if(panel.curves.begin(), panel.curves.end(), [&](const Curve& c) { return c.name == name; });
        if (at == panel.curves.end()) at = panel.curves.insert(at, {name, {}});
        at->points.emplace_back(r.cells[xColumn], r.cells[yColumn]);
    }
    return panel;
}

} // namespace chiaro::bench
