// From a comparison to its files: every picture as EXR with layers, error and recipe; the report; the sheet; the tables.
#pragma once
#include "io/color.h"
#include "tools/cli/compare_run.h"
#include "tools/cli/scene_source.h"

namespace chiaro::cli {

struct SceneContext { // of what was rendered
    const LoadedScene& loaded;
    const View& view;
    std::string camera;
    const Executor& run;
    std::vector<float> depth;  // of pixel centres
    std::vector<uint8_t> lamp; // where they see a light
};
// Makes the folder, and throws Error for what could not be written later or would be written over a picture that is read.
void prepareFolder(const CompareSettings&, const std::vector<Contestant>&);

struct Told {
    report::Report report;
    std::vector<Stands> stands; // of each entry
    judge::AgreementSettings rule;
};
// Measures and judges; context: null for pictures alone.
Told makeReport(const CompareSettings&, const Comparison&, const SceneContext* context, Diagnostics&);
// The EXRs; returns their names.
std::vector<std::filesystem::path> writePictures(const CompareSettings&, const Comparison&, const SceneContext&, const DisplayTransform&,
                                                 double exposure, bool automaticExposure);
std::string machineName(unsigned threads, const std::string& isa);

} // namespace chiaro::cli
