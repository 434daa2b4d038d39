#include "integrators/emission_guide.h"
#include <algorithm>

namespace chiaro {
namespace {

constexpr int bins = 8;                // a cell is cut at an eighth of its side, at two, ...
constexpr std::size_t fewest = 128;    // samples of the pilot in a cell that is cut
constexpr uint32_t deepest = 40;       // cuts one inside the other
constexpr double least = 1e-3;         // of all, that a cut must gain
constexpr double everywhere = 0.2;     // share of the particles that go evenly: what the pilot overlooked weighs five times at most
constexpr double worthwhile = 4.0 / 3; // times less variance

} // namespace

// A cell of volume V in which a particle is worth w takes part in the second moment with V M / p, M the integral of w^2 over it, p its
// probability: p in proportion to sqrt(V M) is best, and the second moment then the square of the sum of these roots. A cut is worth by how
// much it makes that sum smaller.
struct EmissionGuide::Learner {
    struct Cell {
        std::size_t begin = 0, end = 0; // of the samples in it
        double volume = 1, root = 0;    // sqrt(V M)
        std::array<double, dimensions> low{}, high{};
        double p = 0;
    };
    std::vector<Sample> samples;
    std::vector<Node> nodes;
    std::vector<Cell> cells; // of the nodes

    double rootOf(const Cell& c) const {
        double sum = 0;
        for (std::size_t i = c.begin; i < c.end; ++i) sum += double(samples[i].worth) * double(samples[i].worth);
        return std::sqrt(c.volume * sum / double(samples.size()));
    }
    struct Cut {
        int dimension = -1, at = 0; // eighths
        double gain = 0;
    };
    Cut best(const Cell& c) const {
        double moment[dimensions][bins] = {};
        for (std::size_t i = c.begin; i < c.end; ++i)
            if (const double w = double(samples[i].worth); w > 0)
                for (std::size_t d = 0; d < dimensions; ++d) {
                    const double x = (double(samples[i].u[d]) - c.low[d]) / (c.high[d] - c.low[d]);
                    moment[d][std::clamp(int(x * bins), 0, bins - 1)] += w * w;
                }
        Cut cut;
        for (int d = 0; d < dimensions; ++d) {
            double all = 0, below = 0;
            for (const double m : moment[d]) all += m;
            for (int k = 1; k < bins; ++k) {
                below += moment[d][k - 1];
                const double part = double(k) / bins;
                const double roots = std::sqrt(part * below) + std::sqrt((1 - part) * std::max(0.0, all - below));
                const double gain = c.root - roots * std::sqrt(c.volume / double(samples.size()));
                if (gain > cut.gain) cut = {d, k, gain};
            }
        }
        return cut;
    }
    void grow(uint32_t node, uint32_t depth) {
        const Cell cell = cells[node];
        if (depth >= deepest || cell.end - cell.begin < fewest) return;
        const Cut cut = best(cell);
        if (cut.dimension < 0 || cut.gain < least * cells[0].root) return;
        const auto d = std::size_t(cut.dimension);
        const double part = double(cut.at) / bins, split = cell.low[d] + part * (cell.high[d] - cell.low[d]);
        const auto middle = std::partition(samples.begin() + std::ptrdiff_t(cell.begin), samples.begin() + std::ptrdiff_t(cell.end),
                                           [&](const Sample& s) { return double(s.u[d]) < split; });
        const auto at = std::size_t(middle - samples.begin());
        const auto child = uint32_t(nodes.size());
        Cell half[2] = {cell, cell};
        half[0].end = half[1].begin = at;
        half[0].high[d] = half[1].low[d] = split;
        half[0].volume *= part;
        half[1].volume *= 1 - part;
        for (Cell& h : half) {
            h.root = rootOf(h);
            nodes.push_back({});
            cells.push_back(h);
        }
        nodes[node] = {float(part), 0.5f, child, uint8_t(d)};
        for (const uint32_t i : {child, child + 1}) grow(i, depth + 1);
    }
    // The probabilities of the leaves, and of each half from them.
    void weigh() {
        double sum = 0;
        for (std::size_t i = 0; i < nodes.size(); ++i)
            if (nodes[i].child == 0) sum += cells[i].root;
        for (std::size_t i = nodes.size(); i-- > 0;) { // children stand behind their parents
            Cell& c = cells[i];
            if (nodes[i].child == 0) {
                c.p = everywhere * c.volume + (1 - everywhere) * c.root / sum;
                continue;
            }
            c.p = cells[nodes[i].child].p + cells[nodes[i].child + 1].p;
            nodes[i].lower = float(cells[nodes[i].child].p / c.p);
        }
    }
    // Of samples that it has not learned from: second moment without the guide over that with it, and the same of photons.
    double gainOf(const std::vector<Sample>& others, double& photons) const {
        double plain = 0, guided = 0, wanted = 0, aimed = 0;
        for (const Sample& s : others) {
            if (!(s.worth > 0)) continue;
            uint32_t i = 0;
            while (nodes[i].child != 0) {
                const Node& n = nodes[i];
                const Cell& lower = cells[n.child];
                i = n.child + (double(s.u[n.dimension]) < lower.high[n.dimension] ? 0 : 1);
            }
            const double w2 = double(s.worth) * double(s.worth), more = cells[i].p / cells[i].volume;
            plain += w2;
            guided += w2 / more;
            wanted += 1;
            aimed += more;
        }
        photons = wanted > 0 ? aimed / wanted : 1;
        return guided > 0 ? plain / guided : 1;
    }
};

std::array<float, EmissionGuide::dimensions> EmissionGuide::numbers(const Departure& d) noexcept {
    return {float(d.from.pick), d.from.u.x, d.from.u.y, float(d.towards.pick), d.towards.u.x, d.towards.u.y};
}

std::shared_ptr<const EmissionGuide> EmissionGuide::learn(std::vector<Sample> samples) {
    std::vector<Sample> others;
    Learner learner;
    // Halves of a sequence are each well spread; every other number of one would lie in one half of the space.
    const auto middle = samples.begin() + std::ptrdiff_t(samples.size() / 2);
    learner.samples.assign(samples.begin(), middle);
    others.assign(middle, samples.end());
    if (learner.samples.empty()) return nullptr;
    Learner::Cell all{.begin = 0, .end = learner.samples.size()};
    all.high.fill(1);
    all.root = learner.rootOf(all);
    if (!(all.root > 0)) return nullptr;
    learner.nodes.push_back({});
    learner.cells.push_back(all);
    learner.grow(0, 0);
    learner.weigh();
    auto guide = std::make_shared<EmissionGuide>();
    if (learner.gainOf(others, guide->gain_) < worthwhile) return nullptr;
    guide->nodes_ = std::move(learner.nodes);
    return guide;
}

float EmissionGuide::aim(Departure& d) const noexcept {
    double u[dimensions] = {d.from.pick,    double(d.from.u.x),    double(d.from.u.y),
                            d.towards.pick, double(d.towards.u.x), double(d.towards.u.y)};
    double low[dimensions] = {}, side[dimensions] = {1, 1, 1, 1, 1, 1}, factor = 1;
    for (uint32_t i = 0; nodes_[i].child != 0;) {
        const Node& n = nodes_[i];
        double& x = u[n.dimension];
        const double part = double(n.split), p = double(n.lower);
        if (x < p) {
            x /= p;
            side[n.dimension] *= part;
            factor *= part / p;
            i = n.child;
        } else {
            x = std::min((x - p) / (1 - p), 1.0);
            low[n.dimension] += part * side[n.dimension];
            side[n.dimension] *= 1 - part;
            factor *= (1 - part) / (1 - p);
            i = n.child + 1;
        }
    }
    for (int k = 0; k < dimensions; ++k) u[k] = std::min(low[k] + u[k] * side[k], k % 3 == 0 ? 1 - 0x1p-32 : double(oneMinusEpsilon));
    d.from = {u[0], {float(u[1]), float(u[2])}};
    d.towards = {u[3], {min(float(u[4]), oneMinusEpsilon), min(float(u[5]), oneMinusEpsilon)}};
    return float(factor);
}

} // namespace chiaro
