// The text of chiaro trace: a line a vertex, what it led to indented under it.
#include "io/file_bytes.h"
#include "tools/cli/trace.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

using Vertex = PathLog::Vertex;
using Kind = PathLog::Kind;

constexpr std::size_t deepestIndent = 40; // columns; the level is a number too

std::string number(float v) { return fmt::format("{:.5g}", v); }
std::string rgb(const Spectrum& s) {
    return s[0] == s[1] && s[1] == s[2] ? number(s[0]) : fmt::format("({}, {}, {})", number(s[0]), number(s[1]), number(s[2]));
}
std::string place(const Vec3d& p) {
    const auto coordinate = [](double v) { return fmt::format("{:.6g}", std::fabs(v) < 1e-12 ? 0.0 : v); };
    return fmt::format("({}, {}, {})", coordinate(p.x), coordinate(p.y), coordinate(p.z));
}

// Differs by more than a sum in another order can.
bool differ(const Spectrum& a, const Spectrum& b) {
    for (std::size_t c = 0; c < 3; ++c)
        if (std::fabs(a[c] - b[c]) > 1e-4f * std::max(std::fabs(a[c]), std::fabs(b[c]))) return true;
    return false;
}

class Tree {
public:
    Tree(const Trace& trace, const PathLog& log) : trace_(trace), log_(log), children_(log.vertices().size()) {
        const auto& all = log.vertices();
        for (uint32_t i = 0; i < all.size(); ++i) (all[i].parent < i ? children_[all[i].parent] : roots_).push_back(i);
    }
    std::string text() const {
        std::string out;
        std::vector<std::pair<uint32_t, uint32_t>> stack; // vertex, level; a path may be longer than a call stack is deep
        for (auto r = roots_.rbegin(); r != roots_.rend(); ++r) stack.emplace_back(*r, 1);
        while (!stack.empty()) {
            const auto [i, level] = stack.back();
            stack.pop_back();
            out += line(i, level);
            for (auto c = children_[i].rbegin(); c != children_[i].rend(); ++c) stack.emplace_back(*c, level + 1);
        }
        return out;
    }

private:
    std::string what(const Vertex& v, uint32_t i) const {
        const auto material = [&] {
            return v.material == PathLog::none ? std::string("something") : shown(materialName(trace_.scene, v.material));
        };
        const auto light = [&] { return shown(trace_.lightName(log_, i)); };
        switch (v.kind) {
        case Kind::surface: return "hit " + material();
        case Kind::light:
            if (v.light == PathLog::none) return v.blocked ? "ray, blocked" : "ray, free";
            return v.blocked ? fmt::format("shadow ray to {}, blocked by {}", light(), material()) : "light " + light();
        case Kind::sky: return v.light == PathLog::none ? std::string("sky") : "sky " + light();
        case Kind::eye: return v.blocked ? "eye, blocked" : "eye";
        case Kind::emission: return "leaves light " + light();
        }
        return {};
    }
    std::string line(uint32_t i, uint32_t level) const {
        const Vertex& v = log_.vertices()[i];
        std::string text =
            fmt::format("{:>4} {}{}", level, std::string(std::min<std::size_t>(2 * level - 2, deepestIndent), ' '), what(v, i));
        if (std::isfinite(v.t)) text += fmt::format(" at {}", place(trace_.world(v.p)));
        if (std::isfinite(v.t) && v.kind != Kind::emission) text += fmt::format("  {} m", number(v.t));
        if (v.event)
            text += fmt::format("  by {}  weight {}  {} {}", eventName(*v.event), rgb(v.weight), v.delta ? "pmf" : "pdf", number(v.pdfW));
        if (!v.blocked) text += fmt::format("  throughput {}", rgb(v.throughput));
        if (!black(v.contribution)) {
            const std::string path = trace_.pathClass(log_, i);
            text += fmt::format("  adds {}{}", rgb(v.contribution), path.empty() ? "" : fmt::format("  [{}]", path));
        }
        if (v.note) text += fmt::format("  -- {}", v.note);
        return text + "\n";
    }

    const Trace& trace_;
    const PathLog& log_;
    std::vector<std::vector<uint32_t>> children_;
    std::vector<uint32_t> roots_;
};

std::string exact(const Spectrum& s) { return fmt::format("{:.9g} {:.9g} {:.9g}", s[0], s[1], s[2]); } // as render --pixel tells it

std::string sampleText(const Trace& trace, const TracedSide& side, const TracedSample& s) {
    const Vec3& d = s.ray.d;
    std::string text = s.camera ? fmt::format("sample {}\n   0 camera at {} looks along {}\n", s.number, place(trace.world(s.ray.o)),
                                              place({d.x, d.y, d.z}))
                                : fmt::format("path {} of light\n", s.number);
    text += Tree(trace, s.log).text();
    text += fmt::format("value {}", exact(s.value));
    if (s.rays) text += fmt::format("   {} {}, depth {}", s.rays, s.rays == 1 ? "ray" : "rays", s.depth);
    if (s.log.vertices().empty())
        text += fmt::format("   {} tells nothing of its paths", side.side->settings.integrator.entry->name);
    else if (differ(s.value, s.sum()))
        text += fmt::format("   but the contributions told sum to {}", exact(s.sum()));
    return text + "\n";
}

} // namespace

std::string traceText(const Trace& trace) {
    std::string text;
    for (const TracedSide& side : trace.sides) {
        if (!text.empty()) text += "\n";
        const bool camera = side.samples.empty() || side.samples[0].camera; // paths of light belong to no pixel
        text += fmt::format("{}   {} camera {}{} seed {}\n", side.side->recipe, printable(trace.operand), shown(trace.camera),
                            camera ? fmt::format(" pixel {},{}", trace.pixel.x, trace.pixel.y) : "", trace.seed);
        for (const TracedSample& s : side.samples) text += sampleText(trace, side, s);
    }
    return text;
}

} // namespace chiaro::cli
