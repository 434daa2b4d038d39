// Light tracing: particles leave the lights, and at every surface that they reach a shadow ray asks how the camera sees it there (Arvo,
// Backward Ray Tracing, 1986; Dutre, Lafortune, Willems 1993). A particle of flux F adds F f |cos| We to the pixels about the raster
// position, We the importance that the lens emits towards the point (Camera::importance). Emission seen directly is looked up along camera
// rays. connect=off is the textbooks' forward ray tracing: nothing is aimed, and only what goes through the opening of the lens is counted.
#include "integrators/entries.h"
#include "integrators/iterations.h"
#include "integrators/light_path_ledger.h"
#include "integrators/light_walk.h"
#include <fmt/format.h>

namespace chiaro {
namespace {

constexpr OptionSpec specs[] = {
    {"rr-depth", OptionType::integer, "5", 0, 65535, "", "scatterings before Russian roulette may end a path"},
    {"connect", OptionType::boolean, "on", 0, 0, "",
     "aim at the camera from every vertex; off: count the light rays that happen to go through the lens (needs --aperture)"},
};

constexpr uint64_t chunk = 1024; // light paths of one task

// The reconstruction filter around a raster position, one axis: the density of every pixel's own samples there.
class Spread {
public:
    void make(const Filter& filter) {
        radius_ = filter.radius();
        double sum = 0;
        for (int i = 0; i < cells; ++i) {
            density_[std::size_t(i)] = float(filter.density((i + 0.5) / cells * 2 * double(radius_) - double(radius_)));
            sum += double(density_[std::size_t(i)]);
        }
        for (float& d : density_) d *= float(cells / (2 * double(radius_) * sum));
    }
    float radius() const noexcept { return radius_; }
    // Pixels whose filter reaches x, within [begin, end).
    int first(float x, uint32_t begin) const noexcept { return std::max(int(begin), int(std::floor(x - 0.5f - radius_)) + 1); }
    int last(float x, uint32_t end) const noexcept { return std::min(int(end) - 1, int(std::floor(x - 0.5f + radius_))); }
    float weight(float x, int pixel) const noexcept {
        const float at = (x - (float(pixel) + 0.5f) + radius_) * (float(cells) / (2 * radius_));
        return density_[std::size_t(std::clamp(int(at), 0, cells - 1))];
    }

private:
    static constexpr int cells = 4096;
    float radius_ = 0;
    std::array<float, cells> density_{};
};

// Where the light of one path goes: the picture, a log, or both.
struct Receiver {
    Film* film = nullptr;
    PathLog* log = nullptr;
    Half half = Half::even;
    float share = 1; // of the flux, that one path of many carries
    uint64_t landed = 0;
    bool broken = false; // it brought light that no film can hold
};

class LightTracing final : public Integrator, public PathSource, public LightPathLedger {
public:
    explicit LightTracing(const Options& o) : rouletteDepth_(uint32_t(o.integer("rr-depth"))), connect_(o.boolean("connect")) {}
    void prepare(const Job&) override;
    void render(const Job&, const Pass&, Film&) override;
    void tellPath(const Job&, uint64_t number, PathLog&) const override;
    std::optional<uint64_t> brokenPath() const override {
        const uint64_t lowest = broken_;
        return lowest == none ? std::nullopt : std::optional(lowest);
    }

private:
    static constexpr uint64_t none = ~uint64_t(0);
    void shoot(const Job&, uint32_t iteration, Film&) const;
    void follow(const Job&, uint64_t number, Receiver&) const noexcept;
    struct Aiming { // a shadow ray to the lens from every vertex
        const LightTracing& light;
        const Job& job;
        Receiver& to;
        Onward arrive(const Arrival& a, const Bsdf& bsdf, Sampler own) const noexcept {
            if (bsdf.smooth()) light.aim(job, a.at, bsdf, a.state, a.flux, own.get2D(), to);
            return Onward::any;
        }
    };
    struct Unaimed { // what goes through the lens by itself
        const LightTracing& light;
        const Job& job;
        Receiver& to;
        void flight(const Flight& f) const noexcept {
            if (f.visible) light.land(job, f.ray, f.from, f.distance, f.state, f.flux, to);
        }
        Onward arrive(const Arrival&, const Bsdf&, const Sampler&) const noexcept { return Onward::any; }
    };
    void aim(const Job&, const SurfacePoint&, const Bsdf&, PathState, const Spectrum& flux, Point2 lens, Receiver&) const noexcept;
    void land(const Job&, const Ray&, const SurfacePoint* from, float distance, PathState, const Spectrum& flux, Receiver&) const noexcept;
    bool reaches(const Job&, Point2 raster) const noexcept;
    void splat(const Job&, Point2 raster, Layer, const Spectrum&, Receiver&) const noexcept;
    void seeLights(const Job&, PathStart&, Outputs&) const noexcept;

