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
// Half the width of the 95 % interval (Student's t) of the mean luminance, over the mean; NaN for a black picture.
double relativeInterval(const Film::Mean&);
// "128 spp in 4.3 s   noise 2.0 %   mean +-0.2 % (95 %)   0 non-finite"; biased: the interval is that of the noise alone.
std::string doneText(const Film&, const Rendered&, bool biased, double noiseWanted = 0);
// What was written, a line each.
void tellPictures(std::span<const std::filesystem::path> files, const DisplayTransform&, double exposure, bool automatic, const Console&);
void tellDone(const RenderSettings&, const DisplayTransform&, const Film&, const Rendered&, std::span<const std::filesystem::path> files,
              const Console&);
// Warnings' siblings for programs: [{"subject": "photons", "message": "..."}].
nlohmann::ordered_json finiteOrNull(double);
nlohmann::ordered_json factsJson(const std::vector<Diagnostics::Fact>&);
void printSummary(const RenderSettings&, const LoadedScene&, const View&, const DisplayTransform&, const Film&, const Rendered&,
                  std::span<const std::filesystem::path> files, const Diagnostics&, int code);

} // namespace chiaro::cli
