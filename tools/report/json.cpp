#include "tools/report/json.h"
#include <cmath>
#include <nlohmann/json.hpp>

namespace chiaro::report {
namespace {

using Json = nlohmann::ordered_json;

Json number(double v) {
    if (std::isnan(v)) return nullptr;
    if (std::isinf(v)) return v > 0 ? "Infinity" : "-Infinity";
    return v;
}

const char* standingName(Standing s) {
    switch (s) {
    case Standing::reference: return "reference";
    case Standing::agrees: return "agrees";
    case Standing::cannotTell: return "cannotTell";
    case Standing::missesPaths: return "missesPaths";
    case Standing::biased: return "biased";
    case Standing::differs: return "differs";
    case Standing::debug: return "debug";
    case Standing::unjudged: break;
    }
    return "unjudged";
}

Json imageJson(const Image& image, const Block* block, uint32_t& next) {
    std::size_t nan = 0, infinite = 0;
    for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
        bool anyNan = false, anyInfinite = false;
        for (std::size_t c = 0; c < 3; ++c) {
            anyNan |= std::isnan(image.rgb[i + c]);
            anyInfinite |= std::isinf(image.rgb[i + c]);
        }
        nan += anyNan;
        infinite += anyInfinite && !anyNan;
    }
    Json out{{"name", image.name}, {"fullWidth", image.width}, {"fullHeight", image.height}, {"nan", nan}, {"infinite", infinite}};
    if (!block || block->packed.bytes.empty()) return out;
    out.update({{"block", next++},
                {"width", block->width},
                {"height", block->height},
                {"predictor", int(block->packed.predictor)},
                {"bytes", block->packed.bytes.size()}});
    return out;
}

Json entryJson(const Entry& e, const Fitted::Entry& blocks, uint32_t& next) {
    Json metrics = Json::array(), layers = Json::array(), maps = Json::array();
    for (const Metric& m : e.metrics)
        metrics.push_back({{"name", m.name},
                           {"value", number(m.value)},
                           {"error", number(m.error)},
                           {"smallerIsBetter", m.smallerIsBetter},
                           {"ranked", m.ranked}});
    Json picture = imageJson(e.picture, &blocks.pictures[0], next);
    for (std::size_t i = 0; i < e.layers.size(); ++i) // those beyond the blocks were left out for size
        layers.push_back(imageJson(e.layers[i], i + 1 < blocks.pictures.size() ? &blocks.pictures[i + 1] : nullptr, next));
    for (std::size_t i = 0; i < e.maps.size(); ++i) {
        const Map& m = e.maps[i];
        const Block& block = blocks.maps[i];
        Json map{{"name", m.name}, {"caption", m.caption}, {"low", number(m.low)}, {"high", number(m.high)}, {"diverging", m.diverging}};
        if (!block.packed.bytes.empty())
            map.update({{"block", next++},
                        {"width", block.width},
                        {"height", block.height},
                        {"predictor", int(block.packed.predictor)},
                        {"bytes", block.packed.bytes.size()}});
        maps.push_back(std::move(map));
    }
    return {{"name", e.name},
            {"source", e.source},
            {"covers", e.covers},
            {"standing", standingName(e.standing)},
            {"verdict", e.verdict},
            {"picture", std::move(picture)},
            {"layers", std::move(layers)},
            {"maps", std::move(maps)},
            {"metrics", std::move(metrics)},
            {"seconds", number(e.seconds)},
            {"prepassSeconds", number(e.prepassSeconds)},
            {"prepareSeconds", number(e.prepareSeconds)},
            {"spp", number(e.spp)},
            {"seeds", e.seeds},
            {"dropped", e.dropped},
            {"file", e.file},
            {"command", e.command}};
}

Json curvesJson(const Report& report) {
    Json curves = Json::array();
    for (const Curve& c : report.curves) {
        Json points = Json::array();
        for (const CurvePoint& p : c.points)
            points.push_back({number(p.seconds), number(p.spp), number(p.error), number(p.low), number(p.high)});
        curves.push_back({{"entry", c.entry},
                          {"points", std::move(points)},
                          {"slope", c.slope ? number(*c.slope) : Json()},
                          {"slopeError", c.slopeError ? number(*c.slopeError) : Json()}});
    }
    return curves;
}

Json timesJson(const Report& report) {
    Json rows = Json::array();
    for (const TimeToError& t : report.timeToError) {
        Json cells = Json::array();
        for (const TimeToError::Cell& c : t.cells) cells.push_back({{"seconds", number(c.seconds)}, {"extrapolated", c.extrapolated}});
        rows.push_back({{"error", number(t.error)}, {"cells", std::move(cells)}});
    }
    return rows;
}

} // namespace

std::string asJson(const Report& report, const Fitted& fitted) {
    Json settings = Json::array(), entries = Json::array();
    for (const auto& [name, value] : report.settings) settings.push_back({name, value});
    uint32_t next = 0; // blocks are numbered in the order in which writeReport writes them
    for (std::size_t i = 0; i < report.entries.size(); ++i) entries.push_back(entryJson(report.entries[i], fitted.entries[i], next));
    const Json all{{"title", report.title},
                   {"version", report.version},
                   {"command", report.command},
                   {"machine", report.machine},
                   {"settings", std::move(settings)},
                   {"notes", report.notes},
                   {"reductions", fitted.reductions},
                   {"exposure", number(report.exposure)},
                   {"reference", report.reference ? Json(*report.reference) : Json()},
                   {"exponent", fitted.exponent},
                   {"factor", fitted.factor},
                   {"mapFactor", fitted.mapFactor},
                   {"mantissa", fitted.mantissa},
                   {"mapSteps", fitted.mapSteps},
                   {"entries", std::move(entries)},
                   {"curves", curvesJson(report)},
                   {"timeToError", timesJson(report)}};
    const std::string text = all.dump(-1, ' ', true, Json::error_handler_t::replace);
    std::string safe;
    safe.reserve(text.size());
    for (const char c : text) switch (c) {
        case '<': safe += "\\u003c"; break;
        case '>': safe += "\\u003e"; break;
        case '&': safe += "\\u0026"; break;
        default: safe += c;
        }
    return safe;
}

} // namespace chiaro::report
