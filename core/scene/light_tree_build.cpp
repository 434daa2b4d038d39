// Building a LightTree: a range of emitters is cut in two where the surface area orientation heuristic of the paper is least (equation 1:
// intensity, times the surface of the bounds, times the solid angle into which they shine), until eight parts hang on the node.
#include "core/render/in_parallel.h"
#include "core/scene/light_tree_view.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace chiaro {
namespace {

using Emitter = LightTree::Emitter;
constexpr std::size_t bins = 16;
constexpr uint32_t atOnce = 1u << 12; // emitters below which a subtree is one piece of work
constexpr uint32_t mostOfPatch = 64;
constexpr int deepest = 40; // cuts by the heuristic; below them halves, whatever the coordinates

float component(const Vec3& v, int axis) noexcept { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
Vec3 lower(const Vec3& a, const Vec3& b) noexcept { return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)}; }
Vec3 upper(const Vec3& a, const Vec3& b) noexcept { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }

// Solid angle into which a cone of directions shines, each over its hemisphere, weighed by the cosine (the paper's M_Omega for an emission
// angle of 90 degrees), by the cosine of the cone's half angle.
float orientation(float cosine) noexcept {
    const double o = std::acos(std::clamp(double(cosine), -1.0, 1.0)), w = std::min(o + std::numbers::pi / 2, std::numbers::pi);
    return float(2 * std::numbers::pi * (1 - std::cos(o)) +
                 std::numbers::pi / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o)));
}
class Orientations {
public:
    Orientations() {
        for (std::size_t i = 0; i < table_.size(); ++i) table_[i] = orientation(float(i) / 32 - 1);
    }
    float operator()(float cosine) const noexcept { return table_[std::size_t(std::clamp((cosine + 1) * 32, 0.f, 64.f))]; }

private:
    std::array<float, 65> table_;
};
const Orientations orientations;

// What a cut looks at: the box of the emitters, the box of their axes, their intensity. The cone about a box of axes is the one that
// touches the sphere around it.
struct Heap {
    Vec3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
    Vec3 axisLow{infinity, infinity, infinity}, axisHigh{-infinity, -infinity, -infinity};
    float intensity = 0;
    uint32_t count = 0;

    void add(const Emitter& e) noexcept {
        const Vec3 r{e.radius, e.radius, e.radius}, one{1, 1, 1};
        const bool everywhere = e.cosSpread < 0;
        low = lower(low, e.centre - r);
        high = upper(high, e.centre + r);
        axisLow = lower(axisLow, everywhere ? -one : e.axis);
        axisHigh = upper(axisHigh, everywhere ? one : e.axis);
        intensity += e.intensity;
        ++count;
    }
    void add(const Heap& h) noexcept {
        low = lower(low, h.low);
        high = upper(high, h.high);
        axisLow = lower(axisLow, h.axisLow);
        axisHigh = upper(axisHigh, h.axisHigh);
        intensity += h.intensity;
        count += h.count;
    }
    float cost() const noexcept {
        if (count == 0) return 0;
        const Vec3 d = high - low, middle = (axisLow + axisHigh) * 0.5f, half = (axisHigh - axisLow) * 0.5f;
        const float sine2 = lengthSquared(half) / lengthSquared(middle); // of the cone's half angle; 1 and beyond: everywhere
        return intensity * (d.x * d.y + d.y * d.z + d.z * d.x) * orientations(sine2 < 1 ? std::sqrt(1 - sine2) : -1);
    }
};

struct Range {
    uint32_t begin = 0, end = 0;
    int cuts = 0;       // above it
    bool whole = false; // one patch
    uint32_t count() const noexcept { return end - begin; }
    uint32_t divisible() const noexcept { return whole ? 1 : count(); }
};

} // namespace

class LightTreeBuilder {
public:
    LightTreeBuilder(LightTree& tree, std::span<const Emitter> emitters) : tree_(tree), emitters_(emitters) {}
    void run(const Executor*);
    static LightTreeView view(const LightTree& t) noexcept {
        return {t.nodes_.empty() ? nullptr : t.nodes_.data(), t.members_.data(), LightTree::patch, LightTree::leaf};
    }

private:
    using Node = LightTree::Node;
    struct Part {
        Range range;
        uint32_t parent = 0; // the place it hangs on
        std::vector<Node> nodes;
        std::vector<uint32_t> parents;
    };
    uint32_t cut(const Range&) noexcept;
    // The node of a range, with its children's bounds; what hangs on its places, one emitter or more.
    struct Branches {
        Range range[LightTree::width];
        std::size_t count = 0;
    };
    Branches branches(const Range&) noexcept;
    bool onePatch(const Range&) const noexcept;
    void hangPatch(const Range&, uint32_t place);
    Node node(const Branches&) const noexcept;
    void bound(const Range&, Node&, std::size_t place) const noexcept;
    void build(const Range&, uint32_t parent, std::vector<Node>&, std::vector<uint32_t>& parents, std::vector<Part>* later) noexcept;

    LightTree& tree_;
    std::span<const Emitter> emitters_;
    std::vector<Emitter> order_;
    std::vector<uint32_t> patchEnd_; // of a patch, by its first emitter
};

