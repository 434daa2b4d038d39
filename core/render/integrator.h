// The seam: what an algorithm is given and what it must do. An integrator advances a film by passes of sample indexes; the driver owns the
// loop, the clock and cancellation. Most integrators are a CameraIntegrator: one function that answers "what arrives along this ray".
#pragma once
#include "core/math/sampler.h"
#include "core/render/error.h"
#include "core/render/executor.h"
#include "core/render/film.h"
#include "core/render/path_classes.h"
#include "core/render/progress.h"
#include "core/render/view.h"
#include "core/scene/scene.h"
#include <optional>
#include <span>

namespace chiaro {

struct Work { // all that a pre-pass may use: no view
    const Scene& scene;
    const PathClasses& classes;
    Interval shutter;
    uint64_t seed = 0;
    SamplerKind sampler = SamplerKind::sobol;
    const Executor& run;
    const StopToken& stop;
    Progress& progress;
    Diagnostics& notes;
    std::size_t memoryLimit = ~std::size_t(0);
};
class Prepass;
class Writer;
class Reader;
struct Job : Work { // one render, constant from prepare to the last pass
    const View& view;
    const Prepass* prepass = nullptr; // the indirect term of the integrators that have room for one (core/render/prepass.h)
};
// The pixels that take part in a pass; null in Pass: all.
class SampleMask {
public:
    SampleMask(Rect crop, std::vector<bool> active) : crop_(crop), active_(std::move(active)) {}
    bool active(Pixel p) const noexcept { return active_[std::size_t(p.y - crop_.y0) * crop_.width() + (p.x - crop_.x0)]; }

private:
    Rect crop_;
    std::vector<bool> active_;
};
struct Pass {
    uint32_t begin = 0, end = 0; // sample indexes
    const SampleMask* active = nullptr;
};

class Integrator {
public:
    virtual ~Integrator() = default;
    virtual void prepare(const Job&) {} // pure function of the job and the options; once, before load
    virtual void render(const Job&, const Pass&, Film&) = 0;
    // What a resume cannot recompute (core/render/archive.h): the state after the passes so far.
    virtual void save(Writer&) const {}
    virtual void load(const Job&, Reader&) {}
};

struct PathStart {
    Pixel pixel;
    uint32_t sample = 0;
    Ray ray;
    Footprint footprint;
    Wavelengths lambda;
    Sampler sampler;
    Hit first;
};
// A start at any raster position (Markov chains); the time is in the ray, the first hit is traced.
PathStart startPath(const Job&, Point2 raster, Sampler) noexcept;

struct Starts {
    std::span<const Point2> pattern; // positions in the pixel, (0,0) its corner; empty: the filter decides
    float jitter = 0;                // of a pattern: the side of the square about a position in which the sample is moved at random
    bool shifted = false;            // of a pattern: moved as a whole in every pixel, at random and around its edges
    std::optional<float> time;       // one time for all; empty: over the shutter
    uint32_t width = 256;            // most starts in a batch
    bool whole = false;              // an iteration begun is finished, whatever the stop token says
};
// The start of one sample of one pixel, as the tile loop makes it: the replay of a single sample.
PathStart startPixel(const Job&, Pixel, uint32_t sample, const Starts& = {}) noexcept;
using Batch = FunctionRef<void(std::span<PathStart>, std::span<Outputs>)>;
// The only tile loop. First hits are traced 16 wide and coherent. No result depends on the size of a batch.
void forEachBatch(const Job&, const Pass&, Film&, Batch, const Starts& = {});

// Starts sixteen at a time, as a stream of paths takes them in while others end; and what the paths give, as arrays
// (core/render/wide_starts.h).
struct StartPacket;
struct SampleLanes;
class StartSource {
public:
    virtual ~StartSource() = default;
    virtual bool next(StartPacket&) noexcept = 0; // false: there are no more
};
// The same loop where batches are streams: one tile's starts, at most SampleLanes::most, and where the samples go.
using StreamBatch = FunctionRef<void(StartSource&, SampleLanes&)>;
void forEachStream(const Job&, const Pass&, Film&, StreamBatch, const Starts& = {});

class CameraIntegrator : public Integrator {
public:
    virtual void radiance(const Job&, PathStart&, Outputs&) const noexcept = 0;
    virtual void radianceWide(const Job&, std::span<PathStart>, std::span<Outputs>) const noexcept; // default: radiance() for each
    // The same for some thousands of starts, as many of which are under way at once as the integrator likes. Asked only where streams()
    // says yes for the job and the film.
    virtual void radianceWide(const Job&, StartSource&, SampleLanes&) const noexcept {}
    virtual bool streams(const Job&, const FilmLayout&) const noexcept { return false; }
    virtual Starts starts(const Job&) const { return {}; }
    void render(const Job&, const Pass&, Film&) override; // forEachBatch or forEachStream
};

} // namespace chiaro
