#include "tools/cli/unseen_paths.h"
#include "core/render/path_expression_dfa.h"
#include "materials/possible_events.h"
#include "tools/cli/prepass_settings.h"
#include <fmt/format.h>
#include <map>
#include <vector>

namespace chiaro::cli {
namespace {

// A light without extent is seen by nobody, nor are mirror images of it: such paths carry nothing that could be missing.
constexpr const char* empty = "Ld S* E";
std::string orEmpty(const std::string& paths) { return paths.empty() ? empty : fmt::format("{} | {}", paths, empty); }

// The shortest wanted path that these traits leave out.
std::optional<std::string> missing(const Traits& t, const std::string& wanted, const PathsPresent& present) {
    if (auto path = firstCommon(wanted, t.misses, empty, present)) return path;
    return firstMissing(wanted, orEmpty(t.covers), present);
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

// The shortest wanted path of each way in which one can be absent.
struct Absent {
    std::optional<std::string> notFound, leftOut, approximated;
};
Absent wayOf(const Traits& t, const std::string& wanted, const PathsPresent& present) {
    std::string shown = t.covers;
    for (const std::string& more : {t.approximates, t.misses})
        if (!more.empty()) shown += (shown.empty() ? "" : " | ") + more;
    return {firstCommon(wanted, t.misses, empty, present), firstMissing(wanted, orEmpty(shown), present),
            firstCommon(wanted, t.approximates, orEmpty(t.covers), present)};
}

// A sentence for each; empty: nothing is absent.
std::string inWords(const Scene& scene, const std::string& name, const Absent& absent, const PathsPresent& present) {
    std::vector<std::string> all;
    if (const auto& path = absent.notFound) {
        const bool glass = present.letters & (letter(Event::ST) | letter(Event::GT));
        const bool caustic = path->find("S D") != std::string::npos || path->find("S G") != std::string::npos;
        all.push_back(fmt::format("{} {}: {} cannot sample these {} ({}). Missing, not noisy.", lightNames(scene, *path),
                                  glass ? "behind glass" : "and mirrors", name, caustic ? "caustics" : "paths", *path));
    }
    if (absent.leftOut)
        all.push_back(fmt::format("{} leaves out light paths by definition ({} and the like). Missing, not noisy.", name, *absent.leftOut));
    if (absent.approximated)
        all.push_back(
            fmt::format("{} shows others only by approximation ({} and the like). Biased, not noisy.", name, *absent.approximated));
    return fmt::format("{}", fmt::join(all, " "));
}

} // namespace

std::optional<std::string> unseenPath(const Scene& scene, const Traits& traits, const PathQuery& query) {
    return missing(traits, query.paths, {LetterSet(possibleLetters(scene) | eyeLetter), query.maxDepth});
}

std::optional<std::string> unseenPaths(const Scene& scene, const IntegratorChoice& choice, const PathQuery& query,
                                       const PrepassChoice* prepass) {
    const Traits traits = traitsWith(choice, prepass);
    if (!traits.lightTransport) return {};
    const PathsPresent present{LetterSet(possibleLetters(scene) | eyeLetter), query.maxDepth};
    const std::string text =
        inWords(scene, prepass ? nameWith(choice, prepass) : std::string(choice.entry->name), wayOf(traits, query.paths, present), present);
    if (text.empty()) return {};
    for (const IntegratorEntry& e : integrators()) {
        const Traits t = e.traits(Options(e.options));
        if (t.lightTransport && !missing(t, query.paths, present)) return fmt::format("{} Try -i {}.", text, e.name);
    }
    return text;
}

} // namespace chiaro::cli
