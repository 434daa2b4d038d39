// chiaro ff: what it finds, and how it says so.
#pragma once
#include "integrators/radiosity/form_factors.h"
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace chiaro::cli {

// The objects of the scene file: nodes that draw, by name.
struct FfObjects {
    std::vector<std::string> names;   // distinct, in the order of the file
    std::vector<uint32_t> nameOfNode; // into names
    std::vector<uint32_t> nodeOfPart; // of Scene::parts()
    void add(const std::string& name, std::size_t node);
    uint32_t numberOf(const radiosity::Patch& p) const { return nameOfNode[nodeOfPart[p.part]]; }
    const std::string& nameOf(const radiosity::Patch& p) const { return names[numberOf(p)]; }

private:
    std::unordered_map<std::string, uint32_t> numbers_;
};

struct FfSelection {
    std::string name;
    std::vector<uint32_t> patches;
};
struct FfEstimate {
    double value = 0, error = 0; // standard error
};
struct FfPair {
    FfSelection from, to;
    FfEstimate there, back;
    double areaFrom = 0, areaTo = 0;
};
struct FfRow {
    FfSelection from;
    std::vector<std::pair<std::string, FfEstimate>> to; // largest first
    double sum = 0;
};
struct FfCheck {
    radiosity::FormFactorCheck found;
    double rowLimit = 0, asymmetryLimit = 0, seconds = 0;
    uint64_t entries = 0, bytes = 0;
    bool passed = false;
};
struct FfAnswer {
    std::string scene, method;
    const radiosity::Patches& patches;
    const FfObjects& objects;
    std::vector<std::string> warnings = {};
    bool exact = false;
    std::optional<FfPair> pair = {};
    std::optional<FfRow> row = {};
    std::optional<FfCheck> check = {};
};
std::string ffText(const FfAnswer&);
std::string ffJson(const FfAnswer&);

} // namespace chiaro::cli
