// What `chiaro render` says: the lines of a run, and the JSON summary.
#pragma once
#include "tools/cli/recipe.h"
#include <nlohmann/json_fwd.hpp>

namespace chiaro::cli {

std::string embreeVersion();
std::string bestIsa(); // Embree's choice on this machine

void tellHeader(const RenderSettings&, const Executor&, const Console&);
void tellScene(const RenderSettings&, const LoadedScene&, const std::string& camera, const Console&);
void tellIntegrator(const RenderSettings&, const View&, const Console&);
void tellDone(const RenderSettings&, const DisplayTransform&, const Film&, const Rendered&, std::span<const std::filesystem::path> files,
              const Console&);
// Warnings' siblings for programs: [{"subject": "photons", "message": "..."}].
nlohmann::ordered_json factsJson(const std::vector<Diagnostics::Fact>&);
void printSummary(const RenderSettings&, const LoadedScene&, const View&, const DisplayTransform&, const Film&, const Rendered&,
                  std::span<const std::filesystem::path> files, const Diagnostics&, int code);

} // namespace chiaro::cli
