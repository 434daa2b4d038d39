#include "core/render/fault.h"
#include "materials/bsdf.h"
#include "materials/closure_table.h"
#include "materials/dispersion.h"
#include "materials/normal_map.h"
#include "materials/slot_reader.h"
#include "materials/surface_parameters.h"

namespace chiaro {
namespace {

// Planted faults come and go while a scene stays, and the table with it.
#ifdef CHIARO_PLANT_FAULTS
constexpr bool shares = false;
#else
constexpr bool shares = true;
#endif

// The volume material behind the back face at s, where a segment along w (leaving s) runs on that side; null: outside, or no volume.
const MaterialDesc* inside(const Scene& scene, const SurfacePoint* s, const Vec3& w) noexcept {
    if (s == nullptr || dot(s->ng, w) >= 0) return nullptr;
    const MaterialDesc& m = scene.material(s->material);
    return hasInside(m) ? &m : nullptr;
}

} // namespace

Bsdf shade(const Scene& scene, const SurfacePoint& s, const Vec3& wo, const Footprint& here, Wavelengths& lambda, Transport transport,
           Densities densities) noexcept {
    if constexpr (shares)
        if (const ClosureTable* const table = ClosureTable::of(scene))
            if (const ClosureRecord* const r = table->find(s, lambda)) return Bsdf(*r, s.ng, s.ns, wo, transport, densities);
    const MaterialDesc& m = scene.material(s.material);
    const SlotReader read(scene, s, wo, here);
    BsdfParameters p = surfaceParameters(read, m, s);
    if (p.dispersion > 0 && lambda.hero > 0) { // of one wavelength it is glass like any other
        p.ior = Dispersion::ior(p.ior, p.dispersion, Dispersion::place(lambda.hero));
        p.dispersion = 0;
    }
    return Bsdf(p, s.ng, mappedNormal(read, m.normalTexture, m.normalScale, s), wo, transport, densities);
}

Spectrum segmentTransmittance(const Scene& scene, const SurfacePoint* from, const Vec3& wi, const SurfacePoint* to,
                              float distance) noexcept {
    if (const ClosureTable* const table = ClosureTable::of(scene); table && !table->absorbs()) return Spectrum(1);
    const MaterialDesc* m = inside(scene, from, wi);
    if (m == nullptr) m = inside(scene, to, -wi);
    if (m == nullptr || !std::isfinite(m->attenuationDistance) || !(m->attenuationDistance > 0)) return Spectrum(1);
    Spectrum t;
    for (std::size_t i = 0; i < 3; ++i)
        t[i] = std::pow(clamp01(m->attenuationColor[i]), fault(Fault::absorptionPerBounce) ? 1 : distance / m->attenuationDistance);
    return t;
}

} // namespace chiaro
