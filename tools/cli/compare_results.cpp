#include "tools/cli/compare_results.h"
#include "tools/cli/command.h"
#include "tools/cli/deliver.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;

const report::Metric* find(const report::Entry& e, std::string_view name) {
    for (const report::Metric& m : e.metrics)
        if (m.name == name) return &m;
    return nullptr;
}

std::string shownMetric(const report::Entry& e, std::string_view name) {
    const report::Metric* m = find(e, name);
    if (!m || std::isnan(m->value)) return "-";
    return m->error > 0 ? fmt::format("{:.3g} +-{:.1g}", m->value, m->error) : fmt::format("{:.3g}", m->value);
}

std::string shownMean(const report::Entry& e) {
    const report::Metric* m = find(e, "mean");
    if (!m || !std::isfinite(m->value)) return "-";
    const double relative = 100 * m->error / std::abs(m->value);
    return m->error > 0 && std::isfinite(relative) ? fmt::format("{:.4g} +-{:.2g} %", m->value, relative) : fmt::format("{:.4g}", m->value);
}

// Control characters in a file's name have no business on a terminal or in a table.
std::string printable(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
    return text;
}

std::string csvNumber(double v) { return std::isnan(v) ? "" : fmt::format("{}", v); }

Json number(double v) {
    if (std::isnan(v)) return nullptr;
    if (std::isinf(v)) return v > 0 ? "inf" : "-inf";
    return v;
}
Json number(const std::optional<double>& v) { return v ? number(*v) : Json(nullptr); }

constexpr std::array metricNames{"mean", "relative bias", "relMSE", "RMSE", "FLIP", "efficiency"};
std::string columnName(std::string name) {
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
}

Json judgedJson(const Stands& s, const judge::AgreementSettings& rule) {
    if (!s.agreement) return nullptr;
    const judge::Agreement& a = *s.agreement;
    const judge::Bias& b = a.bias[0];
    return {{"bias", number(b.relative)},
            {"low", number(b.interval.low)},
            {"high", number(b.interval.high)},
            {"resolution", number(a.resolution)},
            {"pImage", number(a.image.p)},
            {"pTiles", number(a.tiles.p)},
            {"pPixels", number(a.pixels.p)},
            {"equivalenceP", number(a.equivalenceP)},
            {"skewness", number(a.skewness)},
            {"alpha", rule.alpha},
            {"margin", rule.margin}};
}

Json entryJson(const report::Entry& e, const Stands& s, const judge::AgreementSettings& rule) {
    Json j{{"name", e.name},
           {"source", e.source},
           {"standing", standingName(e.standing)},
           {"verdict", e.verdict},
           {"covers", e.covers},
           {"missing", s.missing.empty() ? Json(nullptr) : Json(s.missing)},
           {"missingShare", number(s.missingShare)},
           {"ownShare", number(s.ownShare)},
           {"judged", judgedJson(s, rule)},
           {"seconds", e.seconds},
           {"prepassSeconds", e.prepassSeconds},
           {"prepareSeconds", e.prepareSeconds},
           {"spp", e.spp},
           {"seeds", e.seeds},
           {"dropped", e.dropped}};
    j["metrics"] = Json::object();
    for (const report::Metric& m : e.metrics) j["metrics"][m.name] = {{"value", number(m.value)}, {"error", number(m.error)}};
    j["layers"] = Json::array();
    for (const report::Image& l : e.layers) j["layers"].push_back(l.name);
    j["file"] = e.file;
    j["render"] = e.command;
    return j;
}

Json curveJson(const report::Curve& c, const report::Report& r) {
    Json j{{"entry", r.entries[c.entry].name}, {"slope", number(c.slope)}, {"slopeError", number(c.slopeError)}};
    j["points"] = Json::array();
    for (const report::CurvePoint& p : c.points)
        j["points"].push_back(
            {{"seconds", p.seconds}, {"spp", p.spp}, {"error", number(p.error)}, {"low", number(p.low)}, {"high", number(p.high)}});
    return j;
}

Json timesJson(const report::Report& r) {
    Json all = Json::array();
    for (const report::TimeToError& t : r.timeToError) {
        Json row{{"error", t.error}, {"seconds", Json::array()}};
        for (std::size_t i = 0; i < t.cells.size(); ++i)
            row["seconds"].push_back({{"entry", r.entries[r.curves[i].entry].name},
                                      {"seconds", number(t.cells[i].seconds)},
                                      {"extrapolated", t.cells[i].extrapolated}});
        all.push_back(std::move(row));
    }
    return all;
}

} // namespace

