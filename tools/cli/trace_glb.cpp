// The lines of chiaro trace: a node an integrator, under it one a sample, under that the rays, the shadow rays that arrived and those that
// did not, so that a viewer can hide each. A line has one colour, that of the event at its beginning.
#include "io/glb_write.h"
#include "tools/cli/trace.h"
#include "tools/cli/version.h"
#include <array>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

using Vertex = PathLog::Vertex;
using Kind = PathLog::Kind;

struct Hue {
    const char *name, *what;
    Spectrum color; // linear
};
constexpr std::array<Hue, eventCount> byEvent = {{{"DR", "orange", Spectrum(1, 0.35f, 0.03f)},
                                                  {"DT", "brown", Spectrum(0.4f, 0.13f, 0.01f)},
                                                  {"GR", "green", Spectrum(0.15f, 0.75f, 0.1f)},
                                                  {"GT", "dark green", Spectrum(0.03f, 0.25f, 0.03f)},
                                                  {"SR", "cyan", Spectrum(0.05f, 0.6f, 1)},
                                                  {"ST", "blue", Spectrum(0.05f, 0.12f, 1)}}};
constexpr Hue fromCamera{"camera", "white", Spectrum(1, 1, 1)}, fromLight{"light path", "pink", Spectrum(1, 0.2f, 0.5f)},
    arrived{"shadow ray", "yellow", Spectrum(1, 0.8f, 0.05f)}, stopped{"blocked", "dark red", Spectrum(0.3f, 0.01f, 0.01f)};

enum Part { rays, shadowRays, blockedRays, parts };
constexpr std::array<const char*, parts> partNames = {"rays", "shadow rays", "blocked shadow rays"};

class Lines {
public:
    Lines(const Trace& trace, GlbScene& scene) : trace_(trace), scene_(scene) {
        // In floats: world coordinates where they keep their digits, else distances from the scene's own centre.
        const Vec3d centre = trace.scene.centre();
        if (maxAbs(centre) > 1000 * double(trace.scene.radius())) origin_ = centre;
    }
    const Vec3d& origin() const { return origin_; }
    void add(const TracedSample& s, int parent, const std::string& name) {
        std::array<GlbShape, parts> shapes;
        const std::vector<Vertex>& all = s.log.vertices();
        for (const Vertex& v : all) {
            if (v.kind == Kind::emission || (v.parent == PathLog::none && !s.camera)) continue;
            const Vec3 from = place(v.parent == PathLog::none ? s.ray.o : all[v.parent].p), to = place(v.p);
            if (!finite(from) || !finite(to)) continue; // a path that went wrong ends here for the eye
            const Part part = v.blocked ? blockedRays : v.kind == Kind::light || v.kind == Kind::eye ? shadowRays : rays;
            const Spectrum color = hue(v, part).color;
            shapes[part].positions.insert(shapes[part].positions.end(), {from, to});
            shapes[part].colors.insert(shapes[part].colors.end(), {color, color});
        }
        for (std::size_t p = 0; p < parts; ++p)
            if (!shapes[p].positions.empty())
                scene_.nodes.push_back({fmt::format("{}, {}", name, partNames[p]), parent, {}, {std::move(shapes[p])}, {}});
    }

private:
    static const Hue& hue(const Vertex& v, Part part) {
        if (part != rays) return part == shadowRays ? arrived : stopped;
        return v.event ? byEvent[std::size_t(*v.event)] : v.parent == PathLog::none ? fromCamera : fromLight;
    }
    Vec3 place(const Vec3& p) const { return cast<float>(trace_.world(p) - origin_); }

    const Trace& trace_;
    GlbScene& scene_;
    Vec3d origin_;
};

std::string legend() {
    std::string text;
    for (const Hue& h : byEvent) text += fmt::format("{} {}, ", h.name, h.what);
    for (const Hue& h : {fromCamera, fromLight, arrived, stopped}) text += fmt::format("{} {}, ", h.name, h.what);
    text.resize(text.size() - 2);
    return text;
}

} // namespace

void writeTrace(const std::filesystem::path& file, const Trace& trace) {
    const std::string title = fmt::format("trace of {}, pixel {},{}", trace.operand, trace.pixel.x, trace.pixel.y);
    GlbScene scene{.name = title, .generator = fmt::format("chiaro {}", version), .nodes = {}};
    Lines lines(trace, scene);
    scene.nodes.push_back({title, -1, lines.origin(), {}, {{"colours", legend()}, {"seed", fmt::format("{}", trace.seed)}}});
    for (const TracedSide& side : trace.sides) {
        const int node = int(scene.nodes.size());
        scene.nodes.push_back({side.side->recipe, 0, {}, {}, {}});
        for (const TracedSample& s : side.samples) {
            const std::string name = fmt::format("{} {} {}", side.side->recipe, s.camera ? "sample" : "light path", s.number);
            const int sample = int(scene.nodes.size());
            scene.nodes.push_back(
                {name, node, {}, {}, {{"value", fmt::format("{:.9g} {:.9g} {:.9g}", s.value[0], s.value[1], s.value[2])}}});
            lines.add(s, sample, name);
        }
    }
    writeGlb(file, scene);
}

} // namespace chiaro::cli
