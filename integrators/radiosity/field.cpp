#include "integrators/radiosity/field.h"
#include "integrators/radiosity/patch_corners.h"
#include "integrators/radiosity/patch_share.h"
#include <algorithm>
#include <cmath>
#include <iterator>

namespace chiaro::radiosity {
namespace {

constexpr uint32_t mostApart = 64;
constexpr uint64_t perChunk = 256;
constexpr int rounds = 3;           // that give back to the patches what interpolating took
constexpr int rings = 2;            // about a point that stopped at black, in which patches keep their own
constexpr float lowestShare = 0.5f; // of the least of the neighbours: how dark a corner may be that was to be darker than black
constexpr float shared = 2;         // in place of a share: the values of the points are right as they are

// A plane through the value of a patch, by least squares over its neighbours, and the range that it should keep to.
struct Slope {
    Vec3 gradient[3];
    Spectrum least{0}, most{0};
};

void widen(Spectrum& least, Spectrum& most, const Spectrum& v) noexcept {
    for (std::size_t c = 0; c < 3; ++c) {
        least[c] = min(least[c], v[c]);
        most[c] = max(most[c], v[c]);
    }
}

Slope slopeOf(const Patches& patches, const Corners& corners, const std::vector<Spectrum>& values, uint32_t i) {
    const Patch& p = patches[i];
    const Frame frame = Frame::about(p.normal);
    double xx = 0, xy = 0, yy = 0, bx[3] = {}, by[3] = {};
    Slope s;
    s.least = s.most = values[i];
    for (uint32_t c = 0; c < p.corners; ++c)
        for (const uint32_t j : corners.at(p.vertex[c])) {
            if (j == i || patches[j].open < leastOpen) continue;
            const Vec3 way = patches[j].centre - p.centre;
            const double x = double(dot(way, frame.x)), y = double(dot(way, frame.y)),
                         w = double(patches[j].open) / std::max(x * x + y * y, 1e-30);
            xx += w * x * x;
            xy += w * x * y;
            yy += w * y * y;
            for (std::size_t k = 0; k < 3; ++k) {
                const double d = w * double(values[j][k] - values[i][k]);
                bx[k] += d * x;
                by[k] += d * y;
            }
            widen(s.least, s.most, values[j]);
        }
    const double det = xx * yy - xy * xy, trace = xx + yy;
    if (det > 1e-3 * trace * trace)
        for (std::size_t k = 0; k < 3; ++k)
            s.gradient[k] = frame.x * float((bx[k] * yy - by[k] * xy) / det) + frame.y * float((by[k] * xx - bx[k] * xy) / det);
    const Spectrum reach = (s.most - s.least) * 0.5f;
    s.least = s.least - reach;
    s.most = s.most + reach;
    return s;
}

// The least of a patch and its neighbours.
Spectrum lowest(const Patches& patches, const Corners& corners, const std::vector<Spectrum>& values, uint32_t i) {
    Spectrum least = values[i], unused = values[i];
    for (uint32_t c = 0; c < patches[i].corners; ++c)
        for (const uint32_t j : corners.at(patches[i].vertex[c]))
            if (patches[j].open >= leastOpen) widen(least, unused, values[j]);
    return least;
}

// The centre of what is open, in coordinates of the patch (of the parallelogram of its first corner).
Point2 middle(const Patch& p) noexcept {
    if (p.open == 1) return p.corners == 4 ? Point2{0.5f, 0.5f} : Point2{1 / 3.f, 1 / 3.f};
    const Vec3 e1 = p.corner[1] - p.corner[0], e2 = p.corner[p.corners - 1] - p.corner[0], d = p.centre - p.corner[0];
    const float a = lengthSquared(e1), b = dot(e1, e2), c = lengthSquared(e2), det = a * c - b * b;
    if (!(det > 0)) return {0.5f, 0.5f};
    return {clamp01((dot(d, e1) * c - dot(d, e2) * b) / det), clamp01((dot(d, e2) * a - dot(d, e1) * b) / det)};
}

template <class F> void forAll(const Executor& run, uint64_t n, F&& one) {
    run.chunks((n + perChunk - 1) / perChunk,
               [&](uint64_t chunk) {
                   for (uint64_t i = chunk * perChunk; i < std::min(n, (chunk + 1) * perChunk); ++i) one(uint32_t(i));
               },
               nullptr);
}

} // namespace

Field::Field(const Executor& run, const Patches& patches, const Solution& solution) {
    for (const Lights3& term : solution.terms) {
        std::vector<Spectrum>& to = constant_.emplace_back(term.size());
        std::transform(term.begin(), term.end(), to.begin(),
                       [](const Light& l) { return Spectrum(float(l[0]), float(l[1]), float(l[2])); });
    }
    interpolate(run, patches);
}

void Field::interpolate(const Executor& run, const Patches& patches) {
    const Corners corners(patches.all(), patches.points());
    atPoints_.assign(constant_.size(), std::vector<Spectrum>(patches.points(), Spectrum(0)));
    own_.assign(constant_.size(), std::vector<float>(patches.size(), shared));
    std::vector<Vec3> places(patches.points());
    for (const Patch& p : patches.all())
        for (uint32_t c = 0; c < p.corners; ++c) places[p.vertex[c]] = p.corner[c];
    // Mean over the patches that stand at a point, the nearer the more, the more open the more.
    const auto meanAt = [&](uint32_t point, auto&& value) {
        Spectrum sum(0);
        float weights = 0;
        for (const uint32_t i : corners.at(point)) {
            if (patches[i].open < leastOpen) continue;
            const Vec3 way = places[point] - patches[i].centre;
            const float w = patches[i].open / max(length(way), std::numeric_limits<float>::min());
            sum += value(i, way) * w;
            weights += w;
        }
        return weights > 0 ? sum * (1 / weights) : sum;
    };
    std::vector<Slope> slopes(patches.size());
    std::vector<Spectrum> missing(patches.size());
    std::vector<uint8_t> stopped(patches.points()), beside; // at 0
    for (std::size_t term = 0; term < constant_.size(); ++term) {
        const std::vector<Spectrum>& values = constant_[term];
        forAll(run, patches.size(), [&](uint32_t i) { slopes[i] = slopeOf(patches, corners, values, i); });
        forAll(run, patches.points(), [&](uint32_t point) {
            atPoints_[term][point] = meanAt(point, [&](uint32_t i, const Vec3& way) {
                const Slope& s = slopes[i];
                Spectrum v;
                for (std::size_t c = 0; c < 3; ++c)
                    v[c] = max(std::clamp(values[i][c] + dot(s.gradient[c], way), s.least[c], s.most[c]), 0.f);
                return v;
            });
        });
        std::fill(stopped.begin(), stopped.end(), uint8_t(0));
        for (int round = 0; round < rounds; ++round) {
            forAll(run, patches.size(), [&](uint32_t i) { missing[i] = values[i] - atMiddle(patches[i], uint32_t(term)); });
            forAll(run, patches.points(), [&](uint32_t point) {
                const Spectrum more = meanAt(point, [&](uint32_t i, const Vec3&) { return missing[i]; });
                Spectrum& v = atPoints_[term][point];
                for (std::size_t c = 0; c < 3; ++c) {
                    if (v[c] + more[c] < 0) stopped[point] = 1;
                    v[c] = max(v[c] + more[c], 0.f);
                }
            });
        }
        // Also those beside them, who gave what nobody takes now.
        const auto at = [&](const std::vector<uint8_t>& points, const Patch& p) {
            return std::any_of(p.vertex.begin(), p.vertex.begin() + p.corners, [&](uint32_t v) { return points[v] != 0; });
        };
        for (int ring = 0; ring < rings; ++ring) {
            beside = stopped;
            for (const Patch& p : patches.all())
                if (at(beside, p))
                    for (uint32_t c = 0; c < p.corners; ++c) stopped[p.vertex[c]] = 1;
        }
        forAll(run, patches.size(), [&](uint32_t i) {
            const Patch& p = patches[i];
            if (!at(stopped, p)) return;
            own_[term][i] = slopeWithin(p, uint32_t(term), values[i], lowest(patches, corners, values, i) * lowestShare);
        });
    }
}

// How much of its slope a patch can keep about its own value, with no corner below `floor`.
float Field::slopeWithin(const Patch& p, uint32_t term, const Spectrum& value, const Spectrum& floor) const noexcept {
    const Spectrum middle = atMiddle(p, term);
    float share = 1;
    for (uint32_t k = 0; k < p.corners; ++k)
        for (std::size_t c = 0; c < 3; ++c) {
            const float down = middle[c] - atPoints_[term][p.vertex[k]][c];
            if (down > 0) share = min(share, max(value[c] - floor[c], 0.f) / down);
        }
    return share;
}

Spectrum Field::atMiddle(const Patch& p, uint32_t term) const noexcept {
    const Point2 at = middle(p);
    return between(p, term, at.x, at.y);
}

Spectrum Field::between(const Patch& p, uint32_t term, float s, float t) const noexcept {
    const std::vector<Spectrum>& v = atPoints_[term];
    if (p.corners == 3) return v[p.vertex[0]] * (1 - s - t) + v[p.vertex[1]] * s + v[p.vertex[2]] * t;
    return v[p.vertex[0]] * ((1 - s) * (1 - t)) + v[p.vertex[1]] * (s * (1 - t)) + v[p.vertex[2]] * (s * t) +
           v[p.vertex[3]] * ((1 - s) * t);
}

Spectrum Field::interpolated(const Patches& patches, uint32_t term, const Patches::Place& at) const noexcept {
    const Patch& p = patches[at.patch];
    const Spectrum here = between(p, term, at.s, at.t);
    const float share = own_[term][at.patch];
    if (share == shared) return here;
    return constant_[term][at.patch] + (here - atMiddle(p, term)) * share;
}

void Field::save(Writer& to) const {
    to.value(uint32_t(constant_.size()));
    for (const std::vector<Spectrum>& term : constant_) to.array(term);
}

void Field::load(const Executor& run, const Patches& patches, Reader& from) {
    const auto n = from.value<uint32_t>();
    if (n > 2 * mostApart) from.refuse("not a radiosity solution: too many terms");
    constant_.clear();
    for (uint32_t i = 0; i < n; ++i) {
        constant_.push_back(from.array<Spectrum>());
        if (constant_.back().size() != patches.size()) from.refuse("radiosity of another mesh of patches; solve it again");
    }
    interpolate(run, patches);
}

LightKind anyKind(const Scene& scene) {
    if (scene.counts().emissiveTriangles > 0) return LightKind::area;
    if (scene.counts().punctualLights > 0) return LightKind::delta;
    return LightKind::environment;
}

std::vector<PathState> arrivalsThroughMirrors(const PathClasses& classes) {
    std::vector<PathState> all{classes.eye()};
    std::vector<bool> seen(classes.states());
    seen[classes.eye()] = seen[0] = true;
    for (std::size_t i = 0; i < all.size(); ++i)
        for (const Event e : {Event::GR, Event::GT, Event::SR, Event::ST}) {
            const PathState next = classes.eye(all[i], e);
            if (seen[next]) continue;
            seen[next] = true;
            all.push_back(next);
        }
    return all;
}

uint32_t termsApart(const PathClasses& classes, const Scene& scene, std::span<const PathState> arrivals) {
    std::vector<LightKind> kinds;
    if (scene.counts().emissiveTriangles > 0) kinds.push_back(LightKind::area);
    if (scene.counts().punctualLights > 0) kinds.push_back(LightKind::delta);
    if (scene.lights().hasEnvironment()) kinds.push_back(LightKind::environment);
    if (kinds.empty()) return 0;
    uint32_t apart = 0;
    for (const PathState arrival : arrivals) {
        PathState state = classes.eye(arrival, Event::DR);
        Layer layer = 0;
        for (uint32_t k = 0; k < mostApart; ++k) {
            const Layer here = state ? classes.reached(state, kinds[0]) : Layer(0);
            for (const LightKind kind : kinds)
                if (state && classes.reached(state, kind) != here)
                    throw Error(Exit::unsupported,
                                "radiosity does not tell light of surfaces, of lamps without extent and of the environment "
                                "apart once it is scattered: write L for La, Ld and Le in --paths and --split");
            if (k > 0 && here != layer) apart = std::max(apart, k);
            layer = here;
            const PathState next = state ? classes.eye(state, Event::DR) : PathState(0);
            if (next == state) break;
            state = next;
        }
    }
    return apart;
}

} // namespace chiaro::radiosity
