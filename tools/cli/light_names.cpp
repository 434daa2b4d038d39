#include "tools/cli/light_names.h"
#include <fmt/format.h>
#include <string_view>

namespace chiaro::cli {

std::string materialName(const Scene& scene, uint32_t id) {
    const std::string& name = scene.material(id).name;
    return name.empty() ? fmt::format("material {}", id) : name;
}

LightNames::LightNames(const Scene& scene) : scene_(scene) {
    for (const LightInfo& l : scene.lights().describe()) {
        const bool mesh = std::string_view(l.kind) == "mesh";
        triangles_ += mesh ? l.triangles : 0;
        std::vector<std::string>& names = mesh ? meshes_ : others_;
        environment_ = std::string_view(l.kind) == "environment";
        names.push_back(!l.name.empty() ? l.name : mesh ? "emissive mesh" : fmt::format("{} light {}", l.kind, names.size()));
    }
}

LightKind LightNames::kind(uint32_t light) const {
    if (light < triangles_) return LightKind::area;
    return environment_ && light + 1 == triangles_ + others_.size() ? LightKind::environment : LightKind::delta;
}

std::string LightNames::name(const PathLog::Vertex& v, const PathLog::Vertex* from) const {
    if (v.light == PathLog::none) return v.kind == PathLog::Kind::sky ? "nothing" : "light";
    if (v.light >= triangles_) {
        const std::size_t i = v.light - triangles_;
        return i < others_.size() ? others_[i] : "light";
    }
    if (meshes_.size() == 1) return meshes_[0];
    if (v.kind == PathLog::Kind::surface && v.material != PathLog::none) return materialName(scene_, v.material);
    if (from) {
        const Vec3 way = v.p - from->p;
        const float distance = length(way);
        if (distance > 0) {
            const Ray ray{from->p, 0.999f * distance, way * (1 / distance), 1.001f * distance, 0};
            const Hit hit = scene_.intersect(ray);
            if (hit && scene_.attributes(hit).light == v.light) return materialName(scene_, scene_.attributes(hit).material);
        }
    }
    return "emissive mesh";
}

} // namespace chiaro::cli
