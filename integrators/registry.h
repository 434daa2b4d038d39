// The registry: every integrator of the program in one explicit array. The command line, its help, the reports and the tests read it; a new
// integrator is tested the moment it is listed.
#pragma once
#include "core/render/integrator.h"
#include "core/render/options.h"
#include "core/render/prepass.h"

namespace chiaro {

struct Traits {
    bool lightTransport = true; // makes a picture of light; false: a debug view
    bool unbiased = true;
    bool splats = false;
    bool mergeable = true;      // an iteration does not depend on earlier ones: ranges of samples can be rendered apart
    bool deterministic = false; // the same picture for every seed and any number of samples at the same positions
    std::string field;          // how it shows the diffuse field of a pre-pass, "S* E": the events between that surface and the eye;
                                // empty: it takes none
    std::string covers = "L (D|G|S)* E"; // the light paths it sees, in the grammar of --paths
    std::string misses;                  // those it cannot find by construction; empty: none
    std::string approximates;            // those it shows, but not as they are (an area light as a point); may overlap covers; empty: none
    // Of a consistent but biased method: the option h > 0 with which its bias vanishes as a sum of powers of h. It is judged by answers at
    // h, h s, h s^2, ... extrapolated to the limit; where a larger h is better, the step s is above 1 and the powers are negative.
    std::string convergesOver = {}; // the option's name; empty: none
    std::vector<double> convergencePowers = {2};
    double convergenceStep = 0.7071067811865476;
};
struct IntegratorEntry {
    std::string_view name, summary;
    std::span<const OptionSpec> options;
    Traits (*traits)(const Options&);
    std::unique_ptr<Integrator> (*make)(const Options&);
};
std::span<const IntegratorEntry> integrators();
// A pre-pass: its field is seen by the integrators whose traits name one.
struct PrepassEntry {
    std::string_view name, summary;
    std::span<const OptionSpec> options;
    std::string (*field)(const Options&); // the light paths in it, up to the diffuse surface that shows them: "L (D|G|S)+ D"
    std::unique_ptr<Prepass> (*make)(const Options&);
};
std::span<const PrepassEntry> prepasses();
struct PrepassChoice {
    const PrepassEntry* entry = nullptr;
    Options options;
};
PrepassChoice choosePrepass(std::string_view text); // as chooseIntegrator
// All light paths of an integrator with a pre-pass (null: without): what it covers by itself, and the field as it shows it.
std::string coveredWith(const Traits&, const PrepassChoice*);

// "name" or "name:key=value,...". Throws Error(Exit::usage) with the list and the nearest name.
struct IntegratorChoice {
    const IntegratorEntry* entry = nullptr;
    Options options;
};
IntegratorChoice chooseIntegrator(std::string_view text);

} // namespace chiaro
