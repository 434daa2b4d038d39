// Lights: every emitter of the scene behind one set of questions. Whoever samples a light learns with which density the other strategies
// would have found the same path, so that weights can be formed (Veach and Guibas 1995). Particles leave lights in proportion to power, by
// an alias table; towards a point a light tree chooses (core/scene/light_tree.h), where there are more than a few.
// Units: point and spot intensity cd, directional lux, emissive surfaces and environment cd/m2.
#pragma once
#include "core/math/distribution.h"
#include "core/math/ray.h"
#include "core/math/sampler.h"
#include "core/render/events.h"
#include "core/scene/desc.h"
#include "core/scene/light_tree.h"
#include "core/scene/sky.h"
#include <optional>
#include <span>
#include <string>

namespace chiaro {

class Scene;
struct SurfacePoint;

struct LightSample {
    Spectrum radiance; // unshadowed, as it arrives: multiply by f |cos| / pdfW. For a delta light: irradiance at normal incidence
    Vec3 wi;           // towards the light
    Ray shadow;        // trace it with Scene::occluded
    float pdfW = 0;    // with the choice of the light in it; for a delta light the pmf of that choice
    bool delta = false;
    LightKind kind = LightKind::area;
    uint32_t light = ~0u;
};
// Radiance found by hitting (or missing into) a light, and the density with which sampleTowards(from) would have found that direction.
struct LightHit {
    Spectrum radiance;
    float pdfW = 0;
    LightKind kind = LightKind::area;
    explicit operator bool() const noexcept { return !black(radiance); }
};

// A ray that leaves a light, as particle methods begin their paths: drawn in proportion to the power of the light and, as far as that is
// known, to what it sends from where to where.
struct LightEmission {
    Ray ray;
    Spectrum flux;            // Le |cos| / (pmf pdfA pdfW), lumen: what the particle carries if it is the only one
    float pmf = 0;            // of choosing the light
    float pdfA = 0, pdfW = 0; // of the position, per square metre, and of the direction, per steradian; 1 for what is fixed
    float cosine = 1;         // at the emitter; 1 where it has no surface
    LightKind kind = LightKind::area;
    uint32_t light = ~0u;
};
// With which densities the strategies would have found the same emission: emit(), and sampleTowards() from the other end.
struct EmissionPdf {
    float pmf = 0, pdfA = 0, pdfW = 0; // of emit()
    float pdfDirectW = 0;              // of sampleTowards(), per steradian at the receiver, choice included; 0 without a receiver
};

// A light as the classics see it: one position, and what goes out from it. The triangles of one emissive mesh are one lamp.
struct Lamp {
    LightKind kind = LightKind::area;
    Vec3 centre;                   // of its area; of the light itself where it is punctual
    Vec3 normal;                   // of a flat mesh; zero: shines everywhere alike
    Spectrum intensity;            // cd along the normal, or everywhere; of a directional light, lux
    bool doubleSided = false;      // of a flat mesh
    uint32_t first = 0, count = 1; // its lights: numbers for sampleOne
};

struct LightInfo {
    std::string name; // of the light or of its material
    const char* kind; // "point", "spot", "directional", "mesh", "environment"
    double power = 0; // lumen
    uint64_t triangles = 0;
};

class Lights {
public:
    static constexpr uint32_t none = ~0u;

    // One light of all: the environment by its share of the power; of the others about in proportion to what they bring to the point
    // (byTree()), or where they are few to their power. uPick: a number with 32 random bits (Sampler::getPick).
    std::optional<LightSample> sampleTowards(const SurfacePoint& from, double uPick, Point2 u) const noexcept;
    // This light; pdfW without the choice.
    std::optional<LightSample> sampleOne(uint32_t light, const SurfacePoint& from, double uPick, Point2 u) const noexcept;
    uint32_t count() const noexcept;
    bool hasEnvironment() const noexcept { return environment_.has_value() && !environment_->black(); }
    const Sky* sky() const noexcept { return environment_ ? &*environment_ : nullptr; }
    float pmf(uint32_t light) const noexcept;                           // of choosing it by power, as emit() does
    float pmf(uint32_t light, const SurfacePoint& from) const noexcept; // of choosing it towards a point, as sampleTowards() does
    // Emission of a surface towards wo. from: where the ray came from, null for a camera.
    LightHit hit(const SurfacePoint& emitter, const Vec3& wo, const SurfacePoint* from) const noexcept;
    LightHit miss(const Ray&, const SurfacePoint* from) const noexcept;

