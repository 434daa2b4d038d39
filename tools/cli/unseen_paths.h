// The warning for light paths that a scene holds and the chosen integrator cannot see: missing, which no number of samples mends.
#pragma once
#include "integrators/registry.h"
#include <optional>
#include <string>

namespace chiaro::cli {

// One line with an example path and, where the registry has one, an integrator that sees it; none: everything wanted is seen.
// prepass: that it renders with, null for none.
std::optional<std::string> unseenPaths(const Scene&, const IntegratorChoice&, const PathQuery&, const PrepassChoice* prepass = nullptr);

// The shortest of them, such as "La D D E".
std::optional<std::string> unseenPath(const Scene&, const Traits&, const PathQuery&);

} // namespace chiaro::cli
