// What `chiaro agree` was asked for, as values.
#pragma once
#include "tools/cli/integrator_list.h"
#include "tools/cli/settings.h"
#include "tools/judge/agreement.h"
#include <optional>
#include <string>
#include <vector>

namespace chiaro::cli {

inline constexpr const char* referenceName = "path"; // in the registry
inline constexpr double planSeconds = 60;            // that the plan may use where no --time says otherwise

struct AgreeSettings {
    RenderSettings base; // of a scene: its integrator, budget and outputs are not used
    std::vector<IntegratorChoice> integrators;
    uint32_t replicates = 32;
    std::optional<uint32_t> spp;   // of one replicate; none: a pilot plans it
    std::optional<double> seconds; // of the first stage, pilot included
    bool confirm = true;
    judge::AgreementSettings rule;    // its alpha is that of the whole run
    std::vector<std::string> outputs; // a folder, FILE.png or FILE.exr
    std::string json, csv;            // a file, "-", or empty: none
};

// Throws Error(Exit::usage).
AgreeSettings readAgreeSettings(const Arguments&);
// Two operands: pictures.
bool comparesImages(const Arguments&);

} // namespace chiaro::cli
