#include "integrators/radiosity/link_finder.h"
#include "core/math/sampler.h"
#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::radiosity {
namespace {

constexpr double dimmest = 1e-3;        // of the mean irradiance
constexpr double brighter = 2;          // the mean than what is called dim
constexpr std::size_t seedPairs = 4096; // that are refined side by side
constexpr float rough = 0.25f;          // of an estimate by middles: so much is there at least
constexpr uint32_t variants = 4;        // of the places on a node
constexpr uint64_t nodesPerChunk = 256;
constexpr int rays = 16;              // between two nodes
constexpr float floorOfRange = 0.05f; // relative: four points may agree by chance

// Can no point of q lie before a surface of p?
bool behind(const Hierarchy::Node& p, const Hierarchy::Node& q) noexcept {
    const Vec3 way = q.centre - p.centre;
    if (p.flat) { // rounding aside: surfaces may lie close above each other
        const float sine = length(cross(p.axis, q.axis)), reach = (q.flat ? q.radius * sine + q.depth : q.radius) + p.depth;
        return dot(p.axis, way) + reach <= 2 * (p.error + q.error);
    }
    const float distance = length(way), both = p.radius + q.radius;
    if (distance <= both) return false;
    const float angle = std::acos(std::clamp(dot(p.axis, way) / distance, -1.f, 1.f));
    return angle - std::asin(both / distance) - p.spread > pi / 2;
}

// What sixteen rays that met nothing may have missed.
float fewest(const Hierarchy::Node& p, const Hierarchy::Node& q) noexcept {
    const float gap = std::max(length(q.centre - p.centre), 0.5f * (p.radius + q.radius));
    return std::min(float(q.area) / (pi * gap * gap), 1.f) / rays;
}

bool touching(const Hierarchy::Node& p, const Hierarchy::Node& q) noexcept {
    return lengthSquared(q.centre - p.centre) < sqr(p.radius + q.radius);
}

} // namespace

Linker::Linker(const Work& work, const FormFactors& factors, const Hierarchy& tree)
    : work_(work), factors_(factors), tree_(tree), places_(tree.nodes().size() * variants) {
    const uint64_t n = tree.nodes().size();
    work.run.chunks((n + nodesPerChunk - 1) / nodesPerChunk,
                    [&](uint64_t chunk) {
                        for (uint64_t i = chunk * nodesPerChunk; i < std::min(n, (chunk + 1) * nodesPerChunk); ++i)
                            for (uint32_t v = 0; v < variants; ++v) places_[i * variants + v] = placesOn(uint32_t(i), v);
                    },
                    &work.stop);
}

Linker::Places Linker::placesOn(uint32_t node, uint32_t variant) const noexcept {
    Places to;
    const Sampler base(work_.seed, SamplerKind::sobol, Stream::prepass, node, 0);
    for (uint32_t k = 0; k < points; ++k) {
        Sampler u = base.at(variant * points + k);
        const PickAndPoint at = u.get3D();
        const uint32_t patch = tree_.pick(node, float(at.pick));
        const Patch& p = factors_.patches()[patch];
        const Vec3 here = p.outside(factors_.patches().point(patch, at.u));
        to.x[k] = here.x, to.y[k] = here.y, to.z[k] = here.z;
        to.nx[k] = p.normal.x, to.ny[k] = p.normal.y, to.nz[k] = p.normal.z;
        to.open[k] = p.open;
    }
    return to;
}

std::vector<Link> Linker::link(std::span<const Light> radiosity, std::span<const double> arrives, const System& system, double linkError) {
    const std::size_t n = tree_.nodes().size();
    Lights3 squares(radiosity.size()), mean(n), meanSquare(n);
    for (std::size_t i = 0; i < radiosity.size(); ++i) squares[i] = Light(sqr(luminance(radiosity[i])));
    tree_.pull(radiosity, mean);
    tree_.pull(squares, meanSquare);
    brightness_.resize(n);
    deviation_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        brightness_[i] = luminance(mean[i]);
        deviation_[i] = std::sqrt(std::max(meanSquare[i][0] - sqr(brightness_[i]), 0.0));
    }
    allowed_ = linkError / double(std::max<std::size_t>(radiosity.size(), 1)) * power(radiosity, system.areas);
    compareLight(arrives, system);
    return refineAll();
}

// The harmonic mean over what reflects, for a node that is dim in part must be linked as its dim part.
void Linker::compareLight(std::span<const double> arrives, const System& system) {
    const std::size_t n = tree_.nodes().size();
    Lights3 weights(arrives.size()), mean(n);
    double sum = 0, area = 0;
    for (std::size_t i = 0; i < arrives.size(); ++i) sum += arrives[i] * double(system.areas[i]), area += double(system.areas[i]);
    const double usual = sum / area;
    for (std::size_t i = 0; i < arrives.size(); ++i) {
        const double reflects = double(luminance(system.reflectance[i]));
        weights[i] = {reflects, reflects / std::max(arrives[i], dimmest * usual), 0};
    }
    tree_.pull(weights, mean);
    dim_.assign(n, 1);
    for (std::size_t i = 0; i < n; ++i)
        if (usual > 0 && mean[i][1] > 0) dim_[i] = std::min(brighter * mean[i][0] / (mean[i][1] * usual), 1.0);
}

