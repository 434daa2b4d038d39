#include "materials/closure_table.h"
#include "core/scene/texture_slots.h"
#include "materials/surface_parameters.h"
#include <cmath>

namespace chiaro {
namespace {

bool variesOver(const MaterialDesc& m) noexcept {
    bool textured = false;
    forEachSlot(m, [&](const TextureSlot& slot, Transfer) { textured = textured || slot.texture >= 0; });
    return textured || m.anisotropy > 0;
}

} // namespace

ClosureRecord::ClosureRecord(const BsdfParameters& p) noexcept : parameters(p), mixture(p) {
    if (!p.layered()) return;
    const Vec3 up{0, 0, 1};
    diffuseScale = Layers(p, Lobes(mixture, up, true, Transport::radiance), up, true, nullptr).diffuseScale();
}

// Of materials that nothing is drawn with no table is filled.
ClosureTable::ClosureTable(const Scene& scene) {
    std::vector<bool> drawn(scene.materials().size(), false);
    for (const DrawnPart& p : scene.parts()) drawn[p.material] = true;
    entries_.reserve(scene.materials().size());
    for (uint32_t id = 0; id < scene.materials().size(); ++id) {
        const MaterialDesc& m = scene.material(id);
        const bool shared = drawn[id] && !variesOver(m);
        SurfacePoint at;
        at.material = id;
        entries_.push_back(
            {ClosureRecord(shared ? surfaceParameters(scene, at) : BsdfParameters{.specular = 0}), shared, m.dispersion > 0});
        absorbs_ = absorbs_ || (hasInside(m) && std::isfinite(m.attenuationDistance) && m.attenuationDistance > 0);
    }
}

std::unique_ptr<const SceneTable> ClosureTable::make(const Scene& scene) { return std::make_unique<ClosureTable>(scene); }

} // namespace chiaro
