// WidePaths: the path tracer in lanes. A thread follows a stream of some hundred paths, kept as arrays: sixteen at a time they are traced,
// shaded under masks and packed together again, new ones taking the places of those that ended; shadow rays wait until sixteen are
// together. Every step is that of Path::radiance, the readable reference. What lanes cannot do (PathLanes says it) is done for one lane at
// a time by the scalar closure, in the same stream.
//
// No answer depends on which paths share a packet: a lane's arithmetic is its own, random numbers are functions of pixel, sample and
// dimension, and the sums of a sample (SampleLanes) are added to in the order of its path. Streams of any length give the same bits;
// AVX2 and AVX-512 differ by the rounding of reciprocal roots.
//
// Masks and layers are states that paths carry along (WideClasses); where a job asks for no more than a depth, none is kept. Not in lanes:
// what a sample costs, what density estimates found, independent random numbers.
#pragma once
#include "core/render/wide_classes.h"
#include "core/render/wide_starts.h"
#include "core/scene/wide_lights.h"
#include "core/scene/wide_surfaces.h"
#include "core/scene/wide_textures.h"
#include "materials/wide_materials.h"

namespace chiaro {

class Bsdf;

struct PathSettings {
    uint32_t rouletteDepth = 5;
    bool nee = true, mis = true;
    // Share of an emitter found by a BSDF sample of density pdfW; lightPdfW 0: no light sample could have found it.
    float hitWeight(bool delta, float pdfW, float lightPdfW) const noexcept;
};

// The paths under way, packed: 108 bytes each at most.
struct PathStream {
    // least: what is left of a packet and sixteen new ones have room together.
    static constexpr uint32_t least = 32, most = 4096, room = most + 32, floats = 20, words = 7;
    alignas(64) float f[floats][room];
    alignas(64) uint32_t i[words][room];
};

// A packet as the scalar helpers see it: what they are told and what they answer, lane by lane.
struct alignas(64) VertexLanes {
    static constexpr uint32_t size = RayPacket::size;
    RayPacket rays; // that led here
    HitPacket hits;
    float fromP[3][size], fromNg[3][size]; // where they began, geometric normal
    float throughput[3][size], pdfW[size]; // pdfW < 0: a delta lobe, or the camera
    float hero[size];                      // nanometres, of a path that dispersion has parted; else 0
    float width[size], spread[size];       // the footprint where the rays arrive; of the answer, where the next ones begin
    uint32_t depth[size];
    uint32_t pick[2][size]; // of a light, of a lobe: 32 random bits
    float u[2][2][size], uClass[size];
    uint32_t state[size]; // of PathClasses, where they ask for more than a depth; then those of the next rays
    static constexpr uint32_t absorbs = 0x80000000u;
    uint32_t medium[size]; // 1 + the material whose inside the ray crosses, with a bit where it attenuates; 0: outside
    // Answers.
    float light[3][size], lightPdfW[size]; // an emitter that was found
    float baseColor[3][size];
    RayPacket shadow;           // tfar < 0: none
    float arriving[2][3][size]; // of terms apart; else the first
    uint32_t layer[2][size];    // in which they do; 0: that term is not wanted
    RayPacket next;
    float albedo[3][size], normal[3][size];
};

class WidePaths {
public:
    // length: of a thread's stream. Null where this machine has no lanes, or the job is not one for them.
    static std::unique_ptr<const WidePaths> make(const Job&, const PathSettings&, uint32_t length);
    WidePaths(const Job&, const PathSettings&, uint32_t length);
    // Of all that a film may want, lanes give the picture and what denoisers want.
    static bool able(const Job&, const FilmLayout&) noexcept;
    void run(const Job&, StartSource&, SampleLanes&) const noexcept; // a job of the same classes

    const WideSurfaces& surfaces() const noexcept { return surfaces_; }
    const WideMaterials& materials() const noexcept { return materials_; }
    const WideLights& lights() const noexcept { return lights_; }
    const WideTextures& textures() const noexcept { return textures_; }
    const WideClasses& classes() const noexcept { return classes_; }
    bool dispersive() const noexcept { return dispersive_; }
    const PathSettings& settings() const noexcept { return settings_; }
    uint32_t length() const noexcept { return length_; }
    const Scene& scene() const noexcept { return scene_; }

    // For lanes of a mask: what an emitter that was hit, or the sky that was not, sends back and with which density light samples find it.
    void found(VertexLanes&, uint32_t lanes) const noexcept;
    // The base colour of textured materials.
    void texture(VertexLanes&, uint32_t lanes) const noexcept;
    // What the inside of solids lets through to here, multiplied into the throughput.
    void attenuate(VertexLanes&, uint32_t lanes) const noexcept;
    // What paths may do next: classes, or where these are null no more than scatter a number of times.
    struct Wanted {
        const PathClasses* classes;
        uint32_t maxDepth;
    };
    // A whole vertex but for emission: direct light, the next ray. The lanes that go on.
    uint32_t vertex(VertexLanes&, uint32_t lanes, const Wanted&) const noexcept;

private:
    void direct(VertexLanes&, uint32_t lane, const SurfacePoint&, const Bsdf&, const PathClasses*) const noexcept;

    const Scene& scene_;
    PathSettings settings_;
    uint32_t length_;
    WideSurfaces surfaces_;
    WideMaterials materials_;
    WideLights lights_;
    WideTextures textures_;
    WideClasses classes_;
    bool dispersive_;
};

// One for each instruction set (integrators/wide/).
using PathProgram = void(const WidePaths&, const PathClasses&, const Footprint&, StartSource&, SampleLanes&, PathStream&) noexcept;
PathProgram followPathsAvx2, followPathsAvx512;

} // namespace chiaro