    uint32_t rouletteDepth_;
    bool connect_;
    Spread spread_;
    mutable std::atomic<uint64_t> broken_{none}; // the lowest path that brought light which no film can hold
};

void LightTracing::prepare(const Job& job) {
    if (!connect_ && !job.view.camera.hasLens())
        throw Error(Exit::usage, "light:connect=off: no light ray meets a pinhole; give the camera an opening, such as --aperture 0.1");
    spread_.make(job.view.filter);
}

// As many light paths an iteration as the whole picture has pixels. They carry their share of the flux as a power of two, so that splats
// have the size of camera samples and their divisor, the same share of the number of paths, is exact.
uint64_t pathsAnIteration(const View& view) noexcept { return uint64_t(view.width) * view.height; }
float shareOfOne(uint64_t paths) noexcept { return std::ldexp(1.f, -int(std::bit_width(paths))); }

void LightTracing::render(const Job& job, const Pass& pass, Film& film) {
    const uint32_t begin = nextIteration(film, pass);
    uint32_t end = begin;
    for (; end < pass.end && !(end > begin && job.stop.requested()); ++end) shoot(job, end, film);
    const auto see = [&](std::span<PathStart> starts, std::span<Outputs> outputs) {
        for (std::size_t i = 0; i < starts.size(); ++i) seeLights(job, starts[i], outputs[i]);
    };
    Starts how;
    how.whole = true;
    forEachBatch(job, {begin, end, pass.active}, film, see, how);
}

void LightTracing::shoot(const Job& job, uint32_t iteration, Film& film) const {
    const uint64_t paths = pathsAnIteration(job.view), first = iteration * paths;
    const float share = shareOfOne(paths);
    std::atomic<uint64_t> landed = 0, broken = none;
    const auto task = [&](uint64_t i) {
        Receiver to{.film = &film, .share = share};
        for (uint64_t k = i * chunk; k < std::min(paths, (i + 1) * chunk); ++k) {
            to.half = Half((first + k) & 1);
            follow(job, first + k, to);
            if (to.broken) [[unlikely]]
                for (uint64_t least = broken; first + k < least && !broken.compare_exchange_weak(least, first + k);) {}
            to.broken = false;
        }
        landed += to.landed;
    };
    job.run.chunks((paths + chunk - 1) / chunk, task, nullptr);
    const uint64_t odd = (first + paths) / 2 - first / 2;
    film.lightPaths(double(paths - odd) * double(share), Half::even);
    film.lightPaths(double(odd) * double(share), Half::odd);
    if (uint64_t before = none; broken != none && broken_.compare_exchange_strong(before, broken)) // iterations come in order
        job.notes.warn(
            fmt::format("light: light path {} brings light that is not finite. Follow it: chiaro trace -i light --sample {}, with "
                        "the scene and the options of this render",
                        broken.load(), broken.load()));
    if (!connect_ && iteration == 0)
        job.notes.tell("light", fmt::format("{} of the first {} light paths landed: they went through the lens onto the picture ({:.2g} %)",
                                            landed.load(), paths, 100 * double(landed.load()) / double(paths)));
}

void LightTracing::tellPath(const Job& job, uint64_t number, PathLog& log) const {
    Receiver to{.log = &log};
    follow(job, number, to);
}

void LightTracing::follow(const Job& job, uint64_t number, Receiver& to) const noexcept {
    Sampler sampler(job.seed, job.sampler, Stream::light, number >> 32, uint32_t(number));
    const Departure start = departure(job, sampler);
    const std::optional<LightEmission> emission = job.scene.lights().emit(start.from, start.towards, start.time);
    if (!emission) return;
    const WalkRules rules{.rouletteDepth = rouletteDepth_, .log = to.log};
    const Spectrum flux = emission->flux * to.share;
    const auto walk = [&](auto visitor) { walkParticle(job, *emission, flux, sampler, rules, visitor); };
    if (connect_)
        walk(Aiming{*this, job, to});
    else
        walk(Unaimed{*this, job, to});
}

// The camera sees this point through a point of its lens.
void LightTracing::aim(const Job& job, const SurfacePoint& at, const Bsdf& bsdf, PathState state, const Spectrum& flux, Point2 lens,
                       Receiver& to) const noexcept {
    const auto camera = job.view.camera.importance(at, lens);
    if (!camera || !reaches(job, camera->raster)) return;
    const BsdfValue value = bsdf.evaluate(camera->wi, terms(job.classes, state));
    Layer layers[2] = {};
    bool wanted = false;
    for (int i = 0; i < value.n; ++i) {
        layers[i] = job.classes.meet(job.classes.light(state, value.terms[i].event), job.classes.eye());
        wanted = wanted || (layers[i] != 0 && !black(value.terms[i].f));
    }
    if (!wanted || job.scene.occluded(camera->shadow)) return;
    const Spectrum seen = flux * segmentTransmittance(job.scene, &at, camera->wi, nullptr, camera->shadow.tfar) *
                          (absDot(bsdf.normal(), camera->wi) * camera->importance);
    for (int i = 0; i < value.n; ++i) splat(job, camera->raster, layers[i], seen * value.terms[i].f, to);
    if (!to.log) return;
    PathLog::Vertex v;
    v.parent = to.log->here;
    v.kind = PathLog::Kind::eye;
    v.p = camera->shadow.o + camera->shadow.d * camera->shadow.tfar;
    v.t = camera->shadow.tfar;
    v.event = value.terms[0].event;
    v.weight = value.f() * absDot(bsdf.normal(), camera->wi);
    v.pdfW = 1; // the way to the camera is given
    v.delta = true;
    v.throughput = v.contribution = seen * value.f();
    to.log->add(v);
}

// The ray goes through the opening by itself, before it meets anything.
void LightTracing::land(const Job& job, const Ray& ray, const SurfacePoint* from, float distance, PathState state, const Spectrum& flux,
                        Receiver& to) const noexcept {
    const auto camera = job.view.camera.landing(ray);
    if (!camera || !(camera->t < distance) || !reaches(job, camera->raster)) return;
    const Layer layer = job.classes.meet(state, job.classes.eye());
    if (layer == 0) return;
    ++to.landed;
    splat(job, camera->raster, layer, flux * segmentTransmittance(job.scene, from, ray.d, nullptr, camera->t) * camera->importance, to);
}

bool LightTracing::reaches(const Job& job, Point2 raster) const noexcept {
    const Rect& r = job.view.crop;
    const float reach = spread_.radius() + 0.5f;
    return raster.x > float(r.x0) - reach && raster.x < float(r.x1) + reach && raster.y > float(r.y0) - reach &&
           raster.y < float(r.y1) + reach;
}

void LightTracing::splat(const Job& job, Point2 raster, Layer layer, const Spectrum& value, Receiver& to) const noexcept {
    if (!to.film || layer == 0) return;
    const Rect& r = job.view.crop;
    const int x1 = spread_.last(raster.x, r.x1), y1 = spread_.last(raster.y, r.y1);
    for (int y = spread_.first(raster.y, r.y0); y <= y1; ++y)
        for (int x = spread_.first(raster.x, r.x0); x <= x1; ++x)
            if (const float w = spread_.weight(raster.x, x) * spread_.weight(raster.y, y); w > 0) {
                const Spectrum v = value * w;
                to.broken = to.broken || !finite(v) || maxComponent(v) >= fixedLimit; // the film drops it
                to.film->splat({uint32_t(x), uint32_t(y)}, layer, v, to.half);
            }
}

// L E, and what a denoiser wants to know of the first hit.
void LightTracing::seeLights(const Job& job, PathStart& start, Outputs& out) const noexcept {
    const PathState eye = job.classes.eye();
    if (!start.first) {
        const LightHit sky = job.scene.lights().miss(start.ray, nullptr);
        if (connect_ && sky) addFound(out, job.classes.reached(eye, sky.kind), sky.radiance);
        out.aov(Aov::albedo, {clamp01(sky.radiance[0]), clamp01(sky.radiance[1]), clamp01(sky.radiance[2])});
        return;
    }
    const SurfacePoint at = job.scene.point(start.first, start.ray);
    const LightHit light = job.scene.lights().hit(at, -start.ray.d, nullptr);
    if (connect_ && light)
        addFound(out, job.classes.reached(eye, light.kind),
                 light.radiance * segmentTransmittance(job.scene, nullptr, start.ray.d, &at, start.first.t));
    const Bsdf bsdf = shade(job.scene, at, -start.ray.d, start.footprint.at(start.first.t), start.lambda);
    out.aov(Aov::albedo, bsdf.albedo());
    out.aov(Aov::normal, Spectrum(bsdf.normal().x, bsdf.normal().y, bsdf.normal().z));
}

Traits traits(const Options& o) {
    Traits t;
    t.covers = "L (D|G|S)* E";
    // What a camera sees in a mirror or through smooth glass cannot be aimed at; a light without extent meets no lens but by scattering.
    t.misses = o.boolean("connect") ? "L .* S E" : "Ld S* E";
    t.splats = true;
    return t;
}

} // namespace

extern const IntegratorEntry lightEntry = {
    "light", "light tracing: particles from the lights, connected to the camera", specs, traits,
    [](const Options& o) -> std::unique_ptr<Integrator> { return std::make_unique<LightTracing>(o); }};

} // namespace chiaro
