#include "tools/cli/unseen_paths.h"
#include "core/render/path_expression_dfa.h"
#include "materials/possible_events.h"
#include <fmt/format.h>
#include <map>

namespace chiaro::cli {
namespace {

// The shortest wanted path that these traits leave out.
std::optional<std::string> missing(const Traits& t, const std::string& wanted, const PathsPresent& present) {
    if (auto path = firstCommon(wanted, t.misses, present)) return path;
    return firstMissing(wanted, t.covers, present);
}

// "point and spot light", for a path that begins at a delta light.
std::string lightNames(const Scene& scene, const std::string& path) {
    if (path.starts_with("La")) return "area light";
    if (path.starts_with("Le")) return "environment";
    std::map<std::string, int> kinds;
    for (const LightInfo& l : scene.lights().describe())
        if (std::string(l.kind) != "mesh" && std::string(l.kind) != "environment") ++kinds[l.kind];
    std::string all;
    for (const auto& [kind, count] : kinds) all += (all.empty() ? "" : " and ") + kind;
    return all + " light";
}

} // namespace

std::optional<std::string> unseenPath(const Scene& scene, const Traits& traits, const PathQuery& query) {
    return missing(traits, query.paths, {LetterSet(possibleLetters(scene) | eyeLetter), query.maxDepth});
}

std::optional<std::string> unseenPaths(const Scene& scene, const IntegratorChoice& choice, const PathQuery& query) {
    const Traits traits = choice.entry->traits(choice.options);
    if (!traits.lightTransport) return {};
    const PathsPresent present{LetterSet(possibleLetters(scene) | eyeLetter), query.maxDepth};
    const auto path = missing(traits, query.paths, present);
    if (!path) return {};
    std::string other;
    for (const IntegratorEntry& e : integrators()) {
        const Traits t = e.traits(Options(e.options));
        if (other.empty() && t.lightTransport && !missing(t, query.paths, present)) other = e.name;
    }
    const bool glass = present.letters & (letter(Event::ST) | letter(Event::GT));
    const bool caustic = path->find("S D") != std::string::npos || path->find("S G") != std::string::npos;
    return fmt::format("{} {}: {} cannot sample these {} ({}). Missing, not noisy.{}", lightNames(scene, *path),
                       glass ? "behind glass" : "and mirrors", choice.entry->name, caustic ? "caustics" : "paths", *path,
                       other.empty() ? "" : fmt::format(" Try -i {}.", other));
}

} // namespace chiaro::cli
