// FLIP: the difference that a person sees when two pictures alternate on a display, 0 (none) to 1, a pixel.
// LDR: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, FLIP: A Difference Evaluator for Alternating Images, PACM CGIT
// 3(2), 2020. HDR: Andersson, Nilsson, Shirley, Akenine-Moller, Visualizing Errors in Rendered High Dynamic Range Images, Eurographics
// short papers 2021. Constants and the separated filters follow the authors' program (version 1.7): values agree with it to 1e-4.
//
// Pictures are linear Rec.709 and are shown on an sRGB display. The filters look at the whole picture (edges repeated); the mean is over
// the pixels that count. Non-finite and negative values are taken as 0 by the filters. A picture whose reference is black takes its
// exposures from the test picture; a median of 0 is replaced by the median of the lit pixels; two black pictures differ by 0.
#pragma once
#include "tools/judge/picture.h"

namespace chiaro::judge {

struct FlipSettings {
    double pixelsPerDegree = 67.02064327658225;        // 0.7 m from a display 0.7 m and 3840 pixels wide: 0.7 (3840/0.7) pi/180
    std::optional<double> startExposure, stopExposure; // HDR, in stops; absent: from the reference
    std::optional<int> exposures;                      // HDR; absent: max(2, ceil(stop - start))
};

struct FlipResult {
    std::vector<float> map;         // a pixel
    std::vector<float> exposureMap; // HDR: the exposure, in stops, at which the difference is largest
    double mean = 0;                // over the pixels that count; NaN without any
    double startExposure = 0, stopExposure = 0;
    int exposures = 0; // 0: LDR
};

// keep: one byte a pixel, or empty for all. Sizes must agree (requireComparable). LDR clamps both pictures to 0..1.
FlipResult flipLdr(const Picture& test, const Picture& reference, const std::vector<uint8_t>& keep = {}, const FlipSettings& = {});
FlipResult flipHdr(const Picture& test, const Picture& reference, const std::vector<uint8_t>& keep = {}, const FlipSettings& = {});

} // namespace chiaro::judge
