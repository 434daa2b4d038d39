// Do two estimates of one picture agree? One rule at three scales, because each is blind to what another sees: the whole image (small
// global bias), 8x8 tiles (differences that cancel over the image), pixels (a few wrong ones).
//
// The overall alpha, the chance that two methods of equal expectation are called different, is split by Bonferroni: 1/2 to the image
// (Welch on luminance, R, G, B; the family's p by Simes, exact for independent and safe for positively dependent tests), 1/4 to the tiles
// (Welch on luminance; Sidak over the tiles), 1/4 to the pixels (Welch on luminance; Benjamini-Hochberg at q = alpha/4, which under
// agreement rejects anything at all with probability q). Tiles and pixels where both sides are exactly equal without any spread are no
// tests. Equal designs (the same samples on both sides) keep the rule safe for the skewed samples of light transport; the errors of tiles
// and pixels that rare events have hit too seldom to show their spread are floored by what is known around them
// (tools/judge/rare_events.h).
//
// Pictures with error layers are judged by image and tiles alone: their errors are pooled over a neighbourhood, and one bright sample
// would stand many pooled errors away from its neighbours in either picture.
//
// Replicates made in pairs, where both sides have drawn the same random numbers: the image is tested by the spread of their differences
// (t with one degree of freedom less than the pairs), which has lost all noise that the sides share, such as that of the positions in a
// pixel. Two sides that share a seed differ in expectation exactly as two that do not. Less noise lets smaller accidents be seen: that one
// side has met a few bright events fewer than it should. A difference worth n events of the picture's own height comes so by chance with
// exp(-n) (rare_events.h); p is no smaller. Tiles and pixels keep their own errors: there such accidents are the rule.
//
// A method that is constant (Whitted) or a dark pixel has no spread: differences within `rounding` of the larger mean count as equal.
#pragma once
#include "tools/judge/replicates.h"

namespace chiaro::judge {

struct AgreementSettings {
    double alpha = 1e-3;            // overall
    double margin = 0.01;           // relative bias of the mean that must be resolvable before anything "agrees"
    double power = 0.99;            // chance with which a bias of the resolution is found
    double confidence = 0.95;       // of the intervals
    double rounding = 1e-6;         // relative error of a float32 picture
    double samplesPerReplicate = 1; // samples a pixel; turns replicates into samples in the answer
    bool paired = false;            // replicate r of both sides has drawn the same random numbers
};

enum class Verdict { agrees, biased, differs, cannotTell };
const char* verdictName(Verdict) noexcept;

struct Bias {
    Test test;           // test - reference, absolute
    double relative = 0; // of the reference's mean; NaN or infinite where that is black
    Interval interval;   // of `relative`; the reference's own error is in it to first order
};
struct Scale {
    double alpha = 0, p = 1; // its share of alpha; the p-value of the family
    std::size_t tests = 0, rejected = 0;
    bool significant() const noexcept { return p <= alpha && tests > 0; }
};

struct Agreement {
    Verdict verdict = Verdict::cannotTell;
    std::array<Bias, meanCount> bias; // indexed by Mean
    Mean strongest = Mean::luminance; // the mean with the smallest p
    Scale image, tiles, pixels;
    double resolution = 0;     // smallest relative bias of the mean luminance found with `power` (minimal detectable bias)
    double tileResolution = 0; // the same for the median tile, relative to the mean of the image
    double equivalenceP = 1;   // two one-sided tests: p that the relative bias lies inside the margin
    uint32_t tilesX = 0, tilesY = 0;
    std::vector<float> tileZ;  // signed normal deviates, row by row; NaN: left out
    std::vector<float> pixelZ; // (test - reference)/error; NaN: left out
    std::size_t outliers = 0;  // pixels with p < 0.001, and the bounds of their number under agreement (at the pixels' alpha)
    CountBounds outlierBounds;
    std::size_t compared = 0, nonFinitePixels = 0, tilesLeftOut = 0;
    double skewness = 0;         // larger one of the replicate means: beyond 0.5, distrust one-sample tests
    double replicates = 0;       // of the side that has fewer
    double sharedNoise = 0;      // of paired sides: the share of the variance of the mean luminance's difference that is gone with it
    double neededReplicates = 0; // a side, for a resolution of the margin
    double moreSamples = 0;      // a pixel and side, for the same; 0: resolved
};

// Both sides have two replicates or more (Exit::unsupported else), of equal size, region and tile; as many as the other where paired.
Agreement agree(const Replicates& test, const Replicates& reference, const AgreementSettings& = {});
// Two pictures with error layers. Their errors must be right: a film's, pooled, errs on the safe side.
Agreement agree(const Picture& test, const Picture& reference, const Region& = {}, const AgreementSettings& = {});
// The rule itself. pairs: the differences of the image's means, test - reference, by pairs of replicates.
Agreement decide(Evidence test, Evidence reference, const AgreementSettings&, const std::array<Estimate, meanCount>* pairs = nullptr);

// "agrees: ...", "biased by 1.02 % +- 0.30 %", "differs: ...", "cannot tell yet: needs 96 more samples ...".
std::string describe(const Agreement&, const AgreementSettings& = {});

} // namespace chiaro::judge
