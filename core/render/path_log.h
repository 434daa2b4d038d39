// PathLog: what one sample did, vertex by vertex, for whoever wants to see it (chiaro trace, replays, tests). Empty pointers cost one
// comparison a vertex: no picture is slower for it. Not for many samples at once: it allocates.
//
// An integrator tells its path in three words: scatter() names the event that it follows from where it stands, arrive() the vertex that the
// ray led to, end() why nothing follows. A tree keeps `here` before it goes down a branch and puts it back afterwards. What is added to the
// picture is written into the vertex at which it is added, so that the contributions of a log sum to the sample.
#pragma once
#include "core/math/vec.h"
#include "core/render/events.h"
#include <cstdint>
#include <optional>
#include <vector>

namespace chiaro {

class PathLog {
public:
    static constexpr uint32_t none = ~0u;
    enum class Kind : uint8_t {
        surface,  // a ray hit it and was scattered there, or ended
        light,    // a shadow ray towards a light, or a ray that found an emitter
        sky,      // the ray left the scene; p is a point on its way
        eye,      // a light path was connected to the camera
        emission, // a light path begins here; p lies on the light
    };
    struct Vertex {
        uint32_t parent = none; // none: the camera, or the light of a light path
        Kind kind = Kind::surface;
        Vec3 p, normal;             // metres, in the compiled scene's space; the normal is the shading normal, zero where there is none
        float t = 0;                // metres from the parent
        uint32_t material = none;   // of a surface; of a blocked shadow ray, of what stood in its way
        std::optional<Event> event; // at the parent, which led here; none from a camera
        Spectrum weight{1};         // of that event: f |cos| / pdf, roulette included
        float pdfW = 0;             // of that direction per steradian, of a delta lobe its pmf
        bool delta = false;
        bool blocked = false;       // a shadow ray that did not arrive
        uint32_t light = none;      // number of the light
        Spectrum throughput{1};     // on arrival
        Spectrum contribution{0};   // what was added to the picture here
        const char* note = nullptr; // "roulette", "depth", "contribution too small": why the path ended; static text
    };
    uint32_t here = none; // the vertex at which the path stands: what arrives next hangs there

    uint32_t add(const Vertex& v) {
        vertices_.push_back(v);
        return uint32_t(vertices_.size() - 1);
    }
    // From here by this event: the vertex that arrives next was led to by it.
    void scatter(Event event, const Spectrum& weight, float pdfW, bool delta) noexcept { step_ = {event, weight, pdfW, delta}; }
    // The path stands at a new vertex now, which hangs under the old one; the rest of it may be filled in.
    Vertex& arrive(Kind kind, const Vec3& p, float t, const Spectrum& throughput) {
        Vertex v;
        v.parent = here;
        v.kind = kind;
        v.p = p;
        v.t = t;
        v.event = step_.event;
        v.weight = step_.weight;
        v.pdfW = step_.pdfW;
        v.delta = step_.delta;
        v.throughput = throughput;
        step_ = {};
        here = add(v);
        return vertices_.back();
    }
    // Why nothing follows the vertex at which the path stands.
    void end(const char* why) noexcept {
        if (here != none) vertices_[here].note = why;
    }
    Vertex& operator[](uint32_t i) noexcept { return vertices_[i]; }
    const std::vector<Vertex>& vertices() const noexcept { return vertices_; }
    void clear() noexcept {
        vertices_.clear();
        here = none;
        step_ = {};
    }

private:
    struct Step {
        std::optional<Event> event;
        Spectrum weight{1};
        float pdfW = 0;
        bool delta = false;
    };
    std::vector<Vertex> vertices_;
    Step step_;
};

struct Job;
// What an integrator offers whose paths do not begin at a pixel (light tracing, photon maps): one of its paths by number.
class PathSource {
public:
    virtual ~PathSource() = default;
    virtual void tellPath(const Job&, uint64_t number, PathLog&) const = 0;
};

} // namespace chiaro
