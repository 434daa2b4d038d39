#include "integrators/whitted_surface.h"
#include "core/render/fault.h"
#include "materials/fresnel.h"
#include "materials/slot_reader.h"
#include "materials/surface_parameters.h"
#include <algorithm>

namespace chiaro {
namespace {

using Settings = WhittedSettings;

bool transparent(const MaterialDesc& m) noexcept { return m.transmission > 0 && m.metallic < 1 && !m.unlit; }
float transmittedShare(const BsdfParameters& p) noexcept { return clamp01(p.transmission) * (1 - clamp01(p.metallic)); }
bool smooth(const BsdfParameters& p) noexcept { return sqr(clamp01(p.roughness)) < Lobes::smallestAlpha; }

// The normal of the front side that this closure uses.
Vec3 frontNormal(const Bsdf& bsdf, const SurfacePoint& at, const Vec3& wo) noexcept {
    return dot(at.ng, wo) >= 0 ? bsdf.normal() : -bsdf.normal();
}

Bsdf closure(const Settings& s, const Scene& scene, const SurfacePoint& at, const Vec3& wo, const Footprint& footprint,
             Wavelengths& lambda) noexcept {
    const Bsdf own = shade(scene, at, wo, footprint, lambda, Transport::radiance, Densities::forward);
    if (s.transparency == Settings::Transparency::refractive || !transparent(scene.material(at.material))) return own;
    BsdfParameters p = surfaceParameters(SlotReader(scene, at, wo, footprint), scene.material(at.material), at);
    p.transmission = 0;
    return Bsdf(p, at.ng, frontNormal(own, at, wo), wo);
}

// Both curves of a smooth dielectric at one angle, by KHR_materials_specular from F0 to F90.
struct Curves {
    Spectrum exact, schlick;
};
Curves curves(const BsdfParameters& p, float cosine, bool outside) noexcept {
    const float normal = fresnelNormal(p.ior), eta = outside ? p.ior : 1 / p.ior;
    const float total = fresnelDielectric(cosine, eta);
    if (!outside && total == 1) return {Spectrum(1), Spectrum(1)};
    const float thin = outside ? cosine : safeSqrt(1 - sqr(p.ior) * (1 - sqr(cosine))); // on the thin side (E6 of the usual slips)
    const float shape = (total - normal) / (1 - normal), guess = schlickShape(thin), f90 = clamp01(p.specular);
    Curves c;
    for (std::size_t i = 0; i < 3; ++i) {
        const float f0 = std::min(normal * std::max(p.specularColor[i], 0.f), 1.f) * f90;
        c.exact[i] = std::max(f0 + (f90 - f0) * shape, 0.f);
        c.schlick[i] = f0 + (f90 - f0) * guess;
    }
    return c;
}

// The branches of a smooth dielectric, from the exact curve to Schlick's.
void bend(TreeBranches& branches, const BsdfParameters& p, float cosine, bool outside) noexcept {
    const float metallic = clamp01(p.metallic), transmission = clamp01(p.transmission);
    if (p.ior - 1 < 1e-3f || metallic == 1) return; // infinite: Schlick's already; matched: there is no reflection
    const Curves front = curves(p, cosine, true);
    Curves glass = p.thin || outside ? front : curves(p, cosine, false);
    if (p.thin)
        for (std::size_t i = 0; i < 3; ++i) {
            glass.exact[i] = paneReflectance(glass.exact[i]);
            glass.schlick[i] = paneReflectance(glass.schlick[i]);
        }
    for (TreeBranch& b : branches)
        for (std::size_t i = 0; i < 3; ++i) {
            if (b.event == Event::SR)
                b.weight[i] += (1 - metallic) * ((1 - transmission) * (front.schlick[i] - front.exact[i]) +
                                                 transmission * (glass.schlick[i] - glass.exact[i]));
            else if (glass.exact[i] < 1)
                b.weight[i] *= (1 - glass.schlick[i]) / (1 - glass.exact[i]);
        }
}

} // namespace

WhittedSurface::WhittedSurface(const Settings& s, const Scene& scene, const SurfacePoint& at, const Vec3& wo, const Footprint& footprint,
                               Wavelengths& lambda) noexcept
    : bsdf_(s.transparency == Settings::Transparency::refractive
                ? shade(scene, at, wo, footprint, lambda, Transport::radiance, Densities::forward)
                : closure(s, scene, at, wo, footprint, lambda)) {
    if (s.transparency == Settings::Transparency::refractive || !transparent(scene.material(at.material))) return;
    const BsdfParameters p = surfaceParameters(SlotReader(scene, at, wo, footprint), scene.material(at.material), at);
    const float kt = transmittedShare(p);
    if (s.transparency == Settings::Transparency::filtered) {
        straight_ = p.baseColor * kt;
        return;
    }
    straight_ = Spectrum(kt);
    diffuse_ = 1 - clamp01(p.transmission);
    specular_ = s.transparency == Settings::Transparency::interpolated ? 1 - kt : 1;
}

BsdfValue WhittedSurface::evaluate(const Vec3& wi, Terms terms) const noexcept {
    if (diffuse_ == 1 && specular_ == 1) return bsdf_.evaluate(wi, terms);
    BsdfValue value = bsdf_.evaluate(wi, Terms::apart);
    for (int i = 0; i < value.n; ++i)
        value.terms[i].f *= value.terms[i].event == Event::DR || value.terms[i].event == Event::DT ? diffuse_ : specular_;
    return value;
}

TreeBranches WhittedSurface::branches(const Settings& s, const Scene& scene, const SurfacePoint& at, const Vec3& wo,
                                      const Footprint& footprint) const noexcept {
    TreeBranches all;
    for (const DeltaBranch& b : bsdf_.deltaSplit()) all.add({b.wi, b.weight, b.event, false});
    const bool schlick = s.fresnel == Settings::Fresnel::schlick && all.n > 0, mirror = s.glossy == Settings::Glossy::mirror;
    if (schlick || mirror) {
        BsdfParameters p = surfaceParameters(SlotReader(scene, at, wo, footprint), scene.material(at.material), at);
        if (s.transparency != Settings::Transparency::refractive) p.transmission = 0;
        const bool outside = dot(at.ng, wo) >= 0, rough = !smooth(p);
        TreeBranches more;
        if (mirror && rough) {
            p.roughness = 0;
            if (p.clearcoat > 0 && sqr(p.clearcoatRoughness) < Lobes::smallestAlpha) p.clearcoat = 0; // among the branches already
            for (const DeltaBranch& b : Bsdf(p, at.ng, frontNormal(bsdf_, at, wo), wo).deltaSplit())
                more.add({b.wi, b.weight, b.event == Event::SR ? Event::GR : Event::GT, true});
        }
        // The delta lobe of a rough closure is light that goes straight on: matched glass.
        if (s.fresnel == Settings::Fresnel::schlick && !rough && !hasFurtherLobes(scene.material(at.material)))
            bend(all, p, dot(bsdf_.normal(), wo), outside);
        for (const TreeBranch& b : more)
            if (!(b.event == Event::GT && all.n > 0)) all.add(b);
    }
    for (TreeBranch& b : all) b.weight *= specular_;
    if (!black(straight_)) all.add({-wo, straight_, Event::ST, false});
    if (fault(Fault::branchUnweighted))
        for (TreeBranch& b : all) b.weight = Spectrum(1);
    return all;
}

Passage shadowPassage(const Scene& scene, const SurfacePoint& at) noexcept {
    if (!transparent(scene.material(at.material))) return {};
    const BsdfParameters p = surfaceParameters(scene, at);
    const Spectrum colour = fault(Fault::shadowUntinted) ? Spectrum(1) : p.baseColor;
    return {colour * transmittedShare(p), smooth(p) ? Event::ST : Event::GT};
}

bool anyTransparent(const Scene& scene) noexcept { return std::any_of(scene.materials().begin(), scene.materials().end(), transparent); }

bool anyBlended(const Scene& scene) noexcept {
    return std::any_of(scene.materials().begin(), scene.materials().end(),
                       [](const MaterialDesc& m) { return m.alphaMode == AlphaMode::blend; });
}

} // namespace chiaro
