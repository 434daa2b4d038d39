#include "tools/judge/flip.h"
#include "core/math/vec.h"
#include "core/render/error.h"
#include "tools/judge/flip_filters.h"
#include "tools/judge/pairwise.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace chiaro::judge {

namespace {
using Color = std::array<double, 3>;

// Shape of the answer (Andersson et al. 2020, sections 4.1 to 4.3).
constexpr double colorPower = 0.7, splitAt = 0.4, splitTo = 0.95, featurePower = 0.5;
constexpr double targetWhite = 0.85; // tone-mapped value that bounds the exposures (2021, section 3)
// ACES fit of Narkowicz with its pre-exposure of 0.6 cancelled: (a x^2 + b x)/(c x^2 + d x + e).
constexpr double toneA = 0.36 * 2.51, toneB = 0.6 * 0.03, toneC = 0.36 * 2.43, toneD = 0.6 * 0.59, toneE = 0.14;

// Linear Rec.709 to XYZ relative to D65, and back; the illuminant is the XYZ of white.
constexpr double toXyz[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};
constexpr double toRgb[3][3] = {
    {3.241003275, -1.537398934, -0.498615861}, {-0.969224334, 1.875930071, 0.041554224}, {0.055639423, -0.204011202, 1.057148933}};
constexpr Color white{0.950428545, 1.0, 1.088900371};

Color times(const double (&m)[3][3], const Color& v) noexcept {
    Color out;
    for (std::size_t i = 0; i < 3; ++i) out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    return out;
}

// CIELAB of linear RGB, with a and b weighted by 0.01 L (Hunt: colours look more colourful when bright).
Color huntLab(const Color& rgb) noexcept {
    constexpr double d = 6.0 / 29;
    Color f = times(toXyz, rgb);
    for (std::size_t i = 0; i < 3; ++i) {
        const double v = f[i] / white[i];
        f[i] = v > d * d * d ? std::cbrt(v) : v / (3 * d * d) + 4.0 / 29;
    }
    const double lightness = 116 * f[1] - 16;
    return {lightness, 0.01 * lightness * 500 * (f[0] - f[1]), 0.01 * lightness * 200 * (f[1] - f[2])};
}

// |dL| + |d(a, b)|, the HyAB distance of Abasi et al. (2020), to the power 0.7.
double hyab(const Color& p, const Color& q) noexcept {
    return std::pow(std::abs(p[0] - q[0]) + std::hypot(p[1] - q[1], p[2] - q[2]), colorPower);
}

struct Planes {
    Plane y, cx, cz; // YCxCz: linear opponent space on the axes of CIELAB
};

Planes opponent(const std::vector<Color>& rgb) {
    Planes p;
    for (Plane* plane : {&p.y, &p.cx, &p.cz}) plane->resize(rgb.size());
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        Color xyz = times(toXyz, rgb[i]);
        for (std::size_t k = 0; k < 3; ++k) xyz[k] /= white[k];
        p.y[i] = float(116 * xyz[1] - 16);
        p.cx[i] = float(500 * (xyz[0] - xyz[1]));
        p.cz[i] = float(200 * (xyz[1] - xyz[2]));
    }
    return p;
}

struct Extent {
    uint32_t width, height;
};

Plane blurred(const Plane& p, Extent e, const Kernel& k) {
    return filterColumns(filterRows(p, e.width, e.height, k), e.width, e.height, k);
}

// What the eye still sees of the colours, in Hunt-weighted Lab.
std::vector<Color> seenColors(const Planes& p, Extent e, const ContrastKernels& k) {
    const Plane y = blurred(p.y, e, k.achromatic), cx = blurred(p.cx, e, k.redGreen);
    const Plane cz0 = blurred(p.cz, e, k.blueYellow[0]), cz1 = blurred(p.cz, e, k.blueYellow[1]);
    std::vector<Color> out(y.size());
    for (std::size_t i = 0; i < y.size(); ++i) {
        const double level = (y[i] + 16.0) / 116;
        Color rgb =
            times(toRgb, {(level + cx[i] / 500.0) * white[0], level * white[1], (level - (double(cz0[i]) + cz1[i]) / 200) * white[2]});
        for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
        out[i] = huntLab(rgb);
    }
    return out;
}

struct Features {
    Plane edges, points; // gradient magnitudes
};

Features features(const Planes& p, Extent e, const FeatureKernels& k) {
    Plane level(p.y.size());
    for (std::size_t i = 0; i < level.size(); ++i) level[i] = p.y[i] / 116 + 16.0f / 116;
    const Plane smooth = filterRows(level, e.width, e.height, k.gauss);
    const auto magnitude = [&](const Kernel& derivative) {
        Plane x = filterColumns(filterRows(level, e.width, e.height, derivative, Mode::derivative), e.width, e.height, k.gauss);
        const Plane y = filterColumns(smooth, e.width, e.height, derivative, Mode::derivative);
        for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
        return x;
    };
    return {magnitude(k.edge), magnitude(k.point)};
}

struct Banks {
    ContrastKernels contrast;
    FeatureKernels feature;
};

// Both pictures in 0..1, linear.
std::vector<float> flipMap(const std::vector<Color>& test, const std::vector<Color>& reference, Extent e, const Banks& banks) {
    static const double largest = hyab(huntLab({0, 1, 0}), huntLab({0, 0, 1})), split = splitAt * largest;
    const Planes t = opponent(test), r = opponent(reference);
    const std::vector<Color> tc = seenColors(t, e, banks.contrast), rc = seenColors(r, e, banks.contrast);
    const Features tf = features(t, e, banks.feature), rf = features(r, e, banks.feature);
    std::vector<float> map(test.size());
    for (std::size_t i = 0; i < map.size(); ++i) {
        const double distance = hyab(tc[i], rc[i]);
        const double color =
            distance < split ? distance * splitTo / split : splitTo + (1 - splitTo) * (distance - split) / (largest - split);
        const double change = std::max(std::abs(tf.edges[i] - rf.edges[i]), std::abs(tf.points[i] - rf.points[i]));
        const double feature = std::pow(change / std::sqrt(2.0), featurePower);
        map[i] = float(std::pow(color, 1 - feature));
    }
    return map;
}

