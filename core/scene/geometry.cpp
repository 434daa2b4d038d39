#include "core/scene/geometry.h"
#include "core/render/fault.h"
#include <algorithm>

namespace chiaro {
namespace {

template <class T> std::size_t heldBy(const std::vector<T>& v) noexcept { return v.capacity() * sizeof(T); }

// The UV set along which the tangents of a surface run, where something on it is turned by them.
uint8_t frameSetOf(const MaterialDesc& m) noexcept {
    if (m.normalTexture.texture >= 0) return uint8_t(m.normalTexture.uvSet);
    if (m.clearcoatNormalTexture.texture >= 0) return uint8_t(m.clearcoatNormalTexture.uvSet);
    if (m.anisotropy != 0) return uint8_t(m.anisotropyTexture.texture >= 0 ? m.anisotropyTexture.uvSet : 0);
    return Geometry::noFrame;
}

Vec3d normalUnder(const Affine& m, const Vec3& n) noexcept {
    return fault(Fault::normalsByMatrix) ? m.vector(cast<double>(n)) : m.normal(cast<double>(n));
}

void place(Geometry& g, const Affine& m) {
    const bool flip = m.determinant() < 0;
    // One factor for all: normals of unequal length would interpolate to another direction than those of an instance do.
    double longest = 0;
    for (std::size_t step = 0; step <= g.steps.size(); ++step)
        for (const Vec3& n : g.normalsAt(step)) longest = std::max(longest, length(normalUnder(m, n)));
    const double factor = (flip ? -1 : 1) / longest;
    const auto move = [&](auto& shape) {
        for (Vec3& v : shape.positions) v = cast<float>(m.point(cast<double>(v)));
        for (Vec3& n : shape.normals) n = longest > 0 ? cast<float>(normalUnder(m, n) * factor) : Vec3{};
        for (Vec4& t : shape.tangents) {
            const Vec3 w = cast<float>(m.vector(Vec3d{t.x, t.y, t.z}));
            t = {w.x, w.y, w.z, flip ? -t.w : t.w};
        }
    };
    move(g);
    for (ShapeDesc& s : g.steps) move(s);
    // Under a mirroring map the front is the clockwise side (glTF 2.0, 3.7.4): store it counter-clockwise again.
    if (flip)
        for (std::size_t i = 0; i + 2 < g.indices.size(); i += 3) std::swap(g.indices[i + 1], g.indices[i + 2]);
}

} // namespace

Geometry makeGeometry(PrimitiveDesc p, const std::optional<Affine>& toWorld, uint32_t number, const MaterialDesc& m) {
    Geometry g;
    g.positions = std::move(p.positions);
    g.positions.reserve(g.positions.size() + 1);
    g.normals = std::move(p.normals);
    g.tangents = std::move(p.tangents);
    g.indices = std::move(p.indices);
    g.colors = std::move(p.colors);
    g.steps = std::move(p.steps);
    for (int k = 0; k < uvSets; ++k) {
        g.uv[k] = std::move(p.uv[k]);
        if (!g.uv[k].empty()) g.uvEnd = uint8_t(k + 1);
    }
    g.material = number;
    g.frameSet = frameSetOf(m);
    g.cutOut = m.alphaMode != AlphaMode::opaque;
    if (toWorld) place(g, *toWorld);
    g.positions.push_back({}); // room for Embree's 16-byte loads
    for (ShapeDesc& s : g.steps) s.positions.push_back({});
    return g;
}

std::size_t bytesOf(const Geometry& g) noexcept {
    std::size_t sum = heldBy(g.positions) + heldBy(g.indices) + heldBy(g.normals) + heldBy(g.tangents) + heldBy(g.colors) + heldBy(g.steps);
    for (const auto& uv : g.uv) sum += heldBy(uv);
    for (const ShapeDesc& s : g.steps) sum += heldBy(s.positions) + heldBy(s.normals) + heldBy(s.tangents);
    return sum;
}

} // namespace chiaro
