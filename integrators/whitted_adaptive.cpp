#include "integrators/whitted_adaptive.h"
#include "core/render/archive.h"
#include <algorithm>

namespace chiaro {
namespace {

struct Range {
    Spectrum low{infinity}, high{0};
    void add(const Spectrum& s) noexcept {
        for (std::size_t c = 0; c < 3; ++c) {
            low[c] = std::min(low[c], s[c]);
            high[c] = std::max(high[c], s[c]);
        }
    }
    bool beyond(float contrast) const noexcept {
        for (std::size_t c = 0; c < 3; ++c)
            if (high[c] - low[c] > contrast * (high[c] + low[c])) return true;
        return false;
    }
};

// Of a film that somebody else has begun to refine: those that have more than the first samples.
SampleMask continuedMask(const Film& film, uint32_t first) {
    const Rect& r = film.layout().crop;
    std::vector<bool> active;
    for (uint32_t y = r.y0; y < r.y1; ++y)
        for (uint32_t x = r.x0; x < r.x1; ++x) active.push_back(film.next({x, y}) > first);
    return {r, std::move(active)};
}

} // namespace

uint32_t AdaptivePasses::firstSamples(uint32_t samples) noexcept { return std::min(samples, std::max(4u, samples / 4)); }

SampleMask contrastMask(const Film& film, float contrast) {
    const Rect& r = film.layout().crop;
    std::vector<bool> active;
    active.reserve(r.area());
    for (uint32_t y = r.y0; y < r.y1; ++y)
        for (uint32_t x = r.x0; x < r.x1; ++x) {
            Range range;
            range.add(film.halfMean({x, y}, Half::even));
            range.add(film.halfMean({x, y}, Half::odd));
            for (uint32_t v = std::max(y, r.y0 + 1) - 1; v <= std::min(y + 1, r.y1 - 1); ++v)
                for (uint32_t u = std::max(x, r.x0 + 1) - 1; u <= std::min(x + 1, r.x1 - 1); ++u) range.add(film.mean({u, v}));
            active.push_back(range.beyond(contrast));
        }
    return {r, std::move(active)};
}

void AdaptivePasses::render(const Pass& pass, const Film& film, uint32_t samples, float contrast, FunctionRef<void(const Pass&)> some) {
    const uint32_t first = firstSamples(samples);
    if (pass.begin < first) some({pass.begin, std::min(pass.end, first), pass.active});
    // Stopped before every pixel has its first samples: the contrast is not known yet.
    if (pass.end <= first || !film.complete(first)) return;
    crop_ = film.layout().crop;
    if (!mask_) mask_ = pass.begin > first ? continuedMask(film, first) : contrastMask(film, contrast);
    some({std::max(pass.begin, first), pass.end, &*mask_});
}

void AdaptivePasses::save(Writer& to) const {
    std::vector<uint8_t> active;
    if (mask_)
        for (uint32_t y = crop_.y0; y < crop_.y1; ++y)
            for (uint32_t x = crop_.x0; x < crop_.x1; ++x) active.push_back(mask_->active({x, y}));
    to.array(active);
}

void AdaptivePasses::load(const Rect& crop, Reader& from) {
    const std::vector<uint8_t> active = from.array<uint8_t>();
    mask_.reset();
    crop_ = crop;
    if (active.empty()) return;
    if (active.size() != crop.area()) from.refuse("its mask is not that of this picture; render it from the beginning");
    mask_.emplace(crop, std::vector<bool>(active.begin(), active.end()));
}

} // namespace chiaro
