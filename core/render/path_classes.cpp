#include "core/render/path_classes.h"
#include "core/render/error.h"
#include "core/render/fault.h"
#include "core/render/path_classes_build.h"
#include "core/render/path_classes_split.h"
#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <optional>
#include <xxhash.h>

namespace chiaro {
namespace {

bool blank(std::string_view text) { return text.find_first_not_of(" \t\r\n") == text.npos; }

// The layer of each state: that of the first class that takes the path, where every mask lets it through.
std::vector<Layer> layersOf(const PathDfa& dfa, std::size_t classes, uint64_t needed, uint64_t refused, Layer first) {
    std::vector<Layer> layers;
    for (const uint64_t a : dfa.accepts) {
        const bool wanted = (a & needed) == needed && (a & refused) == 0;
        const uint64_t taken = a & ((uint64_t(1) << classes) - 1);
        layers.push_back(wanted && taken ? Layer(first + std::countr_zero(taken)) : Layer(0));
    }
    return layers;
}

// Scatterings of the shortest path that has a layer.
std::optional<uint32_t> shortest(const PathDfa& dfa, const std::vector<Layer>& layers) {
    std::vector<bool> seen(dfa.next.size());
    seen[0] = true;
    std::vector<uint32_t> at(dfa.start.begin(), dfa.start.end()), next;
    for (uint32_t depth = 0; !at.empty(); ++depth, at.swap(next)) {
        next.clear();
        for (const uint32_t s : at) {
            if (seen[s]) continue;
            seen[s] = true;
            if (layers[s]) return depth;
            next.insert(next.end(), dfa.next[s].begin(), dfa.next[s].end());
        }
    }
    return std::nullopt;
}

void checkAnyWanted(const PathQuery& q, std::optional<uint32_t> depth) {
    if (depth && *depth <= q.maxDepth) return;
    const std::string masks = blank(q.paths) ? "light paths" : fmt::format("--paths \"{}\"", q.paths);
    if (depth)
        throw Error(Exit::usage, fmt::format("{}: such paths scatter {} times or more; use --max-depth {} instead of {}", masks, *depth,
                                             *depth, q.maxDepth));
    throw Error(Exit::usage,
                fmt::format("{}: the integrator can show none of these paths, it covers \"{}\"{}; choose other paths or another "
                            "integrator",
                            masks, blank(q.within) ? "L .* E" : q.within,
                            blank(q.without) ? "" : fmt::format(" without \"{}\"", q.without)));
}

} // namespace

PathClasses::PathClasses(uint32_t maxDepth)
    : PathClasses(make({.paths = {}, .split = {}, .maxDepth = maxDepth, .within = {}, .without = {}})) {}

PathClasses PathClasses::make(const PathQuery& q) {
    const bool split = !blank(q.split);
    std::vector<PathExpression> expressions;
    std::vector<std::string> names;
    bool restAdded = false;
    if (split) {
        PathSplit s = parseSplit(q.split, q.maxDepth);
        restAdded = s.restAdded;
        names.emplace_back("other");
        for (PathClass& c : s.classes) {
            names.push_back(std::move(c.name));
            expressions.push_back(std::move(c.paths));
        }
    } else
        expressions.push_back(PathExpression::all());
    const std::size_t classes = expressions.size();
    uint64_t needed = 0, refused = 0;
    const auto mask = [&](const std::string& text, uint64_t& bits) {
        if (blank(text)) return;
        bits |= uint64_t(1) << expressions.size();
        expressions.push_back(PathExpression::parse(text, "--paths"));
    };
    mask(q.paths, needed);
    mask(q.within, needed);
    mask(q.without, refused);

    const PathDfa dfa = determinise(expressions);
    const std::vector<Layer> layers = layersOf(dfa, classes, needed, refused, split ? otherLayer + 1 : otherLayer);
    if (restAdded && std::find(layers.begin(), layers.end(), Layer(names.size())) == layers.end()) names.pop_back();
    checkAnyWanted(q, shortest(dfa, layers));
    const uint32_t maxDepth = std::min(q.maxDepth + (fault(Fault::depthOffByOne) ? 1 : 0), unlimitedDepth);
    return PathClasses(buildPathTables(dfa, layers, maxDepth), std::move(names), maxDepth);
}

uint64_t PathClasses::hash() const noexcept {
    uint64_t h = maxDepth_;
    const auto add = [&h](const void* data, std::size_t bytes) { h = XXH3_64bits_withSeed(data, bytes, h); };
    add(t_.rows.data(), t_.rows.size() * sizeof t_.rows[0]);
    add(t_.reached.data(), t_.reached.size() * sizeof t_.reached[0]);
    add(t_.stands.data(), t_.stands.size() * sizeof t_.stands[0]);
    add(t_.joined.data(), t_.joined.size());
    add(&t_.eye, sizeof t_.eye);
    add(t_.light.data(), sizeof t_.light);
    for (const std::string& name : names_) add(name.c_str(), name.size() + 1);
    return h;
}

} // namespace chiaro
