#include "integrators/radiosity/solve_links.h"
#include "core/math/sampler.h"
#include "core/math/warp.h"
#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace chiaro::radiosity {
namespace {

constexpr int points = 4, pairs = points * points; // of a node, and between two
constexpr double coarser = 30;                     // links of the first estimate of B
constexpr double little = 0.05;                    // of the mean radiosity
constexpr double dimmest = 1e-3;                   // of the mean irradiance
constexpr double brighter = 2;                     // the mean than what is called dim
constexpr std::size_t seedPairs = 4096;            // that are refined side by side
constexpr float floorOfRange = 0.05f;              // relative: four points may agree by chance

struct Link {
    uint32_t to = 0, from = 0;
    float factor = 0;
};
struct Exchange {
    float factor = 0, range = 0; // F from p to q, and how far it differs between points of p
};

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

class Linker {
public:
    Linker(const Work& work, const FormFactors& factors, const Hierarchy& tree) : work_(work), factors_(factors), tree_(tree) {}

    // All links for radiosities and irradiances of patches like these; empty answer: stopped. What a link may get wrong is a share of what
    // arrives where it ends, but never more than that of a patch in the mean light: a dim room beside a bright place has an error of its
    // own.
    std::vector<Link> link(std::span<const Light> radiosity, std::span<const double> arrives, const System& system, double linkError) {
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

private:
    // The harmonic mean over what reflects, for a node that is dim in part must be linked as its dim part.
    void compareLight(std::span<const double> arrives, const System& system) {
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
    using Pair = std::pair<uint32_t, uint32_t>;
    // Either one link (or none), or the pairs that take its place.
    void refine(Pair pair, std::vector<Link>& links, std::vector<Pair>& open) const {
        const auto [to, from] = pair;
        const Hierarchy::Node &p = tree_[to], &q = tree_[from];
        if (to == from) {
            if (p.leaf() || p.flat) return;
            const uint32_t a = tree_.left(to), b = p.right;
            open.insert(open.end(), {{a, a}, {a, b}, {b, a}, {b, b}});
            return;
        }
        if (brightness_[from] == 0 || behind(p, q) || behind(q, p)) return;
        const Exchange e = exchange(to, from);
        const double wrong = p.area * (double(e.range) * brightness_[from] + double(e.factor) * deviation_[from]);
        if ((p.leaf() && q.leaf()) || wrong <= allowed_ * dim_[to]) {
            if (e.factor > 0) links.push_back({to, from, e.factor});
        } else if (q.leaf() || (!p.leaf() && p.area > q.area)) {
            open.push_back({p.right, from});
            open.push_back({tree_.left(to), from});
        } else {
            open.push_back({to, q.right});
            open.push_back({to, tree_.left(from)});
        }
    }
    std::vector<Link> refineAll() const {
        std::vector<Link> all;
        std::vector<Pair> seeds{{0, 0}}, next;
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
            throw Error(Exit::resources,
                        fmt::format("radiosity: more than {} links, limit {:.2g} GB. Use a larger link-error, fewer patches, "
                                    "or solver=stochastic.",
                                    most, double(work_.memoryLimit) / 1e9));
        all.reserve(count);
        for (std::vector<Link>& f : found) {
            all.insert(all.end(), f.begin(), f.end());
            std::vector<Link>().swap(f);
        }
        return all;
    }

    struct Side {
        Vec3 p, normal;
        const Patch* patch = nullptr;
    };
    Side place(uint32_t node, Sampler u) const noexcept {
        const PickAndPoint at = u.get3D();
        const uint32_t patch = tree_.pick(node, float(at.pick));
        const Patch& p = factors_.patches()[patch];
        return {factors_.patches().point(patch, at.u), p.normal, &p};
    }
    Exchange exchange(uint32_t to, uint32_t from) const noexcept {
        const Hierarchy::Node &p = tree_[to], &q = tree_[from];
        const Sampler ofP(work_.seed, SamplerKind::sobol, Stream::prepass, uint64_t(to) << 32 | from, 0);
        Sampler ofQ = ofP;
        ofQ.skip(3);
        const float part = float(q.area) / points;
        float kernel[pairs] = {}, each[points] = {};
        Ray rays[pairs];
        int of[pairs];
        float open[pairs]; // points are drawn where patches are not open, too; there nothing is seen
        std::size_t n = 0;
        for (int i = 0; i < points; ++i) {
            const Side a = place(to, ofP.at(uint32_t(i)));
            for (int j = 0; j < points; ++j) {
                const Side b = place(from, ofQ.at(uint32_t(i * points + j)));
                const Vec3 way = b.p - a.p;
                const float squared = lengthSquared(way), ca = dot(a.normal, way), cb = -dot(b.normal, way);
                if (!(ca > 0 && cb > 0)) continue;
                kernel[i * points + j] = part * ca * cb / (squared * (pi * squared + part)); // a disc of that area (Wallace 1989)
                const Vec3 o = a.patch->outside(a.p), d = b.patch->outside(b.p) - o;
                const float distance = length(d);
                if (!(distance > 0)) continue;
                rays[n] = {o, 0, d * (1 / distance), distance, factors_.patches().time()};
                open[n] = a.patch->open * b.patch->open;
                of[n++] = i * points + j;
            }
        }
        if (n == 0) return {0, fewest(p, q)};
        uint8_t blocked[pairs] = {};
        work_.scene.occluded({rays, n}, {blocked, n});
        float all = 0, seen = 0;
        for (std::size_t k = 0; k < n; ++k) {
            all += kernel[of[k]];
            if (blocked[k]) continue;
            const float arrives = kernel[of[k]] / open[k];
            seen += arrives;
            each[of[k] / points] += arrives;
        }
        const auto [least, most] = std::minmax_element(each, each + points);
        Exchange e{seen / points, *most - *least};
        e.range = std::max(e.range, floorOfRange * e.factor);
        const bool near = lengthSquared(q.centre - p.centre) < 16 * float(std::max(p.area, q.area));
        if (p.leaf() && q.leaf() && near) e.factor = float(factors_.unoccluded(tree_.patch(to), tree_.patch(from))) * seen / all;
        // Where they may touch, most of the exchange can lie between points that were not drawn.
        if (seen == 0 || length(q.centre - p.centre) < p.radius + q.radius) e.range = std::max(e.range, fewest(p, q));
        e.factor = std::min(e.factor, 1.f);
        return e;
    }
    // What sixteen rays that met nothing may have missed.
    static float fewest(const Hierarchy::Node& p, const Hierarchy::Node& q) noexcept {
        const float gap = std::max(length(q.centre - p.centre), 0.5f * (p.radius + q.radius));
        return std::min(float(q.area) / (pi * gap * gap), 1.f) / pairs;
    }

    const Work& work_;
    const FormFactors& factors_;
    const Hierarchy& tree_;
    std::vector<double> brightness_, deviation_; // of the nodes
    std::vector<double> dim_;                    // what arrives at them, of the mean, at most 1
    double allowed_ = 0;
};

// What the factors of a patch should add up to: the share of its hemisphere in which something lies that sends. By rays; exact in a closed
// room.
class RowSums {
public:
    RowSums(const Work& work, const Patches& patches, const System& system) : sums_(patches.size()) {
        work.run.chunks(
            patches.size(), [&](uint64_t i) { sums_[i] = share(work, patches, system, uint32_t(i)); }, &work.stop);
    }
    // What the light that arrives at each patch is multiplied by, where links that should add up to the sum of a row add up to `found`.
    // From clusters to patches: what many patches lack together many rays know well; of what one patch lacks beyond that, its own rays'
    // answer counts as much as it is better known than that of the links.
    std::vector<double> corrections(const Hierarchy& tree, std::span<const Light> found) const {
        constexpr double linkError = 0.02;
        const std::span<const Hierarchy::Node> nodes = tree.nodes();
        std::vector<double> wanted(nodes.size()), linked(nodes.size()), factor(nodes.size(), 1), ofPatches(sums_.size(), 1);
        for (std::size_t i = nodes.size(); i-- > 0;) {
            if (nodes[i].leaf()) {
                wanted[i] = double(sums_[tree.patch(uint32_t(i))]) * nodes[i].area;
                linked[i] = found[tree.patch(uint32_t(i))][0] * nodes[i].area;
            } else {
                wanted[i] = wanted[i + 1] + wanted[nodes[i].right];
                linked[i] = linked[i + 1] + linked[nodes[i].right];
            }
        }
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            // Of so many rays; one more of each kind, lest they seem sure where all of a few met something (Laplace's rule).
            const double n = double(rays) * nodes[i].count, share = (std::min(wanted[i] / nodes[i].area, 1.0) * n + 1) / (n + 2);
            const double now = linked[i] * factor[i];
            if (now > 0 && wanted[i] > 0) {
                const double trust = sqr(linkError) / (sqr(linkError) + (1 - share) / (share * n));
                factor[i] *= 1 + trust * (std::clamp(wanted[i] / now, 0.5, 2.0) - 1);
            }
            if (nodes[i].leaf())
                ofPatches[tree.patch(uint32_t(i))] = factor[i];
            else
                factor[i + 1] = factor[nodes[i].right] = factor[i];
        }
        return ofPatches;
    }

private:
    static constexpr int rays = 64;
    static float share(const Work& work, const Patches& patches, const System& system, uint32_t i) noexcept {
        constexpr int width = 16;
        const Patch& p = patches[i];
        const Frame frame = Frame::about(p.normal);
        const Sampler base(work.seed, SamplerKind::sobol, Stream::prepass, uint64_t(i) << 32 | 0xffffffff, 0);
        int sum = 0, counted = rays;
        for (int begin = 0; begin < rays; begin += width) {
            Ray ray[width];
            Hit hit[width];
            for (int k = 0; k < width; ++k) {
                Sampler u = base.at(uint32_t(begin + k));
                const Vec3 o = p.outside(patches.point(i, u.get2D()));
                ray[k] = {o, 0, frame.toWorld(cosineHemisphere(u.get2D())), infinity, patches.time()};
            }
            work.scene.intersect({ray, width}, {hit, width}, false);
            for (int k = 0; k < width; ++k) {
                const uint32_t j = hit[k] ? patches.seen(hit[k], ray[k].d) : ~0u;
                if (j == ~0u)
                    counted -= patches.unlit(hit[k]);
                else
                    sum += maxComponent(system.reflectance[j]) > 0 || maxComponent(system.emission[j]) > 0;
            }
        }
        return float(sum) / float(std::max(counted, 1));
    }
    std::vector<float> sums_;
};

// Links by receiver, as a sparse matrix over nodes.
class LinkMatrix {
public:
    LinkMatrix(const Executor& run, const Hierarchy& tree, std::vector<Link> links, const RowSums& sums)
        : run_(run), tree_(tree), begin_(tree.nodes().size() + 1), from_(links.size()), factor_(links.size()), above_(tree.nodes().size()),
          arrived_(tree.nodes().size()) {
        for (const Link& l : links) ++begin_[l.to + 1];
        for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
        std::vector<uint64_t> next(begin_.begin(), begin_.end() - 1);
        for (const Link& l : links) {
            from_[next[l.to]] = l.from;
            factor_[next[l.to]++] = l.factor;
        }
        // Of a radiosity of one everywhere each patch should receive its row sum.
        const std::size_t n = tree.nodes()[0].count;
        Lights3 ones(n, Light(1)), found(n);
        (*this)(ones, found);
        corrections_ = sums.corrections(tree, found);
    }
    void operator()(std::span<const Light> radiosity, std::span<Light> irradiance) {
        constexpr uint64_t nodesPerChunk = 256;
        tree_.pull(radiosity, above_);
        const uint64_t n = arrived_.size();
        run_.chunks((n + nodesPerChunk - 1) / nodesPerChunk,
                    [&](uint64_t chunk) {
                        for (uint64_t i = chunk * nodesPerChunk; i < std::min(n, (chunk + 1) * nodesPerChunk); ++i) {
                            Light sum(0);
                            for (uint64_t k = begin_[i]; k < begin_[i + 1]; ++k) sum += above_[from_[k]] * double(factor_[k]);
                            arrived_[i] = sum;
                        }
                    },
                    nullptr);
        tree_.push(arrived_, irradiance);
        for (std::size_t i = 0; i < corrections_.size(); ++i) irradiance[i] *= corrections_[i];
    }
    std::size_t bytes() const noexcept { return begin_.size() * 8 + from_.size() * 8 + 3 * arrived_.size() * sizeof(Light); }

private:
    const Executor& run_;
    const Hierarchy& tree_;
    std::vector<uint64_t> begin_;
    std::vector<uint32_t> from_;
    std::vector<float> factor_;
    Lights3 above_, arrived_;
    std::vector<double> corrections_; // of the patches
};

} // namespace

Solution solveHierarchical(const Work& work, const FormFactors& factors, const System& system, const Limits& limits, double linkError) {
    Solution s;
    if (system.size() == 0) {
        s.complete = true;
        return s;
    }
    const Run run{work.run, work.stop, work.seed, work.memoryLimit};
    const Hierarchy tree(factors.patches());
    Linker linker(work, factors, tree);
    const RowSums sums(work, factors.patches(), system);
    Lights3 b(system.size());
    std::vector<double> arrives(system.size());
    const double area = std::accumulate(system.areas.begin(), system.areas.end(), 0.0);
    const auto total = [&](const Solution* first) {
        for (std::size_t i = 0; i < b.size(); ++i) {
            const Light arrived = first ? first->irradiance(i) : system.received[i];
            b[i] = system.emission[i] + widened(system.reflectance[i]) * arrived;
            arrives[i] = luminance(arrived);
        }
        // Nobody is held to stay dark: a little light from everywhere.
        const double everywhere = little * power(b, system.areas) / area;
        for (std::size_t i = 0; i < b.size(); ++i) b[i] += widened(system.reflectance[i]) * everywhere;
    };
    total(nullptr);
    for (const double share : {coarser, 1.0}) {
        std::vector<Link> links = linker.link(b, arrives, system, linkError * share);
        if (work.stop.requested()) return s;
        const uint64_t count = links.size();
        LinkMatrix matrix(work.run, tree, std::move(links), sums);
        const auto bounce = [&](std::span<const Light> from, std::span<Light> to) { matrix(from, to); };
        Limits rough;
        rough.tolerance = 1e-3;
        s = neumann(system, bounce, share == 1 ? limits : rough, run);
        if (!s.complete) return s;
        s.links = count;
        s.bytes = matrix.bytes() + count * sizeof(Link) + tree.bytes() + system.size() * sizeof(Light) * (limits.levels() + 4);
        if (share != 1) total(&s);
    }
    return s;
}

} // namespace chiaro::radiosity
