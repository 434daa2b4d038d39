// --prepass NAME[:key=value,...] and --prepass-file FILE: what is solved before a picture and takes the place of the constant ambient light
// of the integrators that have room for it (Traits::field).
#pragma once
#include "integrators/registry.h"
#include "tools/cli/command.h"
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace chiaro::cli {

struct PrepassSettings {
    std::optional<PrepassChoice> choice;
    std::filesystem::path file; // empty: solved each time, and not kept
    const PrepassChoice* get() const noexcept { return choice ? &*choice : nullptr; }
};
// --prepass-file alone means the pre-pass that the file holds. Throws Error.
PrepassSettings readPrepass(const Arguments&);

std::string prepassRecipe(const PrepassChoice&); // "photon:count=2M"
bool takesPrepass(const IntegratorChoice&);
// Null where this integrator takes none.
const PrepassChoice* prepassFor(const IntegratorChoice&, const PrepassChoice*);
// Throws Error(Exit::unsupported) where there is a pre-pass and none of them takes it.
void requireTaker(const PrepassSettings&, const std::vector<IntegratorChoice>&);
// "whitted, distributed; path takes none", where some take it and some do not.
std::string takersText(const std::vector<IntegratorChoice>&);

// The traits of an integrator with its pre-pass (null: without): it covers more, and what it adds is an approximation of its own.
// In its limit: over the option of the pre-pass, as the integrator of the same name converges over it, where it does.
Traits traitsWith(const IntegratorChoice&, const PrepassChoice*);
// "whitted + radiosity"; the integrator alone where it has no pre-pass.
std::string nameWith(const IntegratorChoice&, const PrepassChoice*);

} // namespace chiaro::cli
