// PathClasses: which light paths are wanted, and in which layer each belongs, as one automaton that a path walks along event by event:
// forward on light paths, backward on eye paths. Masks, layers, bounces and the depth limit are all in its states, so that no integrator
// knows of any of them. State 0: no wanted path begins like this, stop. Layer 0: not wanted. Depth counts scatterings: 0 emission, 1
// direct light. Every query is a table look-up; sorts() and continues() take states of either direction, the others only of their own.
// Layer 1 holds all paths, or with a split what is no light path (constant ambient, debug views); the classes of a split begin at 2.
#pragma once
#include "core/render/events.h"
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace chiaro {

using PathState = uint16_t;
using Layer = uint8_t;
inline constexpr uint32_t unlimitedDepth = 0xffff - 1;
inline constexpr Layer otherLayer = 1;

// What the user asks for, in the grammar of core/render/path_expression.h.
struct PathQuery {
    std::string paths; // only these; empty: all
    // Layers, by commas; where classes overlap the first one takes the path, and a class "rest" is added for what none takes.
    //   paths     the ten classes of defaultPathClasses(), which part all paths
    //   bounces   one layer a depth: bounces-0 to bounces-7, then bounces-8+
    //   a list    of NAME=EXPRESSION, EXPRESSION, the name of a default class, direct, indirect; rest last
    std::string split;
    uint32_t maxDepth = unlimitedDepth;
    std::string within;  // and only these: what an integrator covers; empty: all
    std::string without; // but none of these: what an integrator misses; empty: none
};

// The automaton as tables; made by core/render/path_classes_build.h.
struct PathTables {
    struct Row { // 16 bytes a state
        PathState next[eventCount] = {};
        bool continues = false, sorts = false;
        uint16_t unused = 0;
    };
    struct Stand { // row or column of joined; scatterings so far, 0 where depth does not matter
        uint16_t at = 0, depth = 0;
    };
    std::vector<Row> rows;
    std::vector<std::array<Layer, lightKindCount>> reached;
    std::vector<Stand> stands;
    std::vector<Layer> joined; // light's row, eye's column
    uint32_t columns = 0;
    uint32_t depth = unlimitedDepth; // most scatterings of a joined path
    PathState eye = 0;
    std::array<PathState, lightKindCount> light{};
};

class PathClasses {
public:
    explicit PathClasses(uint32_t maxDepth = unlimitedDepth);
    // Error(Exit::usage) for what cannot be read, wants no path at all, or needs more than 65,535 states (then it names a depth that fits).
    static PathClasses make(const PathQuery&);

    PathState eye() const noexcept { return t_.eye; }
    PathState eye(PathState s, Event e) const noexcept { return t_.rows[s].next[int(e)]; }
    PathState light(LightKind k) const noexcept { return t_.light[std::size_t(k)]; }
    PathState light(PathState s, Event e) const noexcept { return t_.rows[s].next[int(e)]; }
    // Do D and G of one side part from here on? If not, nobody throws dice for a class. S never needs them: a delta sample knows itself.
    bool sorts(PathState s) const noexcept { return t_.rows[s].sorts; }
    // The layer of an eye path that has reached a light.
    Layer reached(PathState eyeState, LightKind k) const noexcept { return t_.reached[eyeState][std::size_t(k)]; }
    // Both ends stand at the same vertex or at the ends of one connection, each with its event there already taken.
    Layer meet(PathState lightState, PathState eyeState) const noexcept {
        const PathTables::Stand l = t_.stands[lightState], e = t_.stands[eyeState];
        return uint32_t(l.depth) + e.depth <= t_.depth ? t_.joined[std::size_t(l.at) * t_.columns + e.at] : Layer(0);
    }
    // False where no further scattering can be wanted: the path may stop without asking for a closure.
    bool continues(PathState s) const noexcept { return t_.rows[s].continues; }
    uint32_t maxDepth() const noexcept { return maxDepth_; }

    // Names of the layers 1, 2, ... for a film; empty without a split.
    const std::vector<std::string>& layerNames() const noexcept { return names_; }
    std::size_t states() const noexcept { return t_.rows.size(); } // with state 0
    // Equal for queries that ask for the same paths in the same layers, however they are written.
    uint64_t hash() const noexcept;

private:
    PathClasses(PathTables tables, std::vector<std::string> names, uint32_t maxDepth)
        : t_(std::move(tables)), names_(std::move(names)), maxDepth_(maxDepth) {}
    PathTables t_;
    std::vector<std::string> names_;
    uint32_t maxDepth_;
};

} // namespace chiaro
