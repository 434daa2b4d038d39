// Gather: the light that arrives at a site, as an integrator believes it. Three estimates:
//   gather  E = direct + pi mean of L(wi) over directions distributed by the cosine about the shading normal: direct light by sampling the
//           lights (Lights::sampleTowards), L what the integrator answers along the ray, light sources seen directly left out of it (path
//           classes "L .+ E", one scattering fewer than asked for, since the site is one), so that nothing is counted twice.
//   look    E = pi L / albedo: L what the integrator answers along a ray that looks straight at the site. What a method knows of the very
//           surface (the photons there, its patch, its ambient term) is baked; noise divides by the albedo.
//   view    as look, for pictures that are no light (ambient occlusion): the value itself is baked, as if it were E / pi.
// Units: E in lux (lm/m2 a channel), radiance in cd/m2. One sample is one point of the site, one light sample, one ray.
#pragma once
#include "core/render/integrator.h"
#include "tools/bake/sites.h"

namespace chiaro::bake {

enum class Estimate : uint8_t { gather, look, view };
struct GatherSettings {
    Estimate estimate = Estimate::gather;
    bool direct = true, indirect = true; // of gather
};

// Sums of one site: the same bits for any number of threads and any cut into passes.
struct SiteSum {
    Rgb<double> irradiance{0.0}, outgoing{0.0}; // outgoing: what leaves by reflection, spread evenly, and by the surface's own light
    double opacity = 0;
    double half[2] = {};            // luminance of the irradiance, even and odd samples
    uint32_t next = 0, dropped = 0; // samples so far; those of them that were not finite
    uint32_t counted[2] = {};       // kept, even and odd
    uint32_t rays = 0, backs = 0;   // rays into the scene; those that met the back of a surface that has none
    bool shines = false;            // has light of its own
    double kept() const noexcept { return double(counted[0]) + counted[1]; }
};

class Gather {
public:
    // The job's classes are those of the rays (raysOf).
    Gather(const Job&, const CameraIntegrator&, const GatherSettings&);
    // Takes the sums of the sites from where they stand to `end` samples.
    void samples(const Sites&, std::size_t firstSite, std::span<SiteSum>, uint32_t end) const;

private:
    struct Point;
    struct Room;
    void take(const Sites&, std::size_t site, uint32_t sample, Room&) const;
    void trace(Room&) const;
    void settle(const Point&, const Outputs&, SiteSum&) const;
    bool seesBack(const Ray&, const Hit&) const noexcept;

    const Job& job_;
    const CameraIntegrator& integrator_;
    GatherSettings settings_;
    float height_; // of the eye over a site that is looked at, metres
};

// The light paths that the rays may bring, for a bake of so many scatterings; none: no ray is worth tracing.
std::optional<PathQuery> raysOf(Estimate, uint32_t maxDepth);

} // namespace chiaro::bake
