// Direct light as the classics compute it: every light of the scene answers at every point, none is drawn by lot. An area light is one
// light at its centre (Lights::lamps); the environment, which has no place, takes no part. What comes back is a LightSample with the delta
// flag set and pdfW 1: its radiance is the irradiance at normal incidence, in lux. A point's answer to it is f |cos| radiance.
//
// A lamp never shadows itself. A flat mesh lies in one plane, which the shadow ray to its centre meets at its end only: it stops a rounding
// bound before. The ray into any other mesh (a bulb) goes on behind each triangle of the same mesh that it meets; everything else on its
// way, a lampshade or a socket, casts its shadow. A mesh that moves is lit from where it is in the middle of the shutter, and looked
// through like a bulb, since at other times it is elsewhere.
//
// Sources: Whitted, An Improved Illumination Model for Shaded Display, 1980; Foley, van Dam, Feiner, Hughes, Computer Graphics: Principles
// and Practice, 1990, equation 16.8 (attenuation).
#pragma once
#include "core/render/fault.h"
#include "core/render/options.h"
#include "core/scene/ray_packet.h"
#include "core/scene/scene.h"
#include <optional>
#include <span>
#include <vector>

namespace chiaro {

// How a lamp fades with the distance: by the inverse square, or as the classics have it by min(1, 1 / (c1 + c2 d + c3 d^2)), d in metres,
// with the intensity in candela taken for the illuminance in lux where this is 1. Directional lights do not fade.
struct Attenuation {
    bool physical = true;
    float c1 = 1, c2 = 0, c3 = 1;
    static Attenuation from(const Options&); // of an integrator that lists the four options below
    [[gnu::always_inline]] float at(float distance) const noexcept {
        const float sum = c1 + distance * (c2 + distance * c3);
        return sum > 1 ? 1 / sum : 1;
    }
};

inline constexpr OptionSpec attenuationOption{"attenuation",
                                              OptionType::choice,
                                              "physical",
                                              0,
                                              0,
                                              "physical|classic",
                                              "of lamps: 1/d^2, or min(1, 1/(c1 + c2 d + c3 d^2)), d in metres"},
    c1Option{"c1", OptionType::real, "1", 0, 1e9, "", "of attenuation=classic"},
    c2Option{"c2", OptionType::real, "0", 0, 1e9, "", "of attenuation=classic, 1/m"},
    c3Option{"c3", OptionType::real, "1", 0, 1e9, "", "of attenuation=classic, 1/m2"};

// From a point to the centre of a mesh.
struct LampWay {
    Vec3 wi;          // unit
    float factor = 0; // of the lamp's intensity: illuminance at normal incidence
    bool arrives = false;
    Vec3 start, d; // of the shadow ray: it ends a rounding bound before the lamp and begins one before the surface
    float left = 0;
};
// A lamp that is a mesh, as straight-line code: for one point or for a loop over many.
struct MeshLamp {
    Vec3 centre, normal; // normal: of a flat one
    bool flat = false, doubleSided = false;
    float margin = 0; // metres
    Attenuation attenuation;
    template <bool physical, bool isFlat> [[gnu::always_inline]] LampWay way(const Vec3& p, const Vec3& ng, float reach) const noexcept {
        const Vec3 out = centre - p;
        const float distanceSquared = lengthSquared(out), distance = std::sqrt(distanceSquared);
        LampWay w;
        w.wi = out * (1 / distance);
        w.factor = physical ? 1 / distanceSquared : attenuation.at(distance);
        float towards = 0;
        if constexpr (isFlat) {
            towards = dot(w.wi, normal);
            w.factor *= doubleSided ? std::fabs(towards) : -towards;
        }
        w.arrives = (distance > 0) & (!isFlat | (w.factor > 0));
        const float turn = towards > 0 ? -margin : margin, off = dot(out, ng) < 0 ? -reach : reach;
        w.start = p + ng * off;
        w.d = (isFlat ? centre + normal * turn : centre + -w.wi * margin) - w.start;
        w.left = length(w.d);
        const float scale = 1 / w.left;
        w.d = w.left > 0 ? w.d * scale : w.wi;
        return w;
    }
};

class LocalLights {
public:
    LocalLights() = default;
    explicit LocalLights(const Scene&, const Attenuation& = {});

    uint32_t count() const noexcept { return uint32_t(lamps_.size()); } // of the lamps that shine
    const Lamp& lamp(uint32_t i) const noexcept { return lamps_[i]; }
    // What lamp i sends to this point if nothing is in the way; empty: nothing.
    std::optional<LightSample> towards(uint32_t i, const SurfacePoint& from) const noexcept;
    // Is something in the way? The shadow rays of samples that lamp i gave, best of neighbouring points.
    void occluded(uint32_t i, std::span<const Ray>, std::span<uint8_t> answers) const noexcept;
    void occluded(uint32_t i, const RayPacket&, std::span<uint8_t> answers) const noexcept; // a ray of negative tfar is none
    const MeshLamp& mesh(uint32_t i) const noexcept { return meshes_[i]; }
    // Is what was hit a part of lamp i?
    bool own(uint32_t i, const Hit&) const noexcept;

private:
    bool hidden(uint32_t i, Ray) const noexcept;
    std::optional<LightSample> fromMesh(uint32_t i, const SurfacePoint& from) const noexcept;
    std::optional<LightSample> fromPunctual(const Lamp&, const SurfacePoint& from) const noexcept;

    bool onlyAtItsEnd(uint32_t i) const noexcept;

    const Scene* scene_ = nullptr;
    std::vector<Lamp> lamps_;
    std::vector<MeshLamp> meshes_; // one a lamp, of no meaning for those that are no mesh
    Attenuation attenuation_;
    bool moves_ = false;
    float margin_ = 0; // metres: bound of the rounding of any position in the scene
};

} // namespace chiaro
