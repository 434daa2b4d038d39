#include "core/render/path_classes_build.h"
#include "core/render/error.h"
#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace chiaro {
namespace {

constexpr std::size_t mostCells = std::size_t(1) << 24, mostNodes = std::size_t(1) << 20, mostStates = 65535;

using Next = std::array<uint32_t, eventCount>;
using Layers = std::array<Layer, lightKindCount>;
using Line = std::vector<uint16_t>; // layers

// One direction without a depth limit. State 0: dead.
struct Direction {
    std::vector<Next> next;
    std::vector<Layers> reached; // of eye states: by kind of light; of light states: what ends here, in the first
    std::vector<uint32_t> starts;
};
struct Both {
    Direction light, eye;
    std::vector<Layer> joined;
};

// An eye state is what it makes of every light state: the layer of the whole path. Prepending an event to the eye path asks the light
// state that has read it, so the reversed automaton is made of rows over the light's states, and is the smallest one (Brzozowski 1962).
// Light states on which all eye states agree are one: that makes the light's the smallest too, and leaves rows that are the table of pairs.
Both minimal(const PathDfa& dfa, const std::vector<Layer>& layers) {
    const std::size_t n = dfa.next.size();
    std::map<Line, uint32_t> ids;
    std::vector<const Line*> rows;
    const auto id = [&](Line row) {
        const auto [place, fresh] = ids.emplace(std::move(row), uint32_t(rows.size()));
        if (fresh) rows.push_back(&place->first);
        if (rows.size() * n > mostCells)
            throw Error(Exit::usage, "light paths: the expressions together need too large a table; shorten repetitions such as {n,m}, or "
                                     "limit the length of paths with --max-depth");
        return place->second;
    };
    Both both;
    id(Line(n));
    both.eye.starts = {id(Line(layers.begin(), layers.end()))};
    for (std::size_t q = 0; q < rows.size(); ++q) {
        Next next{};
        for (std::size_t e = 0; e < eventCount; ++e) {
            Line row(n);
            for (std::size_t p = 0; p < n; ++p) row[p] = (*rows[q])[dfa.next[p][e]];
            next[e] = id(std::move(row));
        }
        both.eye.next.push_back(next);
        Layers reached{};
        for (std::size_t k = 0; k < lightKindCount; ++k) reached[k] = Layer((*rows[q])[dfa.start[k]]);
        both.eye.reached.push_back(reached);
    }
    std::map<Line, uint32_t> columns;
    std::vector<uint32_t> merged(n);
    std::vector<std::size_t> kept;
    for (std::size_t p = 0; p < n; ++p) {
        Line column(rows.size());
        for (std::size_t q = 0; q < rows.size(); ++q) column[q] = (*rows[q])[p];
        const auto [place, fresh] = columns.emplace(column, uint32_t(kept.size()));
        merged[p] = place->second;
        if (!fresh) continue;
        kept.push_back(p);
        for (const uint16_t layer : column) both.joined.push_back(Layer(layer));
    }
    for (const std::size_t p : kept) {
        Next next{};
        for (std::size_t e = 0; e < eventCount; ++e) next[e] = merged[dfa.next[p][e]];
        both.light.next.push_back(next);
        both.light.reached.push_back({layers[p], 0, 0});
    }
    for (const uint32_t s : dfa.start) both.light.starts.push_back(merged[s]);
    return both;
}

// What a path can still do from here, and one (state, depth) that does it. Node 0: nothing.
struct Node {
    Next next{};
    Layers reached{};
    uint32_t state = 0, depth = 0;
};
struct Graph {
    std::vector<Node> nodes{Node{}};
    std::vector<uint32_t> starts;
};

Graph withoutLimit(const Direction& d) {
    Graph g;
    for (std::size_t s = 1; s < d.next.size(); ++s) g.nodes.push_back({d.next[s], d.reached[s], uint32_t(s), 0});
    g.starts = d.starts;
    return g;
}

// Scatterings that a state needs at least before a path can end.
std::vector<uint32_t> distances(const Direction& d) {
    std::vector<uint32_t> least(d.next.size(), unlimitedDepth);
    for (std::size_t s = 1; s < least.size(); ++s)
        if (d.reached[s] != Layers{}) least[s] = 0;
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t s = 1; s < least.size(); ++s)
            for (const uint32_t t : d.next[s])
                if (least[t] + 1 < least[s]) {
                    least[s] = least[t] + 1;
                    changed = true;
                }
    }
    return least;
}

[[noreturn]] void failTooDeep(const Both& both, uint32_t limit) {
    const std::size_t states = both.light.next.size() + both.eye.next.size() - 2;
    const std::size_t fits = (mostStates - 1) / states;
    throw Error(
        Exit::usage,
        fmt::format("--max-depth {} with these light paths needs more than 65535 states; use --max-depth {} or less, or leave it out",
                    limit, std::max<std::size_t>(fits, 1) - 1));
}

