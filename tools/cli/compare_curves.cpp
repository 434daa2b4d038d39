// Error against samples and time, its slope, and the time that an error takes.
#include "tools/cli/compare_measure.h"
#include "tools/judge/statistics.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace chiaro::cli {
namespace {

using report::Curve, report::CurvePoint, report::TimeToError;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// The point of all seeds at their snapshot k.
CurvePoint pointOf(const std::vector<const std::vector<Snapshot>*>& seeds, std::size_t k) {
    CurvePoint p;
    p.low = std::numeric_limits<double>::infinity();
    double squares = 0;
    const double n = double(seeds.size());
    for (const auto* s : seeds) {
        const Snapshot& at = (*s)[k];
        p.seconds += at.seconds / n;
        p.spp += at.spp / n;
        squares += at.error * at.error / n;
        p.low = std::min(p.low, at.error);
        p.high = std::max(p.high, at.error);
    }
    p.error = std::sqrt(squares);
    return p;
}

struct Line {
    double slope = nan, error = 0; // standard error by the residuals
};
// Least squares through log error over log samples.
Line fit(const std::vector<std::pair<double, double>>& points) {
    const double n = double(points.size());
    if (n < 2) return {};
    double mx = 0, my = 0, xx = 0, xy = 0, rest = 0;
    for (const auto& [x, y] : points) mx += x / n, my += y / n;
    for (const auto& [x, y] : points) xx += (x - mx) * (x - mx), xy += (x - mx) * (y - my);
    if (!(xx > 0)) return {};
    const double slope = xy / xx;
    for (const auto& [x, y] : points) rest += std::pow(y - my - slope * (x - mx), 2);
    return {slope, n > 2 ? std::sqrt(rest / (n - 2) / xx) : 0};
}

template <class Points> Line slopeOf(const Points& points) {
    std::vector<std::pair<double, double>> logs;
    for (const auto& p : points)
        if (p.error > 0 && p.spp > 0 && std::isfinite(p.error)) logs.emplace_back(std::log(p.spp), std::log(p.error));
    return fit(logs);
}

// Looks of one seed depend on each other, seeds do not: the slope's error is the spread over the seeds.
void addSlope(Curve& curve, const std::vector<const std::vector<Snapshot>*>& seeds) {
    judge::Moments slopes;
    for (const auto* s : seeds)
        if (const Line line = slopeOf(*s); std::isfinite(line.slope)) slopes.add(line.slope);
    if (slopes.count() == 0) return;
    if (slopes.count() > 1) {
        curve.slope = slopes.mean();
        curve.slopeError = slopes.standardError();
    } else if (const Line line = slopeOf(curve.points); std::isfinite(line.slope)) {
        curve.slope = line.slope;
        curve.slopeError = line.error;
    }
}

// Where the curve first goes below the error, straight between points on log axes.
TimeToError::Cell timeTo(const Curve& curve, double error, bool endless) {
    const std::vector<CurvePoint>& p = curve.points;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (p[i].error > error) continue;
        if (i == 0 || !(p[i].error > 0) || !(p[i - 1].seconds > 0)) return {p[i].seconds, false};
        const double t = std::log(p[i - 1].error / error) / std::log(p[i - 1].error / p[i].error);
        return {p[i - 1].seconds * std::pow(p[i].seconds / p[i - 1].seconds, t), false};
    }
    if (!endless || p.size() < 3) return {nan, false};
    const Line line = slopeOf(std::vector<CurvePoint>(p.end() - 3, p.end())); // the last looks: early ones know nothing of a floor
    constexpr double leastSlope = -0.2, unbiased = -0.5, most = 1e4;
    if (!(line.slope < leastSlope)) return {nan, false};
    const double factor = std::pow(error / p.back().error, 1 / std::max(line.slope, unbiased));
    return factor <= most ? TimeToError::Cell{p.back().seconds * factor, true} : TimeToError::Cell{nan, false};
}

} // namespace

std::optional<Curve> curveOf(const Contestant& c, uint32_t entry) {
    std::vector<const std::vector<Snapshot>*> seeds;
    std::size_t looks = std::numeric_limits<std::size_t>::max();
    for (const SeedRun& r : c.runs)
        if (r.whole && !r.snapshots.empty()) {
            seeds.push_back(&r.snapshots);
            looks = std::min(looks, r.snapshots.size());
        }
    if (seeds.empty()) return {};
    Curve curve;
    curve.entry = entry;
    for (std::size_t k = 0; k < looks; ++k) curve.points.push_back(pointOf(seeds, k));
    std::erase_if(curve.points, [](const CurvePoint& p) { return !std::isfinite(p.error); });
    if (curve.points.empty()) return {};
    // A last look that is hardly later than the one before, and in other places with every seed.
    if (const std::size_t n = curve.points.size(); n > 2 && curve.points[n - 1].spp < 1.1 * curve.points[n - 2].spp)
        curve.points.erase(curve.points.end() - 2);
    addSlope(curve, seeds);
    return curve;
}

std::vector<TimeToError> timesToError(const std::vector<Curve>& curves, const std::vector<bool>& endless) {
    double most = 0, least = std::numeric_limits<double>::infinity();
    for (const Curve& c : curves)
        for (const CurvePoint& p : c.points) {
            most = std::max(most, p.error);
            if (p.error > 0) least = std::min(least, p.error);
        }
    std::vector<TimeToError> all;
    if (!(most > 0) || !std::isfinite(most)) return all;
    constexpr double steps[] = {1, 0.5, 0.2};
    constexpr std::size_t rows = 6;
    for (double decade = std::pow(10, std::ceil(std::log10(most))); decade > 0.1 * least && decade > 1e-6; decade /= 10)
        for (const double step : steps) {
            const double error = decade * step;
            if (error > most || error < 0.3 * least) continue; // the last one may lie beyond what was reached
            TimeToError row{error, {}};
            for (std::size_t i = 0; i < curves.size(); ++i) row.cells.push_back(timeTo(curves[i], error, endless[i]));
            all.push_back(std::move(row));
        }
    if (all.size() > rows) all.erase(all.begin(), all.end() - rows);
    return all;
}

} // namespace chiaro::cli