// Lines between points of two nodes, and what each would carry.
struct Linker::Between {
    uint8_t of[pairs];                     // which points: of the first * points + of the second
    float open[pairs];                     // points are drawn where patches are not open, too; there nothing is seen
    float toFirst[pairs], toSecond[pairs]; // F from a point of the receiver, if nothing stands between
    uint8_t blocked[pairs] = {};
    std::size_t n = 0;
};

std::pair<const Linker::Places&, const Linker::Places&> Linker::placesOf(const Pair& pair) const noexcept {
    const uint64_t hash = hashCombine(pair.first, pair.second);
    return {places_[pair.first * std::size_t(variants) + hash % variants],
            places_[pair.second * std::size_t(variants) + hash / variants % variants]};
}

Linker::Between Linker::between(const Pair& pair) const noexcept {
    const auto [a, b] = placesOf(pair);
    const float ofP = float(tree_[pair.first].area) / points, ofQ = float(tree_[pair.second].area) / points;
    Between x;
    for (int i = 0; i < points; ++i)
        for (int j = 0; j < points; ++j) {
            const Vec3 o{a.x[i], a.y[i], a.z[i]}, way{b.x[j] - o.x, b.y[j] - o.y, b.z[j] - o.z};
            const float squared = lengthSquared(way), ca = a.nx[i] * way.x + a.ny[i] * way.y + a.nz[i] * way.z,
                        cb = -(b.nx[j] * way.x + b.ny[j] * way.y + b.nz[j] * way.z);
            if (!(ca > 0 && cb > 0)) continue;
            const float both = ca * cb / squared;
            x.toFirst[x.n] = ofQ * both / (pi * squared + ofQ); // a disc of that area (Wallace 1989)
            x.toSecond[x.n] = ofP * both / (pi * squared + ofP);
            x.open[x.n] = a.open[i] * b.open[j];
            x.of[x.n++] = uint8_t(i * points + j);
        }
    return x;
}

void Linker::shoot(const Pair& pair, Between& x) const noexcept {
    const auto [a, b] = placesOf(pair);
    Ray rays[pairs];
    for (std::size_t k = 0; k < x.n; ++k) {
        const int i = x.of[k] / points, j = x.of[k] % points;
        const Vec3 o{a.x[i], a.y[i], a.z[i]}, way{b.x[j] - o.x, b.y[j] - o.y, b.z[j] - o.z};
        const float distance = length(way);
        rays[k] = {o, 0, way * (1 / distance), distance, factors_.patches().time()};
    }
    if (x.n > 0) work_.scene.occluded({rays, x.n}, {x.blocked, x.n});
}

bool Linker::fine(uint32_t to, uint32_t from, const Exchange& e) const noexcept {
    return tree_[to].area * (double(e.range) * brightness_[from] + double(e.across) * deviation_[from]) <= allowed_ * dim_[to];
}

bool Linker::tooMuch(const Pair& pair, float ofFirst, float ofSecond) const noexcept {
    return (!(pair.ways & toFirst) || !fine(pair.first, pair.second, {ofFirst, ofFirst, 0})) &&
           (!(pair.ways & toSecond) || !fine(pair.second, pair.first, {ofSecond, ofSecond, 0}));
}

// Whatever rays would say: the least range is too much. What is not seen at all is not known better than by so few rays, and of what is
// seen four points may agree by chance.
bool Linker::surelyTooMuch(const Pair& pair) const noexcept {
    const Hierarchy::Node &p = tree_[pair.first], &q = tree_[pair.second];
    const float ofFirst = fewest(p, q), ofSecond = fewest(q, p);
    if (!tooMuch(pair, ofFirst, ofSecond)) return false;
    if (touching(p, q)) return true;
    if (!p.flat || !q.flat) return false;
    // As if all of it were where the middle is.
    const Vec3 way = q.centre - p.centre;
    const float squared = lengthSquared(way), both = dot(p.axis, way) * -dot(q.axis, way) / sqr(squared);
    const float share = rough * floorOfRange * max(both, 0.f) / pi;
    return tooMuch(pair, min(share * float(q.area), ofFirst), min(share * float(p.area), ofSecond));
}
bool Linker::surelyTooMuch(const Pair& pair, const Between& x) const noexcept {
    float first = 0, second = 0;
    for (std::size_t k = 0; k < x.n; ++k) first += x.toFirst[k], second += x.toSecond[k];
    const Hierarchy::Node &p = tree_[pair.first], &q = tree_[pair.second];
    return tooMuch(pair, min(floorOfRange * first / points, fewest(p, q)), min(floorOfRange * second / points, fewest(q, p)));
}