std::string compareTable(const report::Report& r) {
    std::size_t width = 10;
    for (const report::Entry& e : r.entries) width = std::max(width, e.name.size());
    std::string text = fmt::format("{:<{}}  {:>8}  {:>9}  {:>16}  {:>15}  {:>18}  {}\n", "picture", width, "seconds", "spp", "relMSE",
                                   "FLIP", "mean", "stands");
    for (const report::Entry& e : r.entries)
        text += fmt::format("{:<{}}  {:>8}  {:>9}  {:>16}  {:>15}  {:>18}  {}\n", printable(e.name), width,
                            e.seconds > 0 ? fmt::format("{:.2f}", e.seconds) : "-", e.spp > 0 ? fmt::format("{:.4g}", e.spp) : "-",
                            shownMetric(e, "relMSE"), shownMetric(e, "FLIP"), shownMean(e), standingName(e.standing));
    text += "\n";
    for (const report::Entry& e : r.entries)
        if (!e.verdict.empty()) text += fmt::format("{} {}\n", printable(e.name), e.verdict);
    return text;
}

std::string compareCsv(const report::Report& r) {
    std::string text = "name,source,standing,verdict,covers,seconds,prepass_seconds,prepare_seconds,spp,seeds,dropped";
    for (const char* name : metricNames) text += fmt::format(",{0},{0}_error", columnName(name));
    text += ",slope,slope_error,file,render\n";
    for (std::size_t i = 0; i < r.entries.size(); ++i) {
        const report::Entry& e = r.entries[i];
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}", csvQuoted(e.name), e.source, standingName(e.standing), csvQuoted(e.verdict),
                            csvQuoted(e.covers), e.seconds, e.prepassSeconds, e.prepareSeconds, e.spp, e.seeds, e.dropped);
        for (const char* name : metricNames) {
            const report::Metric* m = find(e, name);
            text += m ? fmt::format(",{},{}", csvNumber(m->value), m->error > 0 ? csvNumber(m->error) : "") : std::string(",,");
        }
        const auto curve = std::find_if(r.curves.begin(), r.curves.end(), [&](const report::Curve& c) { return c.entry == i; });
        const bool slope = curve != r.curves.end() && curve->slope;
        text += fmt::format(",{},{},{},{}\n", slope ? csvNumber(*curve->slope) : "",
                            slope && curve->slopeError ? csvNumber(*curve->slopeError) : "", csvQuoted(e.file), csvQuoted(e.command));
    }
    return text;
}

std::string compareJson(const report::Report& r, const std::vector<Stands>& stands, const judge::AgreementSettings& rule, Json head) {
    Json all{{"command", r.command}, {"version", r.version}, {"machine", r.machine}, {"exposure", r.exposure}};
    all["settings"] = Json::object();
    for (const auto& [name, value] : r.settings) all["settings"][name] = value;
    all.update(head);
    all["entries"] = Json::array();
    for (std::size_t i = 0; i < r.entries.size(); ++i) all["entries"].push_back(entryJson(r.entries[i], stands[i], rule));
    all["curves"] = Json::array();
    for (const report::Curve& c : r.curves) all["curves"].push_back(curveJson(c, r));
    all["timeToError"] = timesJson(r);
    all["notes"] = r.notes;
    return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string compareNotes() {
    return R"(
Operands: a SCENE (a glTF file or @cornell), pictures from anywhere, or both; of pictures alone the last one is the reference, as in diff A B.
Equal time counts pre-passes, all seeds together. What is rendered for the reference, and looks at the error on the way, are nobody's time.
Columns   relMSE: net of the reference's own error;  +-: 95 % over the seeds;  stands: by the rule of `chiaro agree` on the paths covered
  agrees          a bias of 1 % would have been seen
  cannot tell yet noisy; the line says how many times the samples are needed
  misses paths    different by definition: it does not make all light paths; the line says which, and how the others stand
  biased          its mean differs; differs: places differ while the means agree
  not judged      no error is known: one seed, a picture without an error layer, no reference
Exit code 0 done, 3 sizes do not match, 4 a file, 5 stopped by Ctrl-C with the results so far, 64 usage
)";
}

} // namespace chiaro::cli
