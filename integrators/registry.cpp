#include "integrators/registry.h"
#include "integrators/entries.h"
#include <array>
#include <fmt/format.h>

namespace chiaro {

std::span<const IntegratorEntry> integrators() {
    static const std::array all = {pathEntry, raycastEntry,   whittedEntry, distributedEntry, aoEntry,     lightEntry, photonEntry,
                                   sppmEntry, radiosityEntry, normalsEntry, depthEntry,       albedoEntry, uvEntry};
    return all;
}

std::span<const PrepassEntry> prepasses() {
    static const std::array all = {photonPrepass, radiosityPrepass};
    return all;
}

namespace {

// Of "name" or "name:key=value,..." the entry and its options.
template <class Choice, class Entry> Choice choose(std::span<const Entry> all, std::string_view kind, std::string_view text) {
    const std::size_t colon = text.find(':');
    const std::string name(text.substr(0, colon));
    std::vector<std::string> names;
    for (const Entry& e : all) {
        if (e.name == name) return {&e, Options::parse(e.options, colon == std::string_view::npos ? "" : text.substr(colon + 1), name)};
        names.emplace_back(e.name);
    }
    const std::string near = nearest(name, names);
    throw Error(Exit::usage, fmt::format("no {} \"{}\"; have {}{}", kind, name, fmt::join(names, ", "),
                                         near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

} // namespace

IntegratorChoice chooseIntegrator(std::string_view text) { return choose<IntegratorChoice>(integrators(), "integrator", text); }
PrepassChoice choosePrepass(std::string_view text) { return choose<PrepassChoice>(prepasses(), "pre-pass", text); }

std::string coveredWith(const Traits& traits, const PrepassChoice* prepass) {
    if (!prepass || traits.field.empty()) return traits.covers;
    const std::string shown = fmt::format("({}) {}", prepass->entry->field(prepass->options), traits.field);
    return traits.covers.empty() ? shown : fmt::format("{} | {}", traits.covers, shown);
}

} // namespace chiaro
