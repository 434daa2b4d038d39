#include "tools/cli/console.h"
#include "tools/cli/ff.h"
#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;
using radiosity::Patch;
using radiosity::Patches;

constexpr std::size_t shown = 40;

// What is said of the patches of one object.
struct Part {
    std::size_t count = 0;
    uint32_t first = ~0u, last = 0;
    double area = 0, reflectance = 0, flux = 0; // reflectance: mean by area; flux: lumen of its own light
};
std::vector<Part> parts(const FfAnswer& a) {
    std::vector<Part> all(a.objects.names.size());
    for (uint32_t i = 0; i < a.patches.size(); ++i) {
        const Patch& p = a.patches[i];
        Part& o = all[a.objects.numberOf(p)];
        ++o.count;
        o.first = std::min(o.first, i);
        o.last = i;
        o.area += double(p.area);
        o.reflectance += double(p.area) * double(luminance(p.reflectance));
        o.flux += double(p.area) * double(luminance(p.emission));
    }
    for (Part& o : all)
        if (o.area > 0) o.reflectance /= o.area;
    return all;
}

std::string estimateText(const FfEstimate& e, bool exact) {
    if (e.value == 0) return "0";
    return exact ? fmt::format("{:.9g}", e.value) : fmt::format("{:.6g} +- {:.2g} ({})", e.value, e.error, percent(e.error / e.value));
}
Json estimateJson(const FfEstimate& e) { return {{"factor", e.value}, {"error", e.error}}; }

std::string listText(const FfAnswer& a) {
    std::string text =
        fmt::format("{:<24} {:>8} {:>15} {:>10} {:>12} {:>10}\n", "object", "patches", "numbers", "m2", "reflectance", "lumen");
    const std::vector<Part> all = parts(a);
    std::size_t lines = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Part& o = all[i];
        if (o.count == 0 || ++lines > shown) continue;
        text += fmt::format("{:<24} {:>8} {:>15} {:>10.4g} {:>12.3f} {:>10.4g}\n", a.objects.names[i], o.count,
                            fmt::format("{}-{}", o.first, o.last), o.area, o.reflectance, o.flux);
    }
    if (lines > shown) text += fmt::format("... and {} more (--json lists them)\n", lines - shown);
    return text;
}
std::string pairText(const FfPair& p, bool exact) {
    return fmt::format("{} -> {}   {}\n{} -> {}   {}\nA F {:.6g} and {:.6g} m2\n", p.from.name, p.to.name, estimateText(p.there, exact),
                       p.to.name, p.from.name, estimateText(p.back, exact), p.areaFrom * p.there.value, p.areaTo * p.back.value);
}
std::string rowText(const FfRow& r, bool exact) {
    std::string text = fmt::format("from {}\n", r.from.name);
    for (std::size_t i = 0; i < std::min(shown, r.to.size()); ++i)
        text += fmt::format("  {:<24} {}\n", r.to[i].first, estimateText(r.to[i].second, exact));
    if (r.to.size() > shown) text += fmt::format("  ... and {} more (--json lists them)\n", r.to.size() - shown);
    return text + fmt::format("  {:<24} {:.6g}\n", "all", r.sum);
}
std::string checkText(const FfCheck& c, std::size_t patches) {
    const auto& f = c.found;
    std::string text =
        fmt::format("scene       {}\n", f.closed ? "closed: every row should sum to 1" : "open: no row should sum to more than 1");
    text += fmt::format("rows        mean {:.6f}; worst off by {:.3g} as found (patch {}), {:.3g} in the matrix, limit {:.3g}\n",
                        f.meanRowSum, f.worstRowSum, f.worstRow, f.worstRowSumAfter, c.rowLimit);
    text += fmt::format("reciprocity worst |A_i F_ij - A_j F_ji| / (A_i + A_j) {:.3g} as found, {} in the matrix\n", f.worstAsymmetry,
                        f.worstAsymmetryAfter == 0 ? std::string("none") : fmt::format("{:.3g} m2", f.worstAsymmetryAfter));
    text += fmt::format("matrix      {} patches, {} factors ({} of a full one), {}, {}\n", patches, c.entries,
                        percent(double(c.entries) / std::max(1.0, double(patches) * double(patches))), memorySize(double(c.bytes)),
                        duration(c.seconds));
    return text + fmt::format("verdict     {}\n", c.passed ? "passed" : "FAILED");
}

Json checkJson(const FfCheck& c) {
    const auto& f = c.found;
    return {{"passed", c.passed},
            {"closed", f.closed},
            {"row_sums",
             {{"mean", f.meanRowSum},
              {"worst", f.worstRowSum},
              {"worst_patch", f.worstRow},
              {"worst_in_matrix", f.worstRowSumAfter},
              {"limit", c.rowLimit}}},
            {"asymmetry", {{"worst", f.worstAsymmetry}, {"worst_in_matrix_m2", f.worstAsymmetryAfter}}},
            {"entries", c.entries},
            {"bytes", c.bytes},
            {"seconds", c.seconds}};
}

} // namespace

void FfObjects::add(const std::string& name, std::size_t node) {
    const std::string shownName = name.empty() ? fmt::format("node {}", node) : name;
    const auto [at, isNew] = numbers_.try_emplace(shownName, uint32_t(names.size()));
    nameOfNode.push_back(at->second);
    if (isNew) names.push_back(shownName);
}

std::string ffText(const FfAnswer& a) {
    if (a.check) return fmt::format("method      {}\n{}", a.method, checkText(*a.check, a.patches.size()));
    if (!a.pair && !a.row) return listText(a);
    return fmt::format("method {}\n{}", a.method, a.pair ? pairText(*a.pair, a.exact) : rowText(*a.row, a.exact));
}

std::string ffJson(const FfAnswer& a) {
    Json j{{"scene", a.scene}, {"method", a.method}, {"patches", a.patches.size()}, {"longest_edge", a.patches.longestEdge()}};
    if (a.check) {
        j["check"] = checkJson(*a.check);
    } else if (a.pair) {
        j["from"] = {{"name", a.pair->from.name}, {"patches", a.pair->from.patches.size()}, {"area", a.pair->areaFrom}};
        j["to"] = {{"name", a.pair->to.name}, {"patches", a.pair->to.patches.size()}, {"area", a.pair->areaTo}};
        j["there"] = estimateJson(a.pair->there);
        j["back"] = estimateJson(a.pair->back);
    } else if (a.row) {
        j["from"] = {{"name", a.row->from.name}, {"patches", a.row->from.patches.size()}};
        for (const auto& [name, e] : a.row->to) j["row"].push_back({{"to", name}, {"factor", e.value}, {"error", e.error}});
        j["sum"] = a.row->sum;
    } else {
        const std::vector<Part> all = parts(a);
        for (std::size_t i = 0; i < all.size(); ++i)
            if (all[i].count)
                j["objects"].push_back({{"name", a.objects.names[i]},
                                        {"patches", all[i].count},
                                        {"first", all[i].first},
                                        {"last", all[i].last},
                                        {"area", all[i].area},
                                        {"reflectance", all[i].reflectance},
                                        {"lumen", all[i].flux}});
    }
    j["warnings"] = a.warnings;
    return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace chiaro::cli
