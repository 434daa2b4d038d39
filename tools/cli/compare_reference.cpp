#include "tools/cli/compare_reference.h"
#include "core/math/vec.h"
#include "tools/cli/agree_settings.h"
#include "tools/cli/console.h"
#include "tools/cli/film_picture.h"
#include "tools/cli/version.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <xxhash.h>

namespace chiaro::cli {
namespace {

constexpr uint64_t firstSeed = uint64_t(1) << 62; // compare's own --seed stays below 2^31
constexpr uint32_t wantedReplicas = 16, leastReplicas = 4, mostReplicas = 512;

// All rays of a few pixels say what the view is: camera, lens, shutter, filter and sampler.
uint64_t hashOfRays(const Job& job) {
    uint64_t hash = 0;
    constexpr uint32_t steps = 8, samples = 2;
    const Job fixed{{job.scene, job.classes, job.shutter, 1, job.sampler, job.run, job.stop, job.progress, job.notes, job.memoryLimit},
                    job.view,
                    nullptr};
    const Rect& r = job.view.crop;
    for (uint32_t i = 0; i < steps * steps * samples; ++i) {
        const uint32_t x = r.x0 + (i % steps) * (r.width() - 1) / (steps - 1),
                       y = r.y0 + (i / steps % steps) * (r.height() - 1) / (steps - 1);
        const PathStart start = startPixel(fixed, {x, y}, i / (steps * steps));
        const float values[] = {start.ray.o.x, start.ray.o.y, start.ray.o.z, start.ray.d.x, start.ray.d.y, start.ray.d.z, start.ray.time};
        hash = XXH3_64bits_withSeed(values, sizeof values, hash);
    }
    return hash;
}

std::string keyOf(const Job& job, const PathClasses& classes) {
    const Rect& r = job.view.crop;
    const std::string text =
        fmt::format("{} {} {} {:016x} {}x{} {},{},{},{} rays {:016x} classes {:016x} depth {} sampler {} filter {} isa {}", referenceName,
                    version, commit, job.scene.hash(), job.view.width, job.view.height, r.x0, r.y0, r.x1, r.y1, hashOfRays(job),
                    classes.hash(), classes.maxDepth(), int(job.sampler), int(job.view.filter.kind()), job.scene.isa());
    const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

} // namespace

ReferenceSums::ReferenceSums(uint32_t width, uint32_t height, uint32_t spp)
    : spp_(spp), mean_(std::size_t(width) * height * 3), m2_(mean_.size()), luminance_(width, height) {}

void ReferenceSums::add(const judge::Picture& p, double seconds, uint64_t dropped) {
    luminance_.add(p);
    const double n = replicas();
    for (std::size_t i = 0; i < mean_.size(); ++i) {
        const double delta = double(p.rgb[i]) - mean_[i], mean = mean_[i] + delta / n;
        m2_[i] = float(m2_[i] + delta * (p.rgb[i] - mean));
        mean_[i] = float(mean);
    }
    seconds_ += seconds;
    dropped_ += dropped;
}

judge::Picture ReferenceSums::picture() const {
    judge::Picture p{width(), height(), mean_, {}, "reference", {}};
    const double n = replicas();
    if (n < 2) return p;
    for (const float v : m2_) p.error.push_back(float(std::sqrt(v / (n * (n - 1)))));
    return p;
}

double ReferenceSums::noise() const {
    const double n = replicas();
    if (n < 2) return std::nan("");
    const judge::Replicates::State s = luminance_.state();
    double error = 0, mean = 0;
    for (std::size_t i = 0; i < s.mean.size(); ++i) {
        error += std::sqrt(s.m2[i] / (n * (n - 1)));
        mean += s.mean[i];
    }
    return error / mean;
}

bool ReferenceGoal::reached(const ReferenceSums& s) const {
    if (s.replicas() < 2) return false;
    if (std::isfinite(seconds)) return s.seconds() >= 0.9 * seconds;
    if (std::isfinite(samples)) return s.samples() >= samples;
    const double now = s.noise();
    return s.replicas() >= leastReplicas && !(now > noise);
}

std::string ReferenceGoal::text() const {
    if (std::isfinite(seconds)) return duration(seconds);
    return std::isfinite(samples) ? fmt::format("{:.0f} samples a pixel", samples) : "noise " + percent(noise);
}

ReferenceRender::ReferenceRender(const Job& job, const PathClasses& classes, const ReferenceGoal& goal,
                                 std::optional<std::filesystem::path> cache, Diagnostics& notes)
    : job_(job), classes_(classes), goal_(goal), notes_(notes), choice_(chooseIntegrator(referenceName)), key_(keyOf(job, classes)) {
    if (!cache) return;
    file_ = *cache / (key_ + referenceEnding);
    std::error_code ignored;
    if (!std::filesystem::exists(file_, ignored)) return;
    try {
        sums_ = ReferenceSums::read(file_, key_, job.view.crop.width(), job.view.crop.height());
        fromCache_ = true;
        markUsed(file_);
    } catch (const std::exception& e) {
        notes_.warn(fmt::format("{}: {}; the reference is rendered again", file_.string(), e.what()));
        sums_.reset();
    }
}

// A power of two, for the sequence's sake, of which there are about wantedReplicas.
uint32_t ReferenceRender::plannedSpp(double perSample) const {
    double samples = goal_.samples;
    if (std::isfinite(goal_.seconds)) samples = goal_.seconds / std::max(perSample, 1e-9);
    if (!std::isfinite(samples)) samples = goal_.expected;
    return std::bit_floor(uint32_t(std::clamp(samples / wantedReplicas, 1.0, 1e6)));
}

double ReferenceRender::missingSamples() const {
    if (complete()) return 0;
    return std::max(0.0, (std::isfinite(goal_.samples) ? goal_.samples : goal_.expected) - (sums_ ? sums_->samples() : 0));
}

double ReferenceRender::missingSeconds(double perSample) const {
    if (complete()) return 0;
    return std::isfinite(goal_.seconds) ? std::max(0.0, goal_.seconds - (sums_ ? sums_->seconds() : 0)) : missingSamples() * perSample;
}

void ReferenceRender::render(StopToken& stop, Course& course, double perSample) {
    if (complete()) return;
    const uint32_t planned = plannedSpp(perSample);
    if (sums_ && planned > 64 * sums_->spp()) sums_.reset(); // topping up would take too many pictures
    if (!sums_) {
        sums_.emplace(job_.view.crop.width(), job_.view.crop.height(), planned);
        fromCache_ = false;
    }
    bool added = false;
    while (!goal_.reached(*sums_) && sums_->replicas() < mostReplicas && !stop.cancelled()) {
        // One more may end beyond the goal by half of itself.
        if (const double n = sums_->replicas(); n >= leastReplicas && sums_->seconds() * (1 + 0.5 / n) > goal_.seconds) break;
        const Job job{{job_.scene, classes_, job_.shutter, firstSeed + sums_->replicas(), job_.sampler, job_.run, job_.stop, course,
                       job_.notes, job_.memoryLimit},
                      job_.view,
                      nullptr};
        Film film({.width = job.view.width,
                   .height = job.view.height,
                   .crop = job.view.crop,
                   .layers = {},
                   .splats = choice_.entry->traits(choice_.options).splats});
        const auto integrator = choice_.entry->make(choice_.options);
        course.begin({double(sums_->spp()), sums_->spp() * perSample, double(sums_->spp()), infinity});
        const RenderResult result = chiaro::render(job, *integrator, film, {sums_->spp(), infinity}, stop);
        course.end();
        if (result.ended == Ended::stopped) break;
        sums_->add(judgedPicture(film, "reference"), result.seconds, film.dropped());
        added = true;
    }
    if (added) store();
}

void ReferenceRender::store() {
    if (file_.empty()) return;
    try {
        std::filesystem::create_directories(file_.parent_path());
        sums_->write(file_, key_);
    } catch (const std::exception& e) {
        notes_.warn(fmt::format("the reference could not be kept: {}. Give another folder with --cache DIR, or --cache none", e.what()));
        return;
    }
    try {
        boundCache(file_.parent_path(), mostCached, file_);
    } catch (const std::exception& e) { notes_.warn(e.what()); }
}

} // namespace chiaro::cli
