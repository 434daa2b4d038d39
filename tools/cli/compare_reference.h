// What everything is compared with. By itself it is the path tracer: replicas of equal samples, each with a seed of its own far from those
// that a user can name, summed up as mean and spread of every value, so that the reference knows its own standard error. It is kept between
// runs under a hash of all that decides it, used again while it is as good as asked for, and topped up by more replicas where it is not.
#pragma once
#include "core/render/render.h"
#include "integrators/registry.h"
#include "tools/cli/compare_course.h"
#include "tools/judge/replicates.h"
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

namespace chiaro::cli {

// Replicas summed up: Welford's running mean and squared deviation of every value.
class ReferenceSums {
public:
    ReferenceSums(uint32_t width, uint32_t height, uint32_t spp);
    void add(const judge::Picture&, double seconds, uint64_t dropped);
    uint32_t replicas() const noexcept { return uint32_t(luminance_.count()); }
    uint32_t spp() const noexcept { return spp_; } // of one replica
    double samples() const noexcept { return double(spp_) * replicas(); }
    double seconds() const noexcept { return seconds_; }
    uint64_t dropped() const noexcept { return dropped_; }
    uint32_t width() const noexcept { return luminance_.width(); }
    uint32_t height() const noexcept { return luminance_.height(); }
    const judge::Replicates& luminance() const noexcept { return luminance_; }
    judge::Picture picture() const; // with its standard errors, of two replicas or more
    double noise() const;           // the mean standard error of a pixel's luminance over the mean luminance; NaN while there is none

    // As a file of the cache: a line of text, a line of JSON, the numbers, and a checksum of it all. Throws Error where it cannot be
    // written.
    void write(const std::filesystem::path&, const std::string& key) const;
    // Throws Error(Exit::file) for what is damaged or belongs to another key or size.
    static ReferenceSums read(const std::filesystem::path&, const std::string& key, uint32_t width, uint32_t height);

private:
    uint32_t spp_;
    double seconds_ = 0;
    uint64_t dropped_ = 0;
    std::vector<float> mean_, m2_; // of rgb
    judge::Replicates luminance_;
};

// As good as wanted: the first limit that is finite counts.
struct ReferenceGoal {
    double seconds = infinity, samples = infinity, noise = 0;
    double expected = 256; // samples a pixel that a noise takes, about
    bool reached(const ReferenceSums&) const;
    std::string text() const; // "40 s", "512 samples a pixel", "noise 1 %"
};

class ReferenceRender {
public:
    // job: its seed and classes are not used. cache: a folder, or none.
    ReferenceRender(const Job& job, const PathClasses& classes, const ReferenceGoal& goal, std::optional<std::filesystem::path> cache,
                    Diagnostics& notes);
    bool complete() const { return sums_ && goal_.reached(*sums_); } // by what was found in the cache
    bool fromCache() const noexcept { return fromCache_; }
    double missingSamples() const; // a pixel, to the goal, about
    double missingSeconds(double perSample) const;
    // Until the goal or a stop; stores whenever something was added.
    void render(StopToken&, Course&, double perSample);
    const ReferenceSums* sums() const { return sums_ && sums_->replicas() >= 2 ? &*sums_ : nullptr; }
    const std::filesystem::path& file() const noexcept { return file_; } // in the cache; empty: not kept
    const std::string& key() const noexcept { return key_; }

private:
    uint32_t plannedSpp(double perSample) const;
    void store();

    const Job& job_;
    const PathClasses& classes_;
    ReferenceGoal goal_;
    Diagnostics& notes_;
    IntegratorChoice choice_;
    std::string key_;
    std::filesystem::path file_;
    std::optional<ReferenceSums> sums_;
    bool fromCache_ = false;
};

inline constexpr const char* referenceEnding = ".reference"; // of their files
// What a folder of references may take together, bytes.
inline constexpr uint64_t mostCached = 1'000'000'000;
// Deletes references of the folder, those used longest ago first, until the rest of them takes no more than so many bytes; `kept` stays
// in any case. Another program that deletes at the same time is no fault. Throws Error(Exit::file) where one cannot be deleted.
void boundCache(const std::filesystem::path& folder, uint64_t bytes, const std::filesystem::path& kept);
// The file counts as used now.
void markUsed(const std::filesystem::path&) noexcept;

} // namespace chiaro::cli
