// Bsdf: the closure of one hit, seen from wo. Every integrator asks the same four questions: what does it scatter towards wi (evaluate),
// which wi is worth following (sample), with which density would you have found it (the pdfs), and which exact mirror and refraction
// directions are there (deltaSplit). A few lobes on the stack, no heap, no virtual call.
//
// Conventions: wo and wi leave the surface, in world space. f is without the cosine, 1/sr, smooth lobes only: a delta lobe evaluates to
// zero. pdfW is per steradian and belongs to the whole mixture of smooth lobes and delta lobes; pdfReverseW is the density of sampling wo
// having come from wi. A sample's weight is f |cos| / pdf, for a delta lobe the lobe's reflectance divided by its pmf. With
// Transport::radiance a transmitted f is that of the basic radiance's camera side (eta squared, Veach 1997 section 5.2); shading-normal
// corrections (Veach 1997, section 5.3) live here too, so that no integrator can forget them: where importance travels, f is that of the
// camera path which takes the same way backwards, times |wo.ns| |wi.ng| / (|wo.ng| |wi.normal()|).
//
// Who has no use for the densities of the reverse says so where the closure is made: they take up to a third of an evaluation.
//
// Where smooth glass disperses, a refracted sample has picked a wavelength: its weight has one channel left, and shade() at the next hits
// wants to know it (BsdfSample::lambda). Whoever forgets it stays unbiased, but the next refraction picks again. deltaSplit() lists one
// branch for each channel, at the middle of its band, with the weight of that channel alone: no dice, three colours for a rainbow.
#pragma once
#include "core/math/ray.h"
#include "core/render/events.h"
#include "core/scene/scene.h"
#include "materials/layers.h"
#include <optional>

namespace chiaro {

enum class Terms : uint8_t { together, apart };

struct BsdfTerm {
    Spectrum f;
    Event event = Event::DR;
};
// One term, or diffuse and glossy apart where the path classes tell them apart.
struct BsdfValue {
    BsdfTerm terms[2];
    uint8_t n = 0;
    float pdfW = 0, pdfReverseW = 0;
    const BsdfTerm* begin() const noexcept { return terms; }
    const BsdfTerm* end() const noexcept { return terms + n; }
    Spectrum f() const noexcept { return n == 0 ? Spectrum(0) : n == 1 ? terms[0].f : terms[0].f + terms[1].f; }
};
struct BsdfSample {
    Vec3 wi;
    Spectrum weight;
    float pdfW = 0, pdfReverseW = 0; // of a delta lobe: the pmf of choosing it
    bool delta = false;
    Event event = Event::DR;
    Wavelengths lambda = {}; // of a refraction that picked one; else none
    // What the path carries on.
    Wavelengths after(const Wavelengths& before) const noexcept { return lambda.hero > 0 ? lambda : before; }
};
struct DeltaBranch {
    Vec3 wi;
    Spectrum weight;
    Event event = Event::SR;
};
struct DeltaBranches {
    union {               // the first n are begun
        DeltaBranch b[5]; // two mirrors, and a refraction for each channel
    };
    int n = 0;
    DeltaBranches() noexcept {}
    const DeltaBranch* begin() const noexcept { return b; }
    const DeltaBranch* end() const noexcept { return b + n; }
};

struct ClosureRecord;

class Bsdf {
public:
    // ng: geometric normal of the front side; ns: shading normal on the same side (normal map applied).
    // Densities::forward: pdfReverseW is not asked for; it means nothing then, and costs nothing.
    Bsdf(const BsdfParameters&, const Vec3& ng, const Vec3& ns, const Vec3& wo, Transport = Transport::radiance,
         Densities = Densities::both) noexcept;

    // Of a material whose closures share what they can; it lives longer.
    Bsdf(const ClosureRecord&, const Vec3& ng, const Vec3& ns, const Vec3& wo, Transport, Densities) noexcept;

    BsdfValue evaluate(const Vec3& wi, Terms = Terms::together) const noexcept;
    std::optional<BsdfSample> sample(float uLobe, Point2 u) const noexcept;
    DeltaBranches deltaSplit() const noexcept;
    bool smooth() const noexcept;                            // has a lobe that evaluate() answers for
    Spectrum albedo() const noexcept;                        // directional-hemispherical, as a denoiser wants it
    Spectrum diffuseAlbedo() const noexcept;                 // of the diffuse lobe, coat attenuation included
    const Vec3& normal() const noexcept { return frame_.z; } // the shading normal in use, on the side of wo

private:
    // Importance over a shading normal that is not the geometric one: what the closure of the camera path that comes along wi is made from.
    struct Adjoint {
        BsdfParameters parameters;
        Vec3 ns, coat, wo; // ns and the coat's normal on the side of wo by the geometric normal
        bool outside = true;
    };
    // Which normals the closure uses, on the side of wo.
    struct Pose {
        Vec3 ng, n, coat, ns;
        bool outside = true, adjoint = false;
        Pose(const BsdfParameters&, const Vec3& ng, const Vec3& ns, const Vec3& wo, Transport) noexcept;
    };
    Bsdf(const BsdfParameters&, const SharedClosure&, const Pose&, const Vec3& wo, Transport, Densities) noexcept;
    static Frame frameAbout(const Vec3& n, const BsdfParameters&) noexcept;
    bool sides(const Vec3& wi, const Vec3& local) const noexcept;
    BsdfValue matt(const Vec3& wi, float cosine) const noexcept;
    BsdfValue evaluateAdjoint(const Vec3& wi, Terms) const noexcept;
    std::optional<BsdfSample> sampleAdjoint(const LobeSample&) const noexcept;
    float correction(const Vec3& wi) const noexcept;
    Vec3 swapped(const Vec3& w) const noexcept;

    Frame frame_; // about the shading normal, z on the side of wo
    Vec3 ng_;     // on the side of wo
    Densities densities_ = Densities::both;
    std::optional<Adjoint> adjoint_;
    LobeStack lobes_;
};

// The closure at a hit: textures read, normal map applied, back faces turned. footprint: of the ray that came.
Bsdf shade(const Scene&, const SurfacePoint&, const Vec3& wo, const Footprint&, Wavelengths&, Transport = Transport::radiance,
           Densities = Densities::both) noexcept;

// What the inside of a solid lets through over a segment that leaves `from` towards wi and ends after distance metres at `to` (null: none).
// KHR_materials_volume: T = attenuationColor^(distance / attenuationDistance). The medium is that behind the back face at either end, so a
// segment and its reverse agree.
Spectrum segmentTransmittance(const Scene&, const SurfacePoint* from, const Vec3& wi, const SurfacePoint* to, float distance) noexcept;

} // namespace chiaro
