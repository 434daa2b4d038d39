// The entry of each integrator, defined beside its algorithm and listed in registry.cpp.
#pragma once
#include "integrators/registry.h"

namespace chiaro {

extern const IntegratorEntry pathEntry, raycastEntry, normalsEntry, depthEntry, albedoEntry, uvEntry, distributedEntry, aoEntry,
    whittedEntry, lightEntry, photonEntry, sppmEntry, radiosityEntry;
extern const PrepassEntry photonPrepass, radiosityPrepass;

} // namespace chiaro
