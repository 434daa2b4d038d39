#include "integrators/registry.h"
#include "integrators/entries.h"
#include <array>
#include <fmt/format.h>

namespace chiaro {

std::span<const IntegratorEntry> integrators() {
    static const std::array all = {pathEntry,  raycastEntry, whittedEntry, distributedEntry, aoEntry,
                                   lightEntry, normalsEntry, depthEntry,   albedoEntry,      uvEntry};
    return all;
}

IntegratorChoice chooseIntegrator(std::string_view text) {
    const std::size_t colon = text.find(':');
    const std::string name(text.substr(0, colon));
    std::vector<std::string> names;
    for (const IntegratorEntry& e : integrators()) {
        if (e.name == name) return {&e, Options::parse(e.options, colon == std::string_view::npos ? "" : text.substr(colon + 1), name)};
        names.emplace_back(e.name);
    }
    const std::string near = nearest(name, names);
    throw Error(Exit::usage, fmt::format("no integrator \"{}\"; have {}{}", name, fmt::join(names, ", "),
                                         near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

} // namespace chiaro