// Pairs of state and depth, from the start on, without those from which no path can end in time; then, from the deepest back, pairs with
// the same future become one. A pair may stand for another one of a different depth: only futures matter, to meet() as well.
Graph withLimit(const Direction& d, const Both& both, uint32_t limit) {
    const std::vector<uint32_t> least = distances(d);
    const auto alive = [&](uint32_t state, std::size_t depth) { return state != 0 && depth + least[state] <= limit; };
    std::vector<std::vector<uint32_t>> levels(1);
    for (const uint32_t s : d.starts)
        if (alive(s, 0)) levels[0].push_back(s);
    std::vector<std::size_t> seen(d.next.size(), 0);
    std::size_t count = 0;
    while (!levels.back().empty()) {
        std::vector<uint32_t> deeper;
        for (const uint32_t s : levels.back())
            for (const uint32_t t : d.next[s])
                if (seen[t] != levels.size() && alive(t, levels.size())) {
                    seen[t] = levels.size();
                    deeper.push_back(t);
                }
        count += deeper.size();
        if (count > mostNodes) failTooDeep(both, limit);
        levels.push_back(std::move(deeper));
    }
    Graph g;
    std::map<std::pair<Next, Layers>, uint32_t> ids;
    std::vector<uint32_t> below(d.next.size()), here(d.next.size());
    for (std::size_t depth = levels.size(); depth-- > 0;) {
        std::fill(here.begin(), here.end(), 0);
        for (const uint32_t s : levels[depth]) {
            Node node{{}, d.reached[s], s, uint32_t(depth)};
            for (std::size_t e = 0; e < eventCount; ++e) node.next[e] = below[d.next[s][e]];
            const auto [place, fresh] = ids.emplace(std::pair(node.next, node.reached), uint32_t(g.nodes.size()));
            if (fresh) g.nodes.push_back(node);
            here[s] = place->second;
        }
        here.swap(below);
    }
    for (const uint32_t s : d.starts) g.starts.push_back(below[s]);
    return g;
}

// Adds the nodes that can be reached from the starts, in the order in which they are reached; answers with the starts' numbers.
std::vector<PathState> number(const Graph& g, bool eye, const Both& both, uint32_t limit, PathTables& t) {
    std::vector<uint32_t> numbers(g.nodes.size(), 0), order;
    const std::size_t first = t.rows.size();
    const auto visit = [&](uint32_t node) {
        if (node == 0 || numbers[node] != 0) return;
        numbers[node] = uint32_t(first + order.size());
        order.push_back(node);
    };
    for (const uint32_t s : g.starts) visit(s);
    for (std::size_t i = 0; i < order.size(); ++i)
        for (const uint32_t s : g.nodes[order[i]].next) visit(s);
    if (first + order.size() > mostStates + 1) failTooDeep(both, limit);
    for (const uint32_t n : order) {
        const Node& node = g.nodes[n];
        PathTables::Row row;
        for (std::size_t e = 0; e < eventCount; ++e) row.next[e] = PathState(numbers[node.next[e]]);
        row.continues = std::any_of(row.next, row.next + eventCount, [](PathState s) { return s != 0; });
        row.sorts = row.next[int(Event::DR)] != row.next[int(Event::GR)] || row.next[int(Event::DT)] != row.next[int(Event::GT)];
        t.rows.push_back(row);
        t.reached.push_back(eye ? node.reached : Layers{});
        t.stands.push_back({uint16_t(node.state), uint16_t(node.depth)});
    }
    std::vector<PathState> starts;
    for (const uint32_t s : g.starts) starts.push_back(PathState(numbers[s]));
    return starts;
}

} // namespace

PathTables buildPathTables(const PathDfa& dfa, const std::vector<Layer>& layers, uint32_t maxDepth) {
    Both both = minimal(dfa, layers);
    const bool limited = maxDepth < unlimitedDepth;
    const auto graph = [&](const Direction& d) { return limited ? withLimit(d, both, maxDepth) : withoutLimit(d); };
    PathTables t;
    t.rows.resize(1);
    t.reached.resize(1);
    t.stands.resize(1);
    t.depth = limited ? maxDepth : unlimitedDepth;
    t.columns = uint32_t(both.eye.next.size());
    t.eye = number(graph(both.eye), true, both, maxDepth, t)[0];
    if (both.eye.next.size() == 2 && both.light.next.size() == 2) { // one state besides 0: the two directions are the same automaton
        for (std::size_t k = 0; k < lightKindCount; ++k) t.light[k] = both.light.starts[k] ? t.eye : PathState(0);
    } else {
        const std::vector<PathState> starts = number(graph(both.light), false, both, maxDepth, t);
        std::copy(starts.begin(), starts.end(), t.light.begin());
    }
    t.joined = std::move(both.joined);
    return t;
}

} // namespace chiaro