    // A particle: uFrom picks the light and the point on it (for the environment the point on a disc across the scene), uTowards the
    // direction.
    std::optional<LightEmission> emit(const PickAndPoint& uFrom, const PickAndPoint& uTowards, float time) const noexcept;
    // Of an emissive surface at a hit, towards wo, received at `to` (null: nowhere).
    EmissionPdf emissionPdf(const SurfacePoint& emitter, const Vec3& wo, const SurfacePoint* to) const noexcept;
    // Of the environment along a ray that missed, which left `from` (null: nowhere).
    EmissionPdf emissionPdf(const Ray&, const SurfacePoint* from) const noexcept;

    // Every light as one position; the environment, which has none, is left out. In the order of the lights.
    std::vector<Lamp> lamps() const;
    std::vector<LightInfo> describe() const;
    double power() const noexcept { return power_; } // lumen

    // An emissive triangle: the light of its number.
    struct Triangle {
        Vec3 p, e1, e2;
        float area = 0;
        Vec3 ng; // of the front
        float error = 0, power = 0;
        uint32_t geometry = 0, triangle = 0, instance = Hit::none, material = 0;
        bool doubleSided = false;
        // Of its instance, or of one that rests where the mesh deforms; the corners above are then those of the mesh itself at the opening
        // of the shutter, unmoved, the area the mean one.
        uint32_t motion = none;
    };
    // What sampleTowards() looks up, for loops over lanes that do the same for many points at once.
    bool byTree() const noexcept { return !tree_.empty(); }
    float pickEnvironment() const noexcept { return pickEnvironment_; }
    const AliasTable& byPower() const noexcept { return finite_; } // over the lights but the environment
    std::span<const Triangle> triangles() const noexcept { return triangles_; }

private:
    friend class LightsBuilder;
    friend class SceneCompiler;
    friend class WideLights; // core/scene/wide_lights.h
    struct Punctual {
        PunctualKind kind = PunctualKind::point;
        Spectrum intensity;
        Vec3 p, axis;                           // axis: the way the light goes
        float range = 0, scale = 0, offset = 0; // KHR_lights_punctual: clamp(cos * scale + offset)^2
        double power = 0;
        std::string name;
        uint32_t motion = none; // of the scene; p and axis are then those at the opening of the shutter
    };
    // Of a moving light: as it is in the world at a time, its area and front too. For one that rests, itself.
    Triangle placed(const Triangle&, float time) const noexcept;
    struct Place {
        Vec3 p, axis;
    };
    Place placeOf(const Punctual&, float time) const noexcept;
    std::optional<LightSample> sampleTriangle(const Triangle& placed, const SurfacePoint&, Point2 u) const noexcept;
    std::optional<LightSample> samplePunctual(const Punctual&, const SurfacePoint&) const noexcept;
    std::optional<LightSample> sampleEnvironment(const SurfacePoint&, double uCell, Point2 u) const noexcept;
    // Without the choice of the light: pmf is not set, flux not divided by it.
    std::optional<LightEmission> emitTriangle(const Triangle& placed, Point2 point, const PickAndPoint& uTowards,
                                              float time) const noexcept;
    LightEmission emitPunctual(const Punctual&, Point2 point, const PickAndPoint& uTowards, float time) const noexcept;
    std::optional<LightEmission> emitEnvironment(Point2 point, const PickAndPoint& uTowards, float time) const noexcept;
    // Emission of a hit on a triangle whose front and area at that time are these.
    LightHit found(const SurfacePoint& emitter, const Vec3& wo, const SurfacePoint* from, const Vec3& ng, float area) const noexcept;
    Choice choose(const SurfacePoint&, double u, float uTest) const noexcept; // of the finite lights; pmf 0: none
    Spectrum emission(const SurfacePoint&) const noexcept;

    const Scene* scene_ = nullptr;
    std::vector<Triangle> triangles_; // lights 0 .. n-1; then the punctual ones; then the environment
    std::vector<Punctual> punctual_;
    std::optional<Sky> environment_;
    double skyPower_ = 0;
    AliasTable finite_;         // over the triangles and the punctual lights
    float pickEnvironment_ = 0; // probability of the environment; the rest goes to the finite lights
    // Towards a point: the tree holds what rests at a place, the table the others (directional, moving). Empty: finite_ chooses.
    LightTree tree_;
    AliasTable outside_;
    std::vector<uint32_t> outsideLights_; // of the cells of outside_
    float pickTree_ = 1;                  // probability of the tree among the finite lights
    double power_ = 0;
};

} // namespace chiaro
