// The closure in sixteen lanes: Lobes (materials/lobes.h) for all materials that WideMaterials keeps, formula by formula, in the local
// frame of each hit. What differs between lanes is a mask; what no lane of a packet has is skipped, which changes no lane's answer. For
// files compiled for one instruction set (core/math/wide_lanes.h).
#pragma once
#include "core/math/wide_lanes.h"
#include "materials/fresnel.h"
#include "materials/lobe_weights.h"
#include "materials/microfacet.h"
#include "materials/wide_materials.h"

namespace chiaro::CHIARO_ISA {

struct WideLobeValue {
    Rgbw f;     // diffuse and glossy, 1/sr
    Float pdfW; // 0: scatters nothing there
};
struct WideLobeSample {
    Vec3w wi;
    Mask drawn, delta; // drawn: there is a direction
    Rgbw weight;       // of a delta lobe, not divided by pmf
    Float pmf;
    Mask transmitted;
};

struct WideLobes {
    Mask lanes, rough, reflects, straight, refracted, thin, diffuse, coated, outside, glossy; // glossy: rough and reflects
    Mask later;                                                                               // metal whose facets light each other
    Float alpha, ior, metallic, f90, coat, glass;
    Rgbw baseColor, f0, openO, openAverage, diffuseColor, laterColor; // laterColor: of L(wo) L(wi)
    Float diffuseO;                                                   // chance of the cosine lobes: diffuse, and what later facets send
    Float laterAverage, lossO;                                        // mean albedo of a white facet; 1 - that seen from wo
    Vec3w wo;
    const float* columns;
    Int column;

    // Of the materials whose records begin at these floats of the table; the colours as they are there.
    CHIARO_LANE Int load(const float* records, const float* albedos, const uint32_t* at, Mask m) noexcept {
        Float bits;
        loadFour(records, at, baseColor.c[0], baseColor.c[1], baseColor.c[2], bits);
        const Int flags = floatAsBits(bits);
        const auto has = [&](uint32_t flag) { return m & ((flags & Int(flag)) != Int(0u)); };
        alpha = metallic = f90 = glass = Float(0.f);
        ior = coat = Float(1.f);
        f0 = Rgbw(Float(0.f));
        openAverage = Rgbw(Float(1.f));
        if (any(has(WideMaterial::lobes))) { // else there is nothing but a diffuse base
            loadFour(records + 4, at, alpha, ior, metallic, f90);
            loadFour(records + 8, at, f0.c[0], f0.c[1], f0.c[2], coat);
            loadFour(records + 12, at, glass, openAverage.c[0], openAverage.c[1], openAverage.c[2]);
        }
        lanes = m;
        rough = has(WideMaterial::rough);
        reflects = has(WideMaterial::reflects);
        straight = has(WideMaterial::straight);
        refracted = has(WideMaterial::refracted);
        thin = has(WideMaterial::thin);
        coated = has(WideMaterial::dielectric); // for the moment
        glossy = rough & reflects;
        later = has(WideMaterial::compensated);
        laterAverage = Float(1.f);
        if (any(later)) {
            Float unused[3];
            loadFour(records + 20, at, laterAverage, unused[0], unused[1], unused[2]);
        }
        columns = albedos;
        return flags;
    }
    // Where no lane has a lobe beside its diffuse base: then the compiler knows it too.
    CHIARO_LANE void diffuseAlone() noexcept { rough = reflects = straight = refracted = thin = coated = glossy = later = Mask(); }
    // With the base colour as it is now. record: of column in WideMaterial.
    CHIARO_LANE void look(const Vec3w& woLocal, Mask outsideLanes, Int albedo) noexcept {
        wo = {woLocal.x, woLocal.y, max(woLocal.z, Float(1e-7f))};
        outside = outsideLanes;
        column = albedo;
        diffuseColor = baseColor * coat;
        diffuse = lanes & notBlack(diffuseColor);
        coated = coated & diffuse;
        openO = Rgbw(Float(1.f));
        laterColor = Rgbw(Float(0.f));
        lossO = Float(0.f);
        later = later & lanes;
        if (const Mask tabled = coated | later; any(tabled)) {
            const Albedo e = albedoAt(wo.z, tabled);
            openO = select(coated, open(e), openO);
            if (any(later)) {
                lossO = select(later, max(Float(1.f) - e.one, Float(0.f)), Float(0.f));
                for (std::size_t i = 0; i < 3; ++i) {
                    const Float mean = baseColor.c[i] + (Float(1.f) - baseColor.c[i]) * Float(1 / 21.f);
                    laterColor.c[i] = select(later, metallic * laterFacets(mean, laterAverage), Float(0.f));
                }
            }
        }
        diffuseO = select(diffuse, Float(1.f), Float(0.f));
        const Mask mixed = (diffuse | later) & (reflects | straight | refracted);
        if (none(mixed)) return;
        const Split s = split(wo.z);
        const Float base = average(select(diffuse, diffuseColor * openO, Rgbw(Float(0.f)))) + average(laterColor) * laterEnergy(),
                    rest = average(s.r + s.t), chance = base / (base + rest);
        const Float bounded = select(rough, min(chance, Float(0.95f)), chance);
        diffuseO = select(mixed & (base + rest > Float(0.f)), bounded, diffuseO);
    }
    CHIARO_LANE Mask others() const noexcept { return lanes & (reflects | straight | refracted); } // that are not diffuse alone
    CHIARO_LANE Mask smooth() const noexcept { return diffuse | glossy; }

