// Adaptive anti-aliasing by contrast: every pixel gets the first samples of its pattern, and those beside which the picture changes get all
// of them (Whitted 1980, who subdivides where the corners of a pixel differ; the measure of contrast is Mitchell's, Generating Antialiased
// Images at Low Sampling Densities, 1987). Decided once, from the film as it stands after the first samples: a pure function of them.
#pragma once
#include "core/render/function_ref.h"
#include "core/render/integrator.h"

namespace chiaro {

class AdaptivePasses {
public:
    // The first samples of a pattern of so many: a quarter, at least 4.
    static uint32_t firstSamples(uint32_t samples) noexcept;
    // The part of the pass that is due, by `some`, with the mask from the first samples on.
    void render(const Pass&, const Film&, uint32_t samples, float contrast, FunctionRef<void(const Pass&)> some);
    const std::optional<SampleMask>& mask() const noexcept { return mask_; }
    // A film on which the refining has begun no longer tells what it was decided from.
    void save(Writer&) const;
    void load(const Rect& crop, Reader&); // of the film

private:
    std::optional<SampleMask> mask_;
    Rect crop_; // of the mask
};

// The pixels beside which, or within which, any channel differs by (max - min) / (max + min) > contrast.
SampleMask contrastMask(const Film&, float contrast);

} // namespace chiaro
