// chiaro trace: what one sample of one pixel did, by one integrator or several, as text, as JSON and as lines in space. The value of a
// sample is what `chiaro render --pixel` replays, and the contributions at the vertices of its log sum to it.
// Positions are told in the world of the scene file: the compiled scene's centre is added back.
#pragma once
#include "tools/cli/light_names.h"
#include "tools/cli/replay.h"
#include <deque>
#include <string>

namespace chiaro::cli {

// One integrator with the settings that it would render with.
struct TraceSide {
    Arguments arguments; // as `chiaro render` would have got them
    RenderSettings settings;
    std::string recipe; // "path:rr-depth=3"
};
struct TraceSettings {
    std::deque<TraceSide> sides; // stays in place: settings point to arguments
    std::string pixel, output;   // output: empty for none
    uint32_t sample = 0, spp = 1;
    bool json = false, strict = false;
    const RenderSettings& common() const { return sides.front().settings; }
};
TraceSettings readTraceSettings(const Arguments&);

struct TracedSample {
    uint32_t number = 0;
    bool camera = true; // false: a path of light that begins at a lamp, told by its number alone
    Ray ray;            // of the camera
    PathLog log;
    Spectrum value{0};
    uint32_t rays = 0, depth = 0;
    Spectrum sum() const; // of the contributions
};
struct TracedSide {
    const TraceSide* side = nullptr;
    std::vector<TracedSample> samples;
    bool told() const; // does this integrator keep a log?
};
struct Trace {
    const Scene& scene;
    const LightNames& lights;
    std::string operand, camera; // of the scene; which camera
    uint64_t seed = 0;
    Pixel pixel;
    std::vector<TracedSide> sides;

    Vec3d world(const Vec3& p) const { return cast<double>(p) + scene.centre(); }
    std::string lightName(const PathLog&, uint32_t vertex) const;
    std::string pathClass(const PathLog&, uint32_t vertex) const; // "La DR SR E" of what was added there; empty: no light path
};
std::string_view eventName(Event); // "DR"

std::string traceText(const Trace&);
std::string traceJson(const Trace&, const std::vector<std::string>& files, const std::vector<std::string>& warnings);
// Named after its vertices' colours: which event led along a line (docs/trace.md).
void writeTrace(const std::filesystem::path&, const Trace&);

} // namespace chiaro::cli
