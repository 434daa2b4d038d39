#include "tests/converged/comparison.h"
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace chiaro::test {

using nlohmann::ordered_json;

namespace {

constexpr int format = 1;
constexpr const char* rebuild = "rebuild it with `sh tools/references.sh`, look at what it prints of old and new, and commit the files";

[[noreturn]] void refuse(const std::string& file, const std::string& what) {
    throw std::runtime_error(fmt::format("{}: {}; {}", file, what, rebuild));
}

// Six digits: a hundredth of the smallest error that is stored.
ordered_json rounded(double v) { return ordered_json::parse(fmt::format("{:.7g}", v)); }
template <class Range, class Get> ordered_json numbers(const Range& range, Get get) {
    ordered_json list = ordered_json::array();
    for (const judge::Estimate& e : range) list.push_back(rounded(get(e)));
    return list;
}
double meanOfEstimate(const judge::Estimate& e) { return e.mean; }
double errorOfEstimate(const judge::Estimate& e) { return e.error; }

ordered_json written(const Reference& r) {
    const judge::Evidence& e = r.evidence;
    return {{"covers", r.paths.covers},
            {"misses", r.paths.misses},
            {"integrator", r.integrator},
            {"version", r.version},
            {"commit", r.commit},
            {"seeds", {r.firstSeed, r.firstSeed + r.replicates - 1}},
            {"replicates", r.replicates},
            {"spp", r.spp},
            {"skewness", rounded(e.skewness)},
            {"mean YRGB", numbers(e.image, meanOfEstimate)},
            {"error YRGB", numbers(e.image, errorOfEstimate)},
            {"tile means Y", numbers(e.tiles, meanOfEstimate)},
            {"tile errors Y", numbers(e.tiles, errorOfEstimate)}};
}

Reference read(const ordered_json& j, const ReferenceFile& file) {
    Reference r;
    r.paths = {j.at("covers"), j.at("misses")};
    r.integrator = j.at("integrator");
    r.version = j.at("version");
    r.commit = j.at("commit");
    r.firstSeed = j.at("seeds").at(0);
    r.replicates = j.at("replicates");
    r.spp = j.at("spp");
    r.evidence = constantEvidence(0, file.size, file.tile);
    r.evidence.skewness = j.at("skewness");
    r.evidence.replicates = r.replicates;
    const auto fill = [&](auto& estimates, const char* means, const char* errors) {
        if (j.at(means).size() != estimates.size() || j.at(errors).size() != estimates.size())
            throw std::runtime_error(fmt::format("\"{}\" has {} values instead of {}", means, j.at(means).size(), estimates.size()));
        for (std::size_t i = 0; i < estimates.size(); ++i)
            estimates[i] = {j.at(means).at(i).template get<double>(), j.at(errors).at(i).template get<double>(), r.replicates - 1.};
    };
    fill(r.evidence.image, "mean YRGB", "error YRGB");
    fill(r.evidence.tiles, "tile means Y", "tile errors Y");
    return r;
}

} // namespace

const Reference* ReferenceFile::find(const Paths& paths) const {
    for (const Reference& r : entries)
        if (r.paths == paths) return &r;
    return nullptr;
}

std::filesystem::path referencePath(std::string_view scene) {
    return std::filesystem::path("tests/references") / (std::string(scene.substr(scene.starts_with('@') ? 1 : 0)) + ".json");
}

std::string toJson(const ReferenceFile& file) {
    ordered_json j = {{"format", format},  {"scene", file.scene}, {"hash", fmt::format("{:016x}", file.hash)}, {"camera", file.camera},
                      {"size", file.size}, {"tile", file.tile},   {"entries", ordered_json::array()}};
    for (const Reference& r : file.entries) j["entries"].push_back(written(r));
    return j.dump(1) + "\n";
}

ReferenceFile referenceFromJson(const std::string& text, const std::string& name) {
    try {
        const ordered_json j = ordered_json::parse(text);
        if (j.at("format") != format) refuse(name, fmt::format("has format {}, not {}", j.at("format").dump(), format));
        ReferenceFile file;
        file.scene = j.at("scene");
        file.hash = std::stoull(j.at("hash").get<std::string>(), nullptr, 16);
        file.camera = j.at("camera");
        file.size = j.at("size");
        file.tile = j.at("tile");
        for (const ordered_json& entry : j.at("entries")) file.entries.push_back(read(entry, file));
        return file;
    } catch (const ordered_json::exception& e) {
        refuse(name, fmt::format("cannot be read ({})", e.what()));
    } catch (const std::logic_error& e) { refuse(name, fmt::format("cannot be read ({})", e.what())); }
}

void requireSameScene(const ReferenceFile& file, const Stage& stage) {
    if (file.hash != stage.scene->hash())
        refuse(referencePath(stage.name).string(), fmt::format("shows another {} (hash {:016x}) than the program has now (hash {:016x})",
                                                               stage.name, file.hash, stage.scene->hash()));
}

ReferenceFile loadReference(const Stage& stage) {
    const std::filesystem::path path = referencePath(stage.name);
    std::ifstream in(path, std::ios::binary);
    if (!in) refuse(path.string(), "is missing");
    std::ostringstream text;
    text << in.rdbuf();
    ReferenceFile file = referenceFromJson(text.str(), path.string());
    requireSameScene(file, stage);
    return file;
}

} // namespace chiaro::test