Linker::Exchange Linker::exchange(uint32_t to, uint32_t from, const Between& x, bool second) const noexcept {
    const Hierarchy::Node &p = tree_[to], &q = tree_[from];
    if (x.n == 0) return {fewest(p, q), fewest(p, q), 0};
    const float* kernel = second ? x.toSecond : x.toFirst;
    float all = 0, seen = 0, ofFirst[points] = {}, ofSecond[points] = {};
    for (std::size_t k = 0; k < x.n; ++k) {
        all += kernel[k];
        if (x.blocked[k]) continue;
        const float arrives = kernel[k] / x.open[k];
        seen += arrives;
        ofFirst[x.of[k] / points] += arrives;
        ofSecond[x.of[k] % points] += arrives;
    }
    const auto rangeOf = [](const float* each) {
        const auto [least, most] = std::minmax_element(each, each + points);
        return *most - *least;
    };
    // Each of the sender's points stands for a quarter of it.
    Exchange e{rangeOf(second ? ofSecond : ofFirst), rangeOf(second ? ofFirst : ofSecond), seen / points};
    e.range = max(e.range, floorOfRange * e.factor);
    e.across = max(e.across, floorOfRange * e.factor);
    if (seen > 0 && p.leaf() && q.leaf() && lengthSquared(q.centre - p.centre) < 16 * float(std::max(p.area, q.area)))
        e.factor = float(factors_.unoccluded(tree_.patch(to), tree_.patch(from))) * seen / all;
    // Where they may touch, most of the exchange can lie between points that were not drawn.
    if (seen == 0 || touching(p, q)) e.range = max(e.range, fewest(p, q)), e.across = max(e.across, fewest(p, q));
    e.factor = min(e.factor, 1.f);
    return e;
}

// Links, or the pairs that take its place, or both: one way done, the other not.
void Linker::refine(Pair pair, std::vector<Link>& links, std::vector<Pair>& open) const {
    const auto [first, second, asked] = pair;
    const Hierarchy::Node &p = tree_[first], &q = tree_[second];
    if (first == second) {
        if (p.leaf() || p.flat) return;
        const uint32_t a = tree_.left(first), b = p.right;
        open.insert(open.end(), {{a, a, bothWays}, {a, b, bothWays}, {b, b, bothWays}});
        return;
    }
    if (brightness_[second] == 0) pair.ways &= uint8_t(~toFirst);
    if (brightness_[first] == 0) pair.ways &= uint8_t(~toSecond);
    if (pair.ways == 0 || behind(p, q) || behind(q, p)) return;
    const bool leaves = p.leaf() && q.leaf();
    const bool skip = !leaves && surelyTooMuch(pair);
    Between x;
    if (!skip) x = between(pair);
    if (leaves || !(skip || surelyTooMuch(pair, x))) {
        shoot(pair, x);
        for (const uint8_t way : {toFirst, toSecond}) {
            if (!(pair.ways & way)) continue;
            const uint32_t to = way == toFirst ? first : second, from = way == toFirst ? second : first;
            const Exchange e = exchange(to, from, x, way == toSecond);
            if (!leaves && !fine(to, from, e)) continue;
            if (e.factor > 0) links.push_back({to, from, e.factor});
            pair.ways &= uint8_t(~way);
        }
    }
    if (pair.ways == 0) return;
    if (q.leaf() || (!p.leaf() && p.area > q.area)) {
        open.push_back({p.right, second, pair.ways});
        open.push_back({tree_.left(first), second, pair.ways});
    } else {
        open.push_back({first, q.right, pair.ways});
        open.push_back({first, tree_.left(second), pair.ways});
    }
}

std::vector<Link> Linker::refineAll() const {
    std::vector<Link> all;
    std::vector<Pair> seeds{{0, 0, bothWays}}, next;
    while (!seeds.empty() && seeds.size() < seedPairs) {
        next.clear();
        for (const Pair& p : seeds) refine(p, all, next);
        seeds.swap(next);
    }
    std::vector<std::vector<Link>> found(seeds.size());
    std::atomic<uint64_t> count{all.size()};
    std::atomic<bool> full{false};
    const uint64_t most = work_.memoryLimit / (2 * sizeof(Link));
    work_.run.chunks(
        seeds.size(),
        [&](uint64_t k) {
            std::vector<Pair> open{seeds[k]};
            while (!open.empty() && !full) {
                const Pair p = open.back();
                open.pop_back();
                const std::size_t before = found[k].size();
                refine(p, found[k], open);
                if (found[k].size() > before && count.fetch_add(1, std::memory_order_relaxed) > most) full = true;
            }
        },
        &work_.stop);
    if (full)
        throw Error(Exit::resources, fmt::format("radiosity: more than {} links, limit {:.2g} GB. Use a larger link-error, fewer patches, "
                                                 "or solver=stochastic.",
                                                 most, double(work_.memoryLimit) / 1e9));
    all.reserve(count);
    for (std::vector<Link>& f : found) {
        all.insert(all.end(), f.begin(), f.end());
        std::vector<Link>().swap(f);
    }
    return all;
}

} // namespace chiaro::radiosity