    // What later facets send in all, over laterColor.
    CHIARO_LANE Float laterEnergy() const noexcept { return lossO * (Float(pi) * (Float(1.f) - laterAverage)); }

    struct Albedo {
        Float one, shape;
    };
    CHIARO_LANE Albedo albedoAt(Float mu, Mask m) const noexcept {
        const Float mirror = dielectricShape(mu, ior);
        Albedo e{Float(1.f), mirror};
        const Mask tabled = m & rough;
        if (none(tabled)) return e;
        const Float x = min(AlbedoColumns::place(mu, alpha), Float(1.f)) * Float(float(AlbedoColumns::count - 1));
        const Float whole = min(floor(x), Float(float(AlbedoColumns::count - 2))), f = x - whole;
        alignas(64) uint32_t at[laneCount];
        select(tabled, column + (truncated(whole) << 1), Int(0u)).store(at);
        Float one0, q0, one1, q1;
        loadFour(columns, at, one0, q0, one1, q1);
        const Float one = one0 + (one1 - one0) * f, q = q0 + (q1 - q0) * f;
        const Float shape = one * min(Float(1.f), Float(1.f) - q * AlbedoColumns::guess(mu, alpha, ior));
        const Float margin(AlbedoColumns::margin);
        e.one = select(tabled, min(one + margin, Float(1.f)), e.one);
        e.shape = select(tabled, min(shape + margin, Float(1.f)), e.shape);
        return e;
    }
    CHIARO_LANE Rgbw open(const Albedo& e) const noexcept {
        Rgbw r;
        for (std::size_t i = 0; i < 3; ++i) r.c[i] = max(Float(1.f) - (f0.c[i] * (e.one - e.shape) + f90 * e.shape), Float(0.f));
        return r;
    }
    struct Split {
        Rgbw r, t;
    };
    CHIARO_LANE Rgbw curve(Float exact, Float normal) const noexcept {
        const Float shape = select(f90 == Float(0.f), Float(0.f), (exact - normal) / (Float(1.f) - normal));
        Rgbw r;
        for (std::size_t i = 0; i < 3; ++i) r.c[i] = max(f0.c[i] + (f90 - f0.c[i]) * shape, Float(0.f));
        return r;
    }
    CHIARO_LANE Split split(Float cosTheta) const noexcept {
        const Float schlick = schlickShape(cosTheta), one(1.f);
        Split s{Rgbw(Float(0.f)), Rgbw(Float(0.f))};
        for (std::size_t i = 0; i < 3; ++i) {
            const Float metal = baseColor.c[i] * metallic;
            s.r.c[i] = metal + (metallic - metal) * schlick;
        }
        if (none(lanes & (coat + glass != Float(0.f)))) return s;
        const Float normal = fresnelNormal(ior);
        const Rgbw front = curve(fresnelDielectric(cosTheta, ior), normal);
        s.r += front * coat;
        const Mask glassy = lanes & (glass != Float(0.f));
        if (none(glassy)) return s;
        Rgbw f = front;
        for (Float& x : f.c) x = select(thin, paneReflectance(x), x);
        if (const Mask leaving = andNot(andNot(glassy, thin), outside); any(leaving)) {
            const Float exact = fresnelDielectric(cosTheta, fault(Fault::totalReflectionMissing) ? ior : one / ior);
            const Rgbw back = select(exact == one, Rgbw(one), curve(exact, normal));
            f = select(leaving, back, f);
        }
        s.r += f * glass;
        s.t = select(glassy, (baseColor * glass) * (Rgbw(one) - f), s.t);
        return s;
    }
    // Of reflection against transmission.
    CHIARO_LANE Float reflectionChance(const Split& s) const noexcept {
        const Float r = average(s.r), t = average(s.t);
        const Float chance = select(r + t > Float(0.f), r / (r + t), Float(1.f));
        return select(straight | refracted, select(reflects, chance, Float(0.f)), Float(1.f));
    }

