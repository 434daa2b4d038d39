#include "integrators/radiosity/solve_links.h"
#include "core/math/sampler.h"
#include "core/math/warp.h"
#include "integrators/radiosity/link_finder.h"
#include <algorithm>
#include <cmath>
#include <numeric>

namespace chiaro::radiosity {
namespace {

constexpr double coarser = 30;  // links of the first estimate of B
constexpr double little = 0.05; // of the mean radiosity

// A lamp whose light came by rays, on a surface that reflects none, does not.
bool sends(const System& system, std::size_t patch) noexcept {
    return maxComponent(system.reflectance[patch]) > 0 || maxComponent(system.emission[patch]) > 0;
}

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
                    sum += sends(system, j);
            }
        }
        return float(sum) / float(std::max(counted, 1));
    }
    std::vector<float> sums_;
};

// Links by receiver, as a sparse matrix over nodes.
class LinkMatrix {
public:
    LinkMatrix(const Executor& run, const Hierarchy& tree, std::vector<Link> links, const RowSums& sums, const System& system)
        : run_(run), tree_(tree), begin_(tree.nodes().size() + 1), from_(links.size()), factor_(links.size()), above_(tree.nodes().size()),
          arrived_(tree.nodes().size()) {
        for (const Link& l : links) ++begin_[l.to + 1];
        for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
        std::vector<uint64_t> next(begin_.begin(), begin_.end() - 1);
        for (const Link& l : links) {
            from_[next[l.to]] = l.from;
            factor_[next[l.to]++] = l.factor;
        }
        // Of a radiosity of one of all that send each patch should receive its row sum.
        Lights3 ones(system.size()), found(system.size());
        for (std::size_t i = 0; i < ones.size(); ++i) ones[i] = Light(sends(system, i) ? 1 : 0);
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
        LinkMatrix matrix(work.run, tree, std::move(links), sums, system);
        const auto bounce = [&](std::span<const Light> from, std::span<Light> to) { matrix(from, to); };
        Limits rough;
        rough.tolerance = 1e-3;
        s = neumann(system, bounce, share == 1 ? limits : rough, run);
        if (!s.complete) return s;
        s.links = count;
        s.bytes =
            matrix.bytes() + count * sizeof(Link) + tree.bytes() + linker.bytes() + system.size() * sizeof(Light) * (limits.levels() + 4);
        if (share != 1) total(&s);
    }
    return s;
}

} // namespace chiaro::radiosity
