// The list behind -i where a command takes several integrators: pieces parted by commas, of which one with an "=" (before any ":") is an
// option of the name before it: "photon:count=2M,gather=64,path" are two integrators. Errors: Error(Exit::usage).
#pragma once
#include "integrators/registry.h"
#include <string>
#include <string_view>
#include <vector>

namespace chiaro::cli {

// Each as chooseIntegrator takes it: "photon:count=2M,gather=64", "path".
std::vector<std::string> splitIntegrators(std::string_view list);

// Looked up in the registry; the same one twice, with equal options, is an error.
std::vector<IntegratorChoice> chooseIntegrators(std::string_view list);

// Every integrator of the registry that transports light, with its default options.
std::vector<IntegratorChoice> allLightTransport();

// For file names: "photon-count-2M", "whitted+radiosity".
std::string fileName(const IntegratorChoice&, const PrepassChoice* prepass = nullptr);

} // namespace chiaro::cli
