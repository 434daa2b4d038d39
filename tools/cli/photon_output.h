// What a user may see of photons: --aov photons, where they were dense, how far was gathered and how many; --photon-map FILE.glb, the
// photons themselves as points in the scene, each in the colour of its flux. For integrators and pre-passes that have photons
// (integrators/photon_source.h); others are refused before anything is loaded.
#pragma once
#include "integrators/photon_source.h"
#include "tools/cli/console.h"
#include "tools/cli/settings.h"

namespace chiaro::cli {

bool hasPhotons(const IntegratorChoice&, const PrepassChoice*); // the integrator, or the pre-pass that it takes
bool hasPhotons(const RenderSettings&);
// Throws Error(Exit::unsupported) where something of photons is asked for and there are none.
void checkPhotons(const RenderSettings&);
// Of the integrator, else of the pre-pass (null: none). More photons than a viewer shows well are thinned evenly, which the notes tell.
void writePhotonMap(const RenderSettings&, const Scene&, const Integrator&, const Prepass*, Diagnostics&);

} // namespace chiaro::cli
