// Which light: the tree for those that rest at a place, a table by power for the others, and how the two share.
#include "core/scene/lights_builder.h"
#include <algorithm>

namespace chiaro {
namespace {

Vec3 boxCentre(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    const Vec3 low{min(a.x, min(b.x, c.x)), min(a.y, min(b.y, c.y)), min(a.z, min(b.z, c.z))};
    const Vec3 high{max(a.x, max(b.x, c.x)), max(a.y, max(b.y, c.y)), max(a.z, max(b.z, c.z))};
    return (low + high) * 0.5f;
}

} // namespace

// What moves, and what shines from no place, stays with the table.
void LightsBuilder::plantTree(const Executor* run) {
    std::vector<LightTree::Emitter> emitters;
    std::vector<double> outside;
    double inside = 0;
    for (uint32_t i = 0; i < lights_.triangles_.size(); ++i) {
        const Lights::Triangle& t = lights_.triangles_[i];
        if (t.motion != Lights::none) {
            lights_.outsideLights_.push_back(i);
            outside.push_back(double(t.power));
            continue;
        }
        const Vec3 b = t.p + t.e1, c = t.p + t.e2, centre = boxCentre(t.p, b, c);
        const float radius = max(length(t.p - centre), max(length(b - centre), length(c - centre)));
        emitters.push_back({centre, radius, t.ng, 1, 0, t.doubleSided, t.power / (pi * (t.doubleSided ? 2 : 1)), t.area, i});
        inside += double(t.power);
    }
    for (uint32_t i = 0; i < lights_.punctual_.size(); ++i) {
        const Lights::Punctual& l = lights_.punctual_[i];
        const auto light = uint32_t(lights_.triangles_.size()) + i;
        if (l.motion != Lights::none || l.kind == PunctualKind::directional) {
            lights_.outsideLights_.push_back(light);
            outside.push_back(l.power);
            continue;
        }
        LightTree::Emitter e{.centre = l.p, .axis = l.axis, .cosSpread = -1, .intensity = luminance(l.intensity), .light = light};
        if (l.kind == PunctualKind::spot) { // clamp(cos * scale + offset)^2 is 1 within the inner cone, 0 beyond the outer
            e.cosSpread = std::clamp((1 - l.offset) / l.scale, -1.f, 1.f);
            e.cosReach = std::cos(std::acos(std::clamp(-l.offset / l.scale, -1.f, 1.f)) - std::acos(e.cosSpread));
        }
        emitters.push_back(e);
        inside += l.power;
    }
    lights_.tree_ = LightTree(emitters, lights_.count(), run);
    if (lights_.tree_.empty()) return lights_.outsideLights_.clear();
    lights_.outside_ = AliasTable(outside);
    const double rest = lights_.outside_.sum();
    lights_.pickTree_ = rest > 0 ? float(std::clamp(inside / (inside + rest), leastShare, 1 - leastShare)) : 1;
}

float Lights::pmf(uint32_t light, const SurfacePoint& from) const noexcept {
    if (tree_.empty() || light >= triangles_.size() + punctual_.size()) return pmf(light);
    float here = pickTree_ * tree_.pmf(light, from.p, from.ng);
    if (here == 0 && !outside_.empty()) {
        const auto at = std::lower_bound(outsideLights_.begin(), outsideLights_.end(), light);
        if (at != outsideLights_.end() && *at == light) here = (1 - pickTree_) * outside_.pmf(uint32_t(at - outsideLights_.begin()));
    }
    return (1 - pickEnvironment_) * here;
}

// uTest: for the alias test, and what is left of it.
Choice Lights::choose(const SurfacePoint& from, double u, float uTest) const noexcept {
    if (tree_.empty()) return finite_.empty() ? Choice{} : finite_.choose(u, uTest);
    const double edge = double(pickTree_);
    if (u < edge) {
        const LightTree::Pick pick = tree_.choose(from.p, from.ng, u / edge);
        return {pick.light, pickTree_ * pick.pmf, uTest};
    }
    Choice c = outside_.choose((u - edge) / (1 - edge), uTest);
    return {outsideLights_[c.index], (1 - pickTree_) * c.pmf, c.u};
}

} // namespace chiaro
