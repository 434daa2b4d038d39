#include "tools/cli/agree_report.h"
#include "tools/cli/deliver.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;
using judge::Agreement;

std::string signedPercent(double fraction) { return std::isfinite(fraction) ? fmt::format("{:+.2g} %", 100 * fraction) : "-"; }
std::string percentOf(double fraction) { return std::isfinite(fraction) ? fmt::format("{:.2g} %", 100 * fraction) : "-"; }
std::string interval(const judge::Interval& i) {
    return std::isfinite(i.low) && std::isfinite(i.high) ? fmt::format("{:+.2g} .. {:+.2g} %", 100 * i.low, 100 * i.high) : "-";
}
std::string p(double value) { return value < 1e-300 ? "0" : fmt::format("{:.2g}", value); }

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(); }

Json scaleJson(const judge::Scale& s) {
    return {{"p", number(s.p)}, {"alpha", s.alpha}, {"tests", s.tests}, {"rejected", s.rejected}, {"significant", s.significant()}};
}

Json biasJson(const Agreement& a) {
    Json all = Json::object();
    for (std::size_t k = 0; k < judge::meanCount; ++k) {
        const judge::Bias& b = a.bias[k];
        all[judge::meanName(judge::Mean(k))] = {{"relative", number(b.relative)},  {"low", number(b.interval.low)},
                                                {"high", number(b.interval.high)}, {"difference", number(b.test.difference)},
                                                {"error", number(b.test.error)},   {"p", number(b.test.p)}};
    }
    return all;
}

} // namespace

std::string agreeTable(const std::vector<AgreeRow>& rows) {
    std::size_t width = 10;
    for (const AgreeRow& r : rows) width = std::max(width, r.name.size());
    std::string text =
        fmt::format("{:<{}}  {:<15}  {:>9}  {:>18}  {:>8}  {:>8}  {:>8}  {:>8}  {:>8}  {:>8}  {}\n", "integrator", width, "verdict", "bias",
                    "95 % interval", "sees", "p image", "p tiles", "p pixels", "samples", "seconds", "on");
    for (const AgreeRow& r : rows) {
        const Agreement& a = r.judgement.agreement;
        text += fmt::format("{:<{}}  {:<15}  {:>9}  {:>18}  {:>8}  {:>8}  {:>8}  {:>8}  {:>8}  {:>8}  {}\n", r.name, width,
                            judge::verdictName(r.verdict), signedPercent(a.bias[0].relative), interval(a.bias[0].interval),
                            percentOf(a.resolution), p(a.image.p), p(a.tiles.p), p(a.pixels.p),
                            r.samples > 0 ? fmt::format("{:.0f}", r.samples) : "-", r.seconds > 0 ? fmt::format("{:.1f}", r.seconds) : "-",
                            r.judgedOn);
    }
    return text;
}

std::string agreeVerdicts(const std::vector<AgreeRow>& rows) {
    std::string text;
    for (const AgreeRow& r : rows) text += fmt::format("{} {}\n", r.name, r.text);
    for (const AgreeRow& r : rows)
        for (const std::string& note : r.notes) text += fmt::format("note: {}: {}\n", r.name, note);
    return text;
}

std::string agreeCsv(const std::vector<AgreeRow>& rows) {
    std::string text =
        "integrator,verdict,bias,bias_low,bias_high,resolution,p_image,p_tiles,p_pixels,equivalence_p,alpha,margin,replicates,"
        "samples,seconds,reference_seconds,more_samples,paths,text\n";
    for (const AgreeRow& r : rows) {
        const Agreement& a = r.judgement.agreement;
        const judge::Bias& b = a.bias[0];
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{:.3f},{:.3f},{},{},{}\n", csvQuoted(r.name),
                            judge::verdictName(r.verdict), b.relative, b.interval.low, b.interval.high, a.resolution, a.image.p, a.tiles.p,
                            a.pixels.p, a.equivalenceP, r.rule.alpha, r.rule.margin, a.replicates, r.samples, r.seconds, r.referenceSeconds,
                            r.judgement.moreSamples, csvQuoted(r.judgedOn), csvQuoted(r.text));
    }
    return text;
}

Json agreeJson(const AgreeRow& r) {
    const Agreement& a = r.judgement.agreement;
    Json j{{"name", r.name}, {"verdict", judge::verdictName(r.verdict)}, {"text", r.text}, {"paths", r.judgedOn}};
    j["alpha"] = r.rule.alpha;
    j["margin"] = r.rule.margin;
    j["bias"] = biasJson(a);
    j["image"] = scaleJson(a.image);
    j["tiles"] = scaleJson(a.tiles);
    j["pixels"] = scaleJson(a.pixels);
    j["pixels"]["outliers"] = {{"count", a.outliers}, {"low", a.outlierBounds.low}, {"high", a.outlierBounds.high}};
    j["resolution"] = number(a.resolution);
    j["tileResolution"] = number(a.tileResolution);
    j["equivalenceP"] = number(a.equivalenceP);
    j["skewness"] = number(a.skewness);
    j["compared"] = a.compared;
    j["nonFinitePixels"] = a.nonFinitePixels;
    j["tilesLeftOut"] = a.tilesLeftOut;
    j["replicates"] = a.replicates;
    j["paired"] = r.rule.paired;
    j["sharedNoise"] = number(a.sharedNoise);
    j["samples"] = r.samples;
    j["moreSamples"] = number(r.judgement.moreSamples);
    j["seconds"] = r.seconds;
    j["referenceSeconds"] = r.referenceSeconds;
    j["dropped"] = {r.dropped, r.referenceDropped};
    j["limit"] = nullptr;
    if (const auto& limit = r.judgement.limit) j["limit"] = {{"bias", limit->bias}, {"fitP", number(limit->fitP)}, {"fits", limit->fits}};
    j["notes"] = r.notes;
    return j;
}

std::string agreeNotes() {
    return R"(
Verdicts (exit code: the worst of them)
  agrees            0  nothing is significant, and a bias of --margin would have been found with 99 % probability
  cannot tell yet   1  nothing is significant, but the samples are too few to call that agreement; it says how many more it needs
  biased by x +- y  2  the mean of the image differs (Welch's t-test on Y, R, G, B; half of alpha); y: 95 % confidence
  differs           2  8x8 tiles or pixels differ (a quarter of alpha each), while the means agree
  A method that is biased by nature agrees when its mean lies inside --margin (two one-sided tests); where it names a convergence
  parameter, its limit over that parameter is what is judged.
Columns
  bias, 95 % interval   of the mean luminance, relative to the reference
  sees                  the smallest bias of the mean that is found with 99 % probability
  p image, tiles, pixels   of each family of tests: small where they differ (pixels on the safe side)
  samples               a pixel and side;  seconds: of rendering the integrator;  on: the light paths judged, in both renders
Two pictures A.exr B.exr are judged by their error layers (those of `chiaro render`), which err on the safe side: no second stage.
)";
}

} // namespace chiaro::cli