// Where the second half begins; the emitters of the range are put in order.
uint32_t LightTreeBuilder::cut(const Range& r) noexcept {
    const uint32_t middle = r.begin + r.count() / 2;
    if (r.count() == 2 || r.cuts >= deepest) return middle;
    Vec3 low{infinity, infinity, infinity}, high = -low;
    for (uint32_t i = r.begin; i < r.end; ++i) {
        low = lower(low, order_[i].centre);
        high = upper(high, order_[i].centre);
    }
    const Vec3 extent = high - low;
    const float longest = maxAbs(extent);
    if (!(longest > 0)) return middle;
    const Vec3 scale{extent.x > 0 ? float(bins) / extent.x : 0, extent.y > 0 ? float(bins) / extent.y : 0,
                     extent.z > 0 ? float(bins) / extent.z : 0};
    const auto bin = [&](const Emitter& e, int axis) {
        return std::min(std::size_t((component(e.centre, axis) - component(low, axis)) * component(scale, axis)), bins - 1);
    };
    Heap heaps[3][bins];
    for (uint32_t i = r.begin; i < r.end; ++i)
        for (int axis = 0; axis < 3; ++axis) heaps[axis][bin(order_[i], axis)].add(order_[i]);
    float best = infinity;
    int bestAxis = -1;
    std::size_t bestBin = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (!(component(extent, axis) > 0)) continue;
        const float regular = longest / component(extent, axis); // the paper's K_r: no thin slices
        float above[bins];
        Heap sum;
        for (std::size_t i = bins; i-- > 1;) {
            sum.add(heaps[axis][i]);
            above[i] = sum.cost();
        }
        sum = {};
        for (std::size_t i = 0; i + 1 < bins; ++i) {
            sum.add(heaps[axis][i]);
            if (sum.count == 0 || sum.count == r.count()) continue;
            if (const float cost = regular * (sum.cost() + above[i + 1]); cost < best) {
                best = cost;
                bestAxis = axis;
                bestBin = i;
            }
        }
    }
    if (bestAxis < 0) return middle;
    const auto begin = order_.begin();
    return uint32_t(std::stable_partition(begin + r.begin, begin + r.end, [&](const Emitter& e) { return bin(e, bestAxis) <= bestBin; }) -
                    begin);
}

// One piece of a surface: it fills a good part of the disc around it, faces within 45 degrees of one way, and no part of it is so faint
// that a share in floats would lose it.
bool LightTreeBuilder::onePatch(const Range& r) const noexcept {
    if (r.count() < 2 || r.count() > mostOfPatch) return false;
    Node n{};
    bound(r, n, 0);
    float area = 0, least = infinity;
    for (uint32_t i = r.begin; i < r.end; ++i) {
        area += order_[i].area;
        least = min(least, order_[i].intensity);
        if (order_[i].bothSides != order_[r.begin].bothSides) return false;
    }
    return n.cosSpread[0] > 0.7071f && area > 0.25f * pi * sqr(n.radius[0]) && least > 0x1p-16f * std::fabs(n.intensity[0]);
}

// Called in the order of the places, by one thread.
void LightTreeBuilder::hangPatch(const Range& r, uint32_t place) {
    double sum = 0, sofar = 0;
    for (uint32_t i = r.begin; i < r.end; ++i) sum += double(order_[i].intensity);
    tree_.members_.push_back({r.count(), 0});
    tree_.nodes_[place / LightTree::width].child[place % LightTree::width] = LightTree::patch + uint32_t(tree_.members_.size());
    for (uint32_t i = r.begin; i < r.end; ++i) {
        const auto before = double(tree_.members_.back().upTo);
        sofar += double(order_[i].intensity);
        tree_.members_.push_back({order_[i].light, i + 1 == r.end ? 1.f : float(sofar / sum)});
        tree_.places_[order_[i].light] = {place, float(double(tree_.members_.back().upTo) - before)};
    }
}

LightTreeBuilder::Branches LightTreeBuilder::branches(const Range& whole) noexcept {
    Branches b;
    b.range[b.count++] = whole;
    while (b.count < LightTree::width) {
        Range& largest =
            *std::max_element(b.range, b.range + b.count, [](const Range& x, const Range& y) { return x.divisible() < y.divisible(); });
        if (largest.divisible() < 2) break;
        const uint32_t middle = cut(largest);
        Range after{middle, largest.end, largest.cuts + 1, false}, before{largest.begin, middle, largest.cuts + 1, false};
        after.whole = onePatch(after);
        before.whole = onePatch(before);
        b.range[b.count++] = after;
        largest = before;
    }
    return b;
}