    // apart: takes the glossy lobes, f the diffuse one alone; null: f has both.
    CHIARO_LANE WideLobeValue evaluate(const Vec3w& wi, Rgbw* apart = nullptr) const noexcept {
        WideLobeValue v{Rgbw(Float(0.f)), Float(0.f)};
        const Mask there = smooth() & (wi.z > Float(0.f));
        Rgbw openI(Float(1.f));
        Float lossI(0.f);
        if (const Mask tabled = (coated | later) & there; any(tabled)) {
            const Albedo e = albedoAt(wi.z, tabled);
            openI = open(e);
            lossI = max(Float(1.f) - e.one, Float(0.f));
        }
        const Float inversePi((fault(Fault::diffuseBias) ? 1.01f : 1.f) / pi);
        const bool layered = any(coated) && !fault(Fault::coatAdded);
        for (std::size_t i = 0; i < 3; ++i) {
            Float f = diffuseColor.c[i] * inversePi;
            if (layered) f = select(coated, f * (openO.c[i] * openI.c[i] / max(openAverage.c[i], Float(1e-6f))), f);
            v.f.c[i] = select(diffuse, f, Float(0.f));
        }
        Rgbw& mirrored = apart ? *apart : v.f;
        if (apart) *apart = Rgbw(Float(0.f));
        if (any(later & there)) mirrored = select(later, mirrored + laterColor * (lossO * lossI), mirrored);
        v.pdfW = diffuseO * cosineHemispherePdfW(wi.z);
        if (any(glossy & there)) {
            const Ggx<Float> ggx{alpha, alpha};
            const Vec3w h = normalize(wo + wi);
            const Float c = dot(wo, h), d = ggx.d(h), scale = d * ggx.visibility(wo, wi) * Float(fault(Fault::glossyBias) ? 1.01f : 1.f);
            const Split s = split(c);
            const Float pdf = fault(Fault::visiblePdfByNormals) ? d * h.z / (Float(4.f) * c) : reflectionPdfW(ggx, wo, d);
            mirrored = select(glossy, mirrored + s.r * scale, mirrored);
            v.pdfW = select(glossy, v.pdfW + (Float(1.f) - diffuseO) * pdf, v.pdfW);
        }
        v.f = select(there, v.f, Rgbw(Float(0.f)));
        if (apart) *apart = select(there, *apart, Rgbw(Float(0.f)));
        v.pdfW = select(there, v.pdfW, Float(0.f));
        return v;
    }

    CHIARO_LANE WideLobeSample sample(Float uLobe, const Vec2w& u) const noexcept {
        WideLobeSample s{cosineHemisphere(u), (diffuse | later) & (uLobe < diffuseO), Mask(), Rgbw(Float(0.f)), Float(0.f), Mask()};
        const Mask others = andNot(lanes & (reflects | straight | refracted), s.drawn);
        if (none(others)) return s;
        if (const Mask lobe = others & glossy; any(lobe)) {
            const Ggx<Float> ggx{alpha, alpha};
            const Vec3w wi = reflect(wo, ggx.sampleVisible(wo, u));
            s.wi = select(lobe, wi, s.wi);
            s.drawn = s.drawn | (lobe & (wi.z > Float(0.f)));
        }
        const Mask exact = andNot(others, rough);
        if (none(exact)) return s;
        const Split at = split(wo.z);
        const Float chance = reflectionChance(at), left = Float(1.f) - diffuseO;
        const Mask mirror = exact & (uLobe < diffuseO + left * chance), through = andNot(exact, mirror);
        const Float eta = select(outside, ior, fault(Fault::etaRatioWhenLeaving) ? ior : Float(1.f) / ior);
        const Vec3w bent = refract(wo, Vec3w{Float(0.f), Float(0.f), Float(1.f)}, eta), beyond = select(refracted, bent, -wo);
        s.wi = select(mirror, Vec3w{-wo.x, -wo.y, wo.z}, select(through, beyond, s.wi));
        const Float inverse = select(outside, Float(1.f) / ior, ior);
        const Float squared = select(refracted, fault(Fault::etaSquaredMissing) ? Float(1.f) : sqr(inverse), Float(1.f));
        s.weight = select(mirror, at.r, at.t * squared);
        s.pmf = left * select(mirror, chance, Float(1.f) - chance);
        s.delta = exact & (s.pmf > Float(0.f)) & (mirror | (beyond.z < Float(0.f)));
        s.drawn = s.drawn | s.delta;
        s.transmitted = s.delta & through;
        return s;
    }

    // Directional albedo of all lobes together, as a denoiser wants it.
    CHIARO_LANE Rgbw albedo() const noexcept {
        const Rgbw base = select(diffuse, diffuseColor * openO, Rgbw(Float(0.f)));
        const Mask others = lanes & (reflects | straight | refracted);
        if (none(others)) return base;
        Rgbw more(Float(0.f));
        if (any(andNot(others, rough))) {
            const Split s = split(wo.z);
            more = select(rough, more, s.r + s.t);
        }
        if (any(others & rough)) {
            const Albedo e = albedoAt(wo.z, rough);
            const Rgbw left = open(e);
            Rgbw lobe;
            for (std::size_t i = 0; i < 3; ++i) {
                const Float layer = max(Float(1.f) - left.c[i], Float(0.f));
                lobe.c[i] = baseColor.c[i] * metallic * (e.one - e.shape) + metallic * e.shape + layer * (coat + glass);
                lobe.c[i] += laterColor.c[i] * laterEnergy();
            }
            more = select(rough, lobe, more);
        }
        return select(others, base + more, base);
    }
};

} // namespace chiaro::CHIARO_ISA
