// What `chiaro diff` writes for programs: CSV, a line for every metric and channel, and one JSON object. A number that is not known is an
// empty field or null; an infinite one is "inf" or "-inf".
#include "tools/cli/deliver.h"
#include "tools/cli/diff.h"
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using judge::Channel;
using Json = nlohmann::ordered_json;

Json number(double v) {
    if (std::isnan(v)) return nullptr;
    if (std::isinf(v)) return v > 0 ? "inf" : "-inf";
    return v;
}
std::string field(double v) { return std::isnan(v) ? "" : fmt::format("{}", v); }

std::string field(const std::string& text) { return csvQuoted(text); }

std::size_t rowOf(const judge::Metric& m) { return std::size_t(&m - judge::metricTable().data()); }

Json sideJson(const PictureSide& s) {
    return {{"file", s.file},
            {"width", s.width},
            {"height", s.height},
            {"channels", s.channels},
            {"decoded", s.encoded ? "sRGB" : "no"},
            {"errors", !s.picture.error.empty()},
            {"notCompared", s.ignored}};
}

Json metricsJson(const DiffInputs& in, const Difference& d) {
    Json all = Json::object();
    for (const judge::Metric* m : d.metrics) {
        Json entry{{"unit", in.unit(m->unit)}, {"formula", m->formula}};
        for (const Channel c : in.told) {
            if (!m->value && c != Channel::all) continue;
            const judge::MetricValue& v = d.of(c).values[rowOf(*m)];
            entry[in.columns[std::size_t(c)]] = {{"value", number(v.value)}, {"trimmed", number(v.trimmed)}};
        }
        all[m->name] = std::move(entry);
    }
    return all;
}

Json meansJson(const DiffInputs& in, const Difference& d) {
    Json all = Json::object();
    for (const Channel c : in.told) {
        const judge::ChannelReport& r = d.of(c);
        all[in.columns[std::size_t(c)]] = {{"a", number(r.meanTest)},
                                           {"b", number(r.meanReference)},
                                           {"difference", number(r.meanTest - r.meanReference)},
                                           {"standardError", r.meanDifferenceError ? number(*r.meanDifferenceError) : Json()}};
    }
    return all;
}

Json flipJson(const Difference& d) {
    Json flip = Json::object();
    if (d.report.flipLdr) flip["ldr"] = {{"exposure", d.exposure}};
    if (const auto& hdr = d.report.flipHdr)
        flip["hdr"] = {{"exposures", hdr->exposures}, {"start", number(hdr->startExposure)}, {"stop", number(hdr->stopExposure)}};
    return flip;
}

Json limitsJson(const DiffSettings& s, const Limits& limits) {
    Json all = Json::object();
    if (s.pixelLimits) all = {{"each", limits.pixels.each}, {"percent", limits.pixels.percent}, {"hard", number(limits.pixels.hard)}};
    for (const MetricLimit& l : limits.metrics) all["metrics"][l.metric] = l.value;
    return all;
}

} // namespace

std::string diffCsv(const DiffInputs& in, const Difference& d) {
    std::string text = "a,b,metric,channel,value,without_largest_0.1_percent,unit\n";
    for (const judge::Metric* m : d.metrics)
        for (const Channel c : in.told) {
            if (!m->value && c != Channel::all) continue;
            const judge::MetricValue& v = d.of(c).values[rowOf(*m)];
            text += fmt::format("{},{},{},{},{},{},{}\n", field(in.a.file), field(in.b.file), m->name, in.columns[std::size_t(c)],
                                field(v.value), field(v.trimmed), in.unit(m->unit));
        }
    return text;
}

std::string diffJson(const DiffInputs& in, const Difference& d, const DiffSettings& s, const DiffVerdict& verdict) {
    const judge::ChannelReport& all = d.of(Channel::all);
    const judge::Worst& w = d.of(d.worstChannel).worst;
    Json json{{"a", sideJson(in.a)}, {"b", sideJson(in.b)}, {"layer", s.layer.empty() ? Json() : Json(s.layer)}};
    json["area"] = {in.area.x0, in.area.y0, in.area.width(), in.area.height()};
    json["crop"] = s.crop.empty() ? Json() : Json(s.crop);
    json["mask"] = s.mask.empty() ? Json() : Json(s.mask);
    json["pixels"] = {{"selected", d.report.selected},
                      {"compared", d.report.compared},
                      {"notFiniteA", d.report.nonFiniteTest},
                      {"notFiniteB", d.report.nonFiniteReference}};
    json["identical"] = d.identical;
    json["metrics"] = metricsJson(in, d);
    json["means"] = meansJson(in, d);
    json["largest"] = nullptr;
    if (d.report.compared > 0)
        json["largest"] = {{"x", w.x + in.area.x0},      {"y", w.y + in.area.y0}, {"channel", in.columns[std::size_t(d.worstChannel)]},
                           {"difference", w.difference}, {"a", w.test},           {"b", w.reference}};
    json["constants"] = {{"peak", all.peak},
                         {"relmseFloor", all.relativeFloor},
                         {"mapeFloor", all.percentFloor},
                         {"maxOverMedianA", number(all.maxOverMedian)}};
    json["flip"] = flipJson(d);
    json["fail"] = {{"limits", limitsJson(s, s.fail)}, {"pixels", d.failing.pixels}, {"percent", d.failing.percent}};
    json["warn"] = {{"limits", limitsJson(s, s.warn)}, {"pixels", d.warning.pixels}, {"percent", d.warning.percent}};
    json["verdict"] = verdict.word;
    json["reason"] = verdict.reason;
    json["exitCode"] = int(verdict.code);
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace chiaro::cli