void LightTreeBuilder::bound(const Range& r, Node& n, std::size_t place) const noexcept {
    const auto all = std::span(order_).subspan(r.begin, r.count());
    Heap heap;
    double intensity = 0;
    for (const Emitter& e : all) {
        heap.add(e);
        intensity += double(e.intensity);
    }
    const Vec3 centre = (heap.low + heap.high) * 0.5f;
    float radius = 0;
    bool both = false;
    for (const Emitter& e : all) {
        radius = max(radius, length(e.centre - centre) + e.radius);
        both |= e.bothSides;
    }
    // Axes of what shines on both sides count with either sign.
    const Vec3 first = all[0].axis;
    const auto turned = [&](const Emitter& e) { return e.bothSides && dot(e.axis, first) < 0 ? -e.axis : e.axis; };
    Vec3 sum{};
    for (const Emitter& e : all) sum += turned(e);
    const float size = length(sum);
    const Vec3 axis = size > 0 ? sum * (1 / size) : Vec3{0, 0, 1};
    double angle = size > 0 ? 0 : std::numbers::pi, reach = 0;
    for (const Emitter& e : all) {
        angle = std::max(angle, std::acos(std::clamp(double(dot(axis, turned(e))), -1.0, 1.0)) +
                                    std::acos(std::clamp(double(e.cosSpread), -1.0, 1.0)));
        reach = std::max(reach, std::acos(std::clamp(double(e.cosReach), -1.0, 1.0)));
    }
    angle = std::min(angle + (r.count() > 1 ? 1e-4 : 0), std::numbers::pi);
    n.x[place] = centre.x;
    n.y[place] = centre.y;
    n.z[place] = centre.z;
    n.radius[place] = radius * (1 + 0x1p-20f);
    n.axisX[place] = axis.x;
    n.axisY[place] = axis.y;
    n.axisZ[place] = axis.z;
    n.cosSpread[place] = float(std::cos(angle));
    n.sinSpread[place] = float(std::sin(angle));
    n.cosReach[place] = float(std::cos(reach));
    n.intensity[place] = float(intensity) * (both ? -1.f : 1.f);
}

LightTreeBuilder::Node LightTreeBuilder::node(const Branches& b) const noexcept {
    Node n{};
    for (std::size_t i = 0; i < LightTree::width; ++i) {
        n.radius[i] = 1; // of an empty place: anything finite
        n.child[i] = LightTree::none;
        if (i < b.count) bound(b.range[i], n, i);
    }
    return n;
}

// later: subtrees that are worth a piece of work of their own are put there instead.
void LightTreeBuilder::build(const Range& r, uint32_t parent, std::vector<Node>& nodes, std::vector<uint32_t>& parents,
                             std::vector<Part>* later) noexcept {
    const Branches b = branches(r);
    const auto self = uint32_t(nodes.size());
    nodes.push_back(node(b));
    parents.push_back(parent);
    for (std::size_t i = 0; i < b.count; ++i) {
        const Range& child = b.range[i];
        if (child.divisible() == 1) { // told by its first emitter until all is in place
            nodes[self].child[i] = (child.whole ? LightTree::patch : LightTree::leaf) + child.begin;
            if (child.whole) patchEnd_[child.begin] = child.end;
            continue;
        }
        const auto place = uint32_t(self * LightTree::width + i);
        nodes[self].child[i] = uint32_t(nodes.size());
        if (later && child.count() < atOnce)
            later->push_back({child, place, {}, {}});
        else
            build(child, place, nodes, parents, later);
    }
}

void LightTreeBuilder::run(const Executor* executor) {
    for (const Emitter& e : emitters_)
        if (e.intensity > 0) order_.push_back(e);
    Range all{0, uint32_t(order_.size())};
    if (order_.size() < 2 || (all.whole = onePatch(all))) return;
    patchEnd_.resize(order_.size());
    std::vector<Part> parts;
    build(all, LightTree::none, tree_.nodes_, tree_.parents_, &parts);
    inParallel(executor, parts.size(),
               [&](uint64_t i) { build(parts[i].range, parts[i].parent, parts[i].nodes, parts[i].parents, nullptr); });
    for (const Part& p : parts) {
        const auto base = uint32_t(tree_.nodes_.size());
        tree_.nodes_[p.parent / LightTree::width].child[p.parent % LightTree::width] = base;
        for (std::size_t k = 0; k < p.nodes.size(); ++k) {
            Node& n = tree_.nodes_.emplace_back(p.nodes[k]);
            for (uint32_t& c : n.child)
                if (c < LightTree::patch) c += base;
            tree_.parents_.push_back(k == 0 ? p.parent : p.parents[k] + base * uint32_t(LightTree::width));
        }
    }
    for (uint32_t place = 0; place < tree_.nodes_.size() * LightTree::width; ++place) {
        uint32_t& c = tree_.nodes_[place / LightTree::width].child[place % LightTree::width];
        if (c < LightTree::patch || c == LightTree::none) continue;
        if (c < LightTree::leaf) {
            hangPatch({c - LightTree::patch, patchEnd_[c - LightTree::patch]}, place);
            continue;
        }
        c = LightTree::leaf + order_[c - LightTree::leaf].light;
        tree_.places_[c - LightTree::leaf] = {place, 1};
    }
}

LightTree::LightTree(std::span<const Emitter> emitters, uint32_t lights, const Executor* run) : places_(lights) {
    LightTreeBuilder(*this, emitters).run(run);
    if (nodes_.empty()) places_.clear();
}

LightTreeView viewOf(const LightTree& tree) noexcept { return LightTreeBuilder::view(tree); }

} // namespace chiaro
