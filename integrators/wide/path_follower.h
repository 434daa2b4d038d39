// PathFollower: what the loop of WidePaths keeps for one instruction set (integrators/wide/path_follow.h).
#pragma once
#include "core/scene/wide_light_sampling.h"
#include "core/scene/wide_texture_lookup.h"
#include "integrators/wide/path_packet.h"
#include "integrators/wide/path_states.h"
#include "materials/wide_lobes.h"

namespace chiaro::CHIARO_ISA {

class PathFollower {
public:
    PathFollower(const WidePaths& paths, const PathClasses& classes, const Footprint& pixel, SampleLanes& samples,
                 PathStream& stream) noexcept
        : paths_(paths), hierarchy_(WideSurfaces::hierarchy(paths.scene())), settings_(paths.settings()),
          tables_{paths.surfaces().firsts(), reinterpret_cast<const float*>(paths.surfaces().triangles()),
                  reinterpret_cast<const float*>(paths.surfaces().instances()),
                  paths.surfaces().geometries() <= laneCount ? &firsts_ : nullptr},
          materials_(reinterpret_cast<const float*>(paths.materials().records())), maxDepth_(classes.maxDepth()), pixel_(pixel),
          needs_{paths.lights().byTree(),  paths.materials().volumes(), paths.textures().filtered(),
                 paths.surfaces().moves(), paths.dispersive(),          !paths.classes().onlyDepth() || samples.layers > 1},
          wanted_{needs_.state ? &classes : nullptr, maxDepth_}, eye_(classes.eye()), rows_(paths.classes().rows()),
          oneLight_(paths.lights().finite() == 1 && !paths.lights().environment()), samples_(samples), stream_(stream),
          distantSky_(paths.settings().nee && paths.lights().sky() && paths.lights().sky()->bytes() > (std::size_t(1) << 18)
                          ? paths.lights().sky()
                          : nullptr),
          manyTriangles_(paths.surfaces().bytes() > (std::size_t(1) << 18)) {
        for (std::size_t i = 0; tables_.few && i < paths.surfaces().geometries(); ++i) firsts_[i] = paths.surfaces().firsts()[i];
        shadows_.two = samples.layers > 1 && paths.classes().sorts();
    }
    void follow(StartSource& source) noexcept;

private:
    // A vertex of sixteen paths, as far as it is known.
    struct Vertex {
        Mask hit, lanes, alone; // lanes: of the hits those that are shaded here; alone: those that the scalar closure answers for
        WidePoint at;
        WideLobes lobes;
        Int flags, column;
        Rgbw emission;
        FrameT<Float> frame;
        Vec3w ng, wo; // ng: on the side of wo
        Mask outside;
        Rgbw albedo;
        WideStates states; // of paths that have some
    };
    // Light that two kinds of lobes scatter, and the layers that it belongs to; 0: it is not wanted.
    struct Parted {
        Rgbw diffuse, glossy;
        Int diffuseLayer, glossyLayer;
    };
    void begin(const StartPacket&) noexcept;
    void traceNext(uint32_t at, uint32_t count, TracePacket&) noexcept;
    // classed: paths have states.
    template <bool classed> void group(PathPacket&, Mask, const HitPacket&, bool first) noexcept;
    void meet(PathPacket&, const HitPacket&, Vertex&) noexcept;
    template <bool plain, bool classed> void shade(PathPacket&, Mask, const HitPacket&, Vertex&, bool first) noexcept;
    void read(const PathPacket&, const HitPacket&, Mask, Vertex&) noexcept;
    void widen(PathPacket&, const HitPacket&, const Vertex&, Mask, const WideLobeSample&) noexcept;
    template <bool classed> void find(PathPacket&, Mask, const HitPacket&, Vertex&) noexcept;
    void face(PathPacket&, Vertex&) noexcept;
    template <bool classed> void direct(PathPacket&, const Vertex&, Mask, const WidePick&) noexcept;
    template <bool classed> Mask scatter(PathPacket&, const HitPacket&, const Vertex&, Mask, const WidePick&, Float uClass) noexcept;
    template <bool classed>
    Mask alone(PathPacket&, const Vertex&, const WidePick&, const WidePick&, Float uClass, Rgbw& albedo, Vec3w& normal) noexcept;
    Int sum(Int slots, Int layers) const noexcept;
    void bring(const PathPacket&, Mask, const Vec3w& o, const Vec3w& d, Float tfar, const Parted&) noexcept;
    Mask turn(const WideStates&, Mask sorted, const Rgbw& diffuse, const Rgbw& glossy, Float uClass, Rgbw& f, Int& next) noexcept;
    void tell(const PathPacket&, const HitPacket&) noexcept;
    void add(Int sums, Mask, const Rgbw&) noexcept;
    Float squaredIndex(Int medium, Mask) const noexcept;
    static void lay(const PathPacket&, RayPacket&) noexcept;

    const WidePaths& paths_;
    const Accel& hierarchy_;
    const PathSettings& settings_;
    const WideTables tables_;
    const float* const materials_;
    const uint32_t maxDepth_;
    const Footprint pixel_;
    const PathPacket::Needs needs_;
    const WidePaths::Wanted wanted_;
    const PathState eye_; // in which all paths begin
    const WideClass* const rows_;
    const bool oneLight_; // nothing to choose
    SampleLanes& samples_;
    PathStream& stream_;
    const Sky* const distantSky_; // null: none that is sampled, or small enough for the caches near the processor
    alignas(64) uint32_t firsts_[laneCount] = {};
    const bool manyTriangles_; // more than the caches near the processor hold
    TracePacket traced_[2];
    ShadowQueue shadows_;
    VertexLanes told_;
    uint32_t kept_ = 0;      // of the stream, packed
    uint32_t firstSlot_ = 0; // of the starts at hand
};

} // namespace chiaro::CHIARO_ISA