double finiteOrZero(float v) noexcept { return std::isfinite(v) ? double(v) : 0.0; }
double toneMapped(double x) noexcept { return (toneA * x * x + toneB * x) / (toneC * x * x + toneD * x + toneE); }

template <class Curve> std::vector<Color> shown(const Picture& p, const Curve& curve) {
    std::vector<Color> out(p.pixels());
    for (std::size_t i = 0; i < out.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) out[i][k] = std::clamp(curve(std::max(0.0, finiteOrZero(p.rgb[3 * i + k]))), 0.0, 1.0);
    return out;
}

double meanOf(const std::vector<float>& map, const std::vector<uint8_t>& keep) {
    const auto counts = [&](std::size_t i) { return keep.empty() || keep[i] != 0; };
    const double count = pairwiseSum(0, map.size(), [&](std::size_t i) { return counts(i) ? 1.0 : 0.0; });
    return pairwiseSum(0, map.size(), [&](std::size_t i) { return counts(i) ? double(map[i]) : 0.0; }) / count;
}

struct Exposures {
    double start = 0, stop = 0;
};

// From the exposure that brings the brightest pixel to the curve's 0.85 to the one that brings the median there.
std::optional<Exposures> exposuresOf(const Picture& p) {
    std::vector<double> levels;
    for (std::size_t i = 0; i < p.pixels(); ++i)
        levels.push_back(
            luminance(Rgb<double>(finiteOrZero(p.rgb[3 * i]), finiteOrZero(p.rgb[3 * i + 1]), finiteOrZero(p.rgb[3 * i + 2]))));
    const auto median = [](std::vector<double>& v) {
        const auto middle = v.begin() + std::ptrdiff_t(v.size() / 2);
        std::nth_element(v.begin(), middle, v.end());
        return *middle;
    };
    if (levels.empty()) return {};
    const double most = *std::max_element(levels.begin(), levels.end());
    if (!(most > 0)) return {};
    double middle = median(levels);
    if (!(middle > 0)) {
        std::erase_if(levels, [](double v) { return !(v > 0); });
        middle = median(levels);
    }
    const double a = toneA - targetWhite * toneC, b = toneB - targetWhite * toneD, c = -targetWhite * toneE;
    const double half = -0.5 * b / a, level = half + std::sqrt(half * half - c / a);
    return Exposures{std::log2(level / most), std::log2(level / middle)};
}

Banks banksFor(const Picture& test, const Picture& reference, const std::vector<uint8_t>& keep, double pixelsPerDegree) {
    requireComparable(test, reference, {{}, keep});
    if (!(pixelsPerDegree >= 1 && pixelsPerDegree <= 1000))
        throw Error(Exit::usage, fmt::format("FLIP: {} pixels a degree; give 1 to 1000 (67 is the usual desk).", pixelsPerDegree));
    return {contrastKernels(pixelsPerDegree), featureKernels(pixelsPerDegree)};
}
} // namespace

FlipResult flipLdr(const Picture& test, const Picture& reference, const std::vector<uint8_t>& keep, const FlipSettings& settings) {
    const Banks banks = banksFor(test, reference, keep, settings.pixelsPerDegree);
    const auto same = [](double v) { return v; };
    FlipResult result;
    if (test.pixels() > 0) result.map = flipMap(shown(test, same), shown(reference, same), {test.width, test.height}, banks);
    result.mean = meanOf(result.map, keep);
    return result;
}

FlipResult flipHdr(const Picture& test, const Picture& reference, const std::vector<uint8_t>& keep, const FlipSettings& settings) {
    const Banks banks = banksFor(test, reference, keep, settings.pixelsPerDegree);
    std::optional<Exposures> found = exposuresOf(reference);
    if (!found) found = exposuresOf(test);
    const Exposures range = found.value_or(Exposures{});
    FlipResult result;
    result.startExposure = settings.startExposure.value_or(range.start);
    result.stopExposure = settings.stopExposure.value_or(range.stop);
    if (!(result.startExposure <= result.stopExposure))
        throw Error(Exit::usage, fmt::format("FLIP: start exposure {:.4g} lies above stop exposure {:.4g}; swap them.",
                                             result.startExposure, result.stopExposure));
    result.exposures = settings.exposures.value_or(std::max(2, int(std::ceil(result.stopExposure - result.startExposure))));
    if (result.exposures < 1) throw Error(Exit::usage, fmt::format("FLIP: {} exposures; give at least 1.", result.exposures));
    result.map.assign(test.pixels(), 0.0f);
    result.exposureMap.assign(test.pixels(), float(result.startExposure));
    const double step = result.exposures > 1 ? (result.stopExposure - result.startExposure) / (result.exposures - 1) : 0;
    for (int k = 0; k < result.exposures && test.pixels() > 0; ++k) {
        const double exposure = result.startExposure + k * step, scale = std::exp2(exposure);
        const auto curve = [scale](double v) { return toneMapped(v * scale); };
        const std::vector<float> map = flipMap(shown(test, curve), shown(reference, curve), {test.width, test.height}, banks);
        for (std::size_t i = 0; i < map.size(); ++i)
            if (map[i] > result.map[i]) result.map[i] = map[i], result.exposureMap[i] = float(exposure);
    }
    result.mean = meanOf(result.map, keep);
    return result;
}

} // namespace chiaro::judge
