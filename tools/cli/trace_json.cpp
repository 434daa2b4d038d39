// The same for programs: vertices in the order in which the sample made them, each with the number of its parent.
#include "tools/cli/trace.h"
#include "tools/cli/version.h"
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(fmt::format("{}", v)); } // JSON has no inf
Json vector(const Vec3d& v) { return {number(v.x), number(v.y), number(v.z)}; }
Json vector(const Vec3& v) { return vector(cast<double>(v)); }
Json rgb(const Spectrum& s) { return {number(s[0]), number(s[1]), number(s[2])}; }

Json vertexJson(const Trace& trace, const PathLog& log, uint32_t i) {
    static constexpr const char* kinds[] = {"surface", "light", "sky", "eye", "emission"};
    const PathLog::Vertex& v = log.vertices()[i];
    Json j{{"parent", v.parent == PathLog::none ? Json(nullptr) : Json(v.parent)},
           {"kind", kinds[int(v.kind)]},
           {"position", vector(trace.world(v.p))},
           {"normal", black(Spectrum(v.normal.x, v.normal.y, v.normal.z)) ? Json(nullptr) : vector(v.normal)},
           {"distance", number(v.t)},
           {"event", v.event ? Json(eventName(*v.event)) : Json(nullptr)},
           {"weight", rgb(v.weight)},
           {"pdf", number(v.pdfW)},
           {"delta", v.delta},
           {"throughput", rgb(v.throughput)},
           {"contribution", rgb(v.contribution)}};
    if (v.material != PathLog::none) j[v.blocked ? "blocker" : "material"] = materialName(trace.scene, v.material);
    if (v.light != PathLog::none) j["light"] = trace.lightName(log, i);
    if (v.blocked) j["blocked"] = true;
    if (const std::string path = trace.pathClass(log, i); !path.empty()) j["path"] = path;
    if (v.note) j["ended"] = v.note;
    return j;
}

Json sampleJson(const Trace& trace, const TracedSample& s) {
    Json j{{s.camera ? "sample" : "lightPath", s.number}};
    if (s.camera) {
        j["camera"] = {{"position", vector(trace.world(s.ray.o))}, {"direction", vector(s.ray.d)}, {"time", number(s.ray.time)}};
        j["rays"] = s.rays;
        j["depth"] = s.depth;
    }
    j["rgb"] = rgb(s.value);
    j["sum"] = rgb(s.sum());
    j["vertices"] = Json::array();
    for (uint32_t i = 0; i < s.log.vertices().size(); ++i) j["vertices"].push_back(vertexJson(trace, s.log, i));
    return j;
}

} // namespace

std::string traceJson(const Trace& trace, const std::vector<std::string>& files, const std::vector<std::string>& warnings) {
    Json all{{"version", version},
             {"scene", trace.operand},
             {"sceneHash", fmt::format("{:016x}", trace.scene.hash())},
             {"camera", trace.camera},
             {"pixel", {trace.pixel.x, trace.pixel.y}},
             {"seed", trace.seed},
             {"integrators", Json::array()}};
    for (const TracedSide& side : trace.sides) {
        Json samples = Json::array();
        for (const TracedSample& s : side.samples) samples.push_back(sampleJson(trace, s));
        all["integrators"].push_back({{"integrator", side.side->recipe}, {"samples", std::move(samples)}});
    }
    all["files"] = files;
    all["warnings"] = warnings;
    return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace chiaro::cli
