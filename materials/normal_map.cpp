#include "materials/normal_map.h"
#include "core/render/fault.h"
#include "materials/slot_reader.h"

namespace chiaro {
namespace {

// A bent normal below the geometric horizon is brought back onto it: it would see nothing of what the surface sees.
Vec3 above(const Vec3& n, const Vec3& ng) noexcept {
    const float c = dot(n, ng), least = 1e-3f;
    if (c >= least) return n;
    const Vec3 raised = n + ng * (least - c);
    const float l = length(raised);
    return l > 1e-6f ? raised * (1 / l) : ng;
}

} // namespace

TangentFrame tangentFrame(const SurfacePoint& s) noexcept {
    const bool given = lengthSquared(s.tangent) > 0;
    const Vec3 along = given ? s.tangent : s.dpdu, t = along - s.ns * dot(along, s.ns);
    const float l = length(t);
    if (!(l > 0) || !std::isfinite(1 / l)) return {};
    const Vec3 unit = t * (1 / l), b = cross(s.ns, unit);
    // glTF's V runs down the picture; a normal map's green points up it: the bitangent is against dp/dv.
    const float sign = given ? s.tangentSign : dot(b, s.dpdv) > 0 ? -1.f : 1.f;
    return {unit, b * sign};
}

// glTF 2.0, 3.9.3: c 2 - 1 in each channel, the scale on x and y before normalising.
Vec3 mappedNormal(const SlotReader& read, const TextureSlot& slot, float scale, const SurfacePoint& s) noexcept {
    if (slot.texture < 0) return s.ns;
    const TangentFrame frame = tangentFrame(s);
    if (!frame) return s.ns;
    Vec4 c = read(slot, Transfer::linear);
    if (fault(Fault::normalGreenFlipped)) c.y = 1 - c.y;
    const Vec3 n = frame.t * ((2 * c.x - 1) * scale) + frame.b * ((2 * c.y - 1) * scale) + s.ns * (2 * c.z - 1);
    const float l = length(n);
    return l > 1e-6f ? above(n * (1 / l), s.ng) : s.ns;
}

} // namespace chiaro
