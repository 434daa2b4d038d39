// PathLog: what one sample did, vertex by vertex, for whoever wants to see it (chiaro trace, replays, tests). Empty pointers cost one
// comparison a vertex: no picture is slower for it. Not for many samples at once: it allocates.
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
        surface, // a ray hit it and was scattered there, or ended
        light,   // a shadow ray towards a light, or a ray that found an emitter
        sky,     // the ray left the scene; p is a point on its way
        eye,     // a light path was connected to the camera
    };
    struct Vertex {
        uint32_t parent = none; // none: the camera, or the light of a light path
        Kind kind = Kind::surface;
        Vec3 p, normal;             // metres, in the compiled scene's space; the normal is the shading normal, zero where there is none
        float t = 0;                // metres from the parent
        uint32_t material = none;   // of a surface
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
    uint32_t add(const Vertex& v) {
        vertices_.push_back(v);
        return uint32_t(vertices_.size() - 1);
    }
    Vertex& operator[](uint32_t i) noexcept { return vertices_[i]; }
    const std::vector<Vertex>& vertices() const noexcept { return vertices_; }
    void clear() noexcept { vertices_.clear(); }

private:
    std::vector<Vertex> vertices_;
};

} // namespace chiaro
