#include "tools/judge/agreement.h"
#include "core/render/error.h"
#include "tools/judge/rare_events.h"
#include "tools/judge/special.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>

namespace chiaro::judge {

namespace {
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double imageShare = 0.5, tileShare = 0.25, pixelShare = 0.25;
constexpr double outlierP = 0.001; // two-sided, |z| > 3.29
constexpr double largestZ = 38;    // beyond, the normal tail is no double

double roundingOf(const Estimate& a, const Estimate& b, double rounding) noexcept {
    return rounding * std::max(std::abs(a.mean), std::abs(b.mean));
}
// event: height of the bright events that may be missing on one side.
Test compared(const Estimate& a, const Estimate& b, double rounding, double event = 0) noexcept {
    Test test = welch(a, b, roundingOf(a, b, rounding));
    test.p = std::max(test.p, missedP(test.difference, event));
    return test;
}
// In a pixel of tile t.
double eventAt(const Evidence& a, const Evidence& b, std::size_t t) noexcept {
    return std::max(a.events.empty() ? 0 : a.events[t], b.events.empty() ? 0 : b.events[t]);
}

// Equal without any spread: nothing to test.
bool identical(const Estimate& a, const Estimate& b) noexcept { return a.error == 0 && b.error == 0 && a.mean == b.mean; }

// pairs: the difference by pairs of replicates.
Test paired(const Estimate& a, const Estimate& b, const Estimate& pairs, double rounding, double event) noexcept {
    Test test = oneSample({a.mean - b.mean, pairs.error, pairs.dof}, 0, roundingOf(a, b, rounding));
    test.p = std::max(test.p, missedP(test.difference, event));
    return test;
}

Bias biasOf(const Test& test, const Estimate& b, const AgreementSettings& s) noexcept {
    Bias bias{test, 0, {}};
    const Interval absolute = confidenceInterval(bias.test, 1 - s.confidence);
    const auto relative = [&](double d) { return d == 0 ? 0.0 : d / std::abs(b.mean); };
    bias.relative = relative(bias.test.difference);
    bias.interval = {relative(absolute.low), relative(absolute.high)};
    return bias;
}

using Pairs = std::array<Estimate, meanCount>;

void imageScale(Agreement& out, const Evidence& a, const Evidence& b, const AgreementSettings& s, const Pairs* pairs, double event) {
    std::vector<double> p;
    const double level = std::abs(b.image[0].mean);
    for (std::size_t k = 0; k < meanCount; ++k) {
        const Estimate &x = a.image[k], &y = b.image[k];
        const double tint = level > 0 ? std::abs(y.mean) / level : 1;
        out.bias[k] = biasOf(pairs ? paired(x, y, (*pairs)[k], s.rounding, event * tint) : compared(x, y, s.rounding), y, s);
        p.push_back(out.bias[k].test.p);
        if (p[k] < out.bias[std::size_t(out.strongest)].test.p) out.strongest = Mean(k);
    }
    out.image = {imageShare * s.alpha, simes(p), p.size(), 0};
    for (const double v : p) out.image.rejected += v <= sidak(out.image.alpha, double(p.size()));
}

void tileScale(Agreement& out, const Evidence& a, const Evidence& b, const AgreementSettings& s) {
    out.tilesX = a.tilesX;
    out.tilesY = a.tilesY;
    out.tileZ.assign(a.tiles.size(), float(nan));
    out.tiles.alpha = tileShare * s.alpha;
    std::vector<double> p, errors;
    for (std::size_t t = 0; t < a.tiles.size(); ++t) {
        if (std::isnan(a.tiles[t].mean) || std::isnan(b.tiles[t].mean)) continue;
        const Test test = compared(a.tiles[t], b.tiles[t], s.rounding, eventAt(a, b, t) / (double(a.tile) * a.tile));
        const double z = std::min(largestZ, normalQuantile(test.p / 2));
        out.tileZ[t] = float(std::copysign(z, test.difference));
        if (identical(a.tiles[t], b.tiles[t])) continue;
        p.push_back(test.p);
        errors.push_back(test.error);
    }
    out.tiles.tests = p.size();
    if (p.empty()) return;
    const double each = sidak(out.tiles.alpha, double(p.size()));
    for (const double v : p) out.tiles.rejected += v <= each;
    out.tiles.p = sidakFamily(*std::min_element(p.begin(), p.end()), double(p.size()));
    const auto middle = errors.begin() + std::ptrdiff_t(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    const Test& whole = out.bias[0].test;
    out.tileResolution = minimalDetectable(*middle, whole.dof, each, s.power) / std::abs(b.image[0].mean);
}

void pixelScale(Agreement& out, const Evidence& a, const Evidence& b, const AgreementSettings& s) {
    out.pixelZ.assign(a.pixels.size(), float(nan));
    out.pixels.alpha = pixelShare * s.alpha;
    // A t tail is never below the normal one: a p that cannot matter is not worth its incomplete beta function.
    const double ignorable = normalQuantile(std::max(out.pixels.alpha, outlierP) / 2);
    const bool decides = !a.pooled && !b.pooled;
    std::vector<double> p;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        if (std::isnan(a.pixels[i].mean) || std::isnan(b.pixels[i].mean)) continue;
        const Estimate &x = a.pixels[i], &y = b.pixels[i];
        const double floor = roundingOf(x, y, s.rounding), difference = x.mean - y.mean;
        const double error = std::sqrt(x.error * x.error + y.error * y.error + floor * floor);
        out.pixelZ[i] = difference == 0 ? 0.0f : float(std::clamp(difference / error, -1e30, 1e30));
        if (!decides || identical(x, y)) continue;
        const std::size_t tile = i / a.width / a.tile * a.tilesX + i % a.width / a.tile;
        p.push_back(std::abs(difference) <= ignorable * error ? 1.0 : compared(x, y, s.rounding, eventAt(a, b, tile)).p);
    }
    out.pixels.tests = p.size();
    for (const double v : p) out.outliers += v < outlierP;
    out.outlierBounds = binomialBounds(p.size(), outlierP, out.pixels.alpha);
    if (p.empty()) return;
    out.pixels.p = simes(p);
    const double threshold = benjaminiHochberg(p, out.pixels.alpha);
    for (const double v : p) out.pixels.rejected += v <= threshold;
}

void resolve(Agreement& out, const Evidence& b, const AgreementSettings& s, double event) {
    const Test& mean = out.bias[0].test;
    // Simes over the four means finds at least what Bonferroni finds.
    const double each = out.image.alpha / double(meanCount), level = std::abs(b.image[0].mean), margin = s.margin * level;
    const double byErrors = minimalDetectable(mean.error, mean.dof, each, s.power);
    // So many events do not stay away by chance; their own number varies by a root of it.
    const double events = std::log(1 / each), byEvents = event * (events + normalQuantile(1 - s.power) * std::sqrt(events));
    const double absolute = std::max(byErrors, byEvents);
    out.resolution = absolute == 0 ? 0 : absolute / level;
    // Black on both sides: no margin, and no difference that would need one.
    const bool same = mean.difference == 0 && mean.error == 0;
    out.equivalenceP = same ? 0 : std::max(equivalence(mean, margin), missedP(margin, event));
    // Errors fall as 1/sqrt(n), the height of an event as 1/n.
    const double factor = absolute == 0 ? 0 : std::max((byErrors / margin) * (byErrors / margin), byEvents / margin);
    out.neededReplicates = std::max(2.0, std::ceil(out.replicates * factor));
    if (out.resolution > s.margin) out.moreSamples = std::ceil(out.replicates * s.samplesPerReplicate * (factor - 1));
}
} // namespace

const char* verdictName(Verdict v) noexcept {
    switch (v) {
    case Verdict::agrees: return "agrees";
    case Verdict::biased: return "biased";
    case Verdict::differs: return "differs";
    case Verdict::cannotTell: return "cannot tell yet";
    }
    return "";
}

Agreement decide(Evidence a, Evidence b, const AgreementSettings& s, const Pairs* pairs) {
    Agreement out;
    out.replicates = std::min(a.replicates, b.replicates);
    out.compared = a.compared;
    out.skewness = std::abs(a.skewness) > std::abs(b.skewness) ? a.skewness : b.skewness;
    if (a.compared == 0 || b.compared == 0) return out;
    const double event = pairs ? std::max(eventHeight(a), eventHeight(b)) : 0;
    floorRareEvents(a, b);
    imageScale(out, a, b, s, pairs, event);
    tileScale(out, a, b, s);
    pixelScale(out, a, b, s);
    resolve(out, b, s, event);
    if (pairs) {
        const double own = std::hypot(a.image[0].error, b.image[0].error), left = own > 0 ? (*pairs)[0].error / own : 1;
        out.sharedNoise = 1 - left * left;
    }
    if (out.image.significant())
        out.verdict = Verdict::biased;
    else if (out.tiles.significant() || out.pixels.significant())
        out.verdict = Verdict::differs;
    else
        out.verdict = out.resolution <= s.margin ? Verdict::agrees : Verdict::cannotTell;
    return out;
}

Agreement agree(const Replicates& test, const Replicates& reference, const AgreementSettings& s) {
    if (test.width() != reference.width() || test.height() != reference.height() || test.tile() != reference.tile())
        throw Error(Exit::unsupported, fmt::format("the test is {}x{}, the reference {}x{}; render both at one size.", test.width(),
                                                   test.height(), reference.width(), reference.height()));
    if (std::min(test.count(), reference.count()) < 2)
        throw Error(Exit::unsupported, fmt::format("a verdict needs 2 replicates a side or more, has {} and {}; raise --seeds.",
                                                   test.count(), reference.count()));
    std::vector<uint8_t> bad = test.badTiles();
    const std::vector<uint8_t> others = reference.badTiles();
    for (std::size_t t = 0; t < bad.size(); ++t) bad[t] |= others[t];
    std::optional<Pairs> pairs;
    if (s.paired) pairs = pairedDifferences(test, reference, bad);
    Agreement out = decide(test.evidence(bad), reference.evidence(bad), s, pairs ? &*pairs : nullptr);
    out.nonFinitePixels = test.nonFinitePixels() + reference.nonFinitePixels();
    out.tilesLeftOut = std::size_t(std::count(bad.begin(), bad.end(), 1));
    return out;
}

Agreement agree(const Picture& test, const Picture& reference, const Region& region, const AgreementSettings& s) {
    requireComparable(test, reference, region);
    std::vector<uint8_t> bad = badTiles(test, region);
    const std::vector<uint8_t> others = badTiles(reference, region);
    for (std::size_t t = 0; t < bad.size(); ++t) bad[t] |= others[t];
    Agreement out = decide(evidenceOf(test, region, bad), evidenceOf(reference, region, bad), s);
    out.tilesLeftOut = std::size_t(std::count(bad.begin(), bad.end(), 1));
    return out;
}

std::string describe(const Agreement& a, const AgreementSettings& s) {
    if (a.compared == 0) return "cannot tell: no pixel to compare";
    switch (a.verdict) {
    case Verdict::agrees: return fmt::format("agrees: a bias of {:.2g} % would show", 100 * a.resolution);
    case Verdict::biased: {
        const Bias& bias = a.bias[std::size_t(a.strongest)];
        const double half = 0.5 * (bias.interval.high - bias.interval.low);
        if (!std::isfinite(bias.relative))
            return fmt::format("biased by {:+.3g} cd/m2 ({}; the reference is black)", bias.test.difference, meanName(a.strongest));
        return fmt::format("biased by {:+.3g} % +- {:.2g} % ({}, {:g} % confidence)", 100 * bias.relative, 100 * half,
                           meanName(a.strongest), 100 * s.confidence);
    }
    case Verdict::differs:
        return fmt::format("differs: {} of {} tiles{}, while the means agree within {:.2g} %", a.tiles.rejected, a.tiles.tests,
                           a.pixels.tests ? fmt::format(" and {} of {} pixels", a.pixels.rejected, a.pixels.tests) : "",
                           100 * a.resolution);
    case Verdict::cannotTell:
        return std::isfinite(a.moreSamples)
                   ? fmt::format("cannot tell yet: needs {:.0f} more samples a pixel to see a bias of {:g} % (now {:.2g} %)", a.moreSamples,
                                 100 * s.margin, 100 * a.resolution)
                   : std::string("cannot tell: the reference is black but for noise");
    }
    return {};
}

} // namespace chiaro::judge
