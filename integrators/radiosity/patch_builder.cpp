// From the mesh to the patches: how large, which sides, cut, measured, numbered.
#include "core/math/sobol.h"
#include "core/math/warp.h"
#include "integrators/radiosity/patch_grade.h"
#include "integrators/radiosity/patch_open.h"
#include "integrators/radiosity/patch_points.h"
#include "integrators/radiosity/patch_share.h"
#include "integrators/radiosity/patch_sides.h"
#include "integrators/radiosity/patch_surface.h"
#include "integrators/radiosity/patch_table.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro::radiosity {

constexpr uint32_t leastLooks = 4000; // at facets, for their grades

class PatchBuilder {
public:
    PatchBuilder(const Work& work, const PatchSettings& s) : work_(work), settings_(s) {}
    Patches build();

private:
    void refuseEarly() const;
    [[noreturn]] void refuse() const;
    std::array<Vec3, 4> corners(const Facet&) const;
    float lengthOf(const PatchMesh::Edge& e) const { return length(mesh_.points[e.b] - mesh_.points[e.a]); }
    // Segments of every strand for a size; then the cells of all facets and sides, as far as `most` or a little beyond.
    void segment(float size);
    uint64_t count(float size, uint64_t enough);
    double weigh(float size, double enough);
    // Of patches on a facet, where `size` is that of patches on any.
    float sizeOn(uint32_t facet, float size) const;
    float sizeFor(uint64_t wanted);
    std::array<uint32_t, 4> segmentsOfFacet(const Facet&) const;
    void layOut(float size, Patches&, Patches::Table&);
    void fill(uint32_t facet, float size, Patches&, Patches::Table&) const;
    Vec3 position(const Facet&, const std::array<Vec3, 4>& corner, const Cut&, uint32_t point) const;
    void measure(uint32_t facet, const Cut&, std::span<Patch> front, std::span<Patch> back) const;
    void compactPoints(Patches&, uint32_t points) const;
    void indexParts(Patches::Table&) const;
    void tell(const Patches&, const Patches::Table&, float size) const;

    const Work& work_;
    PatchSettings settings_;
    PatchMesh mesh_;
    std::vector<uint8_t> backs_;
    std::vector<Grade> grades_;           // of facets; empty: all alike
    std::vector<uint32_t> segments_;      // of each strand
    std::optional<PointNumbers> numbers_; // before sides and compaction
    uint32_t parted_ = 0;                 // points that are on both sides of something
};

std::array<Vec3, 4> PatchBuilder::corners(const Facet& f) const {
    std::array<Vec3, 4> c;
    for (uint32_t k = 0; k < 4; ++k) c[k] = mesh_.points[f.point[k < f.corners ? k : 0]];
    return c;
}

void PatchBuilder::refuse() const {
    throw Error(Exit::resources,
                fmt::format("{}: more than {} patches. {}", work_.scene.name().empty() ? "the scene" : work_.scene.name(), settings_.most,
                            settings_.size > 0 ? "Ask for larger ones." : "A patch is no larger than a triangle: simplify the scene."));
}

void PatchBuilder::refuseEarly() const {
    uint64_t triangles = 0;
    for (const DrawnPart& p : work_.scene.parts()) triangles += p.triangles;
    if (triangles / 2 > settings_.most) refuse();
}

void PatchBuilder::segment(float size) {
    segments_.assign(mesh_.strands, 1);
    for (uint32_t i = 0; i < mesh_.facets.size(); ++i) {
        const Facet& f = mesh_.facets[i];
        const float own = sizeOn(i, size);
        for (uint32_t k = 0; k < f.corners; ++k) {
            const PatchMesh::Edge& e = mesh_.edges[f.edge[k]];
            segments_[e.strand] = std::max(segments_[e.strand], segmentsOf(lengthOf(e), own));
        }
    }
}

float PatchBuilder::sizeOn(uint32_t facet, float size) const {
    if (grades_.empty()) return size;
    const Facet& f = mesh_.facets[facet];
    return grades_[facet].size(size, lengthOf(mesh_.edges[f.edge[0]]), lengthOf(mesh_.edges[f.edge[f.corners - 1]]));
}

std::array<uint32_t, 4> PatchBuilder::segmentsOfFacet(const Facet& f) const {
    std::array<uint32_t, 4> n{1, 1, 1, 1};
    for (uint32_t k = 0; k < f.corners; ++k) n[k] = segments_[mesh_.edges[f.edge[k]].strand];
    return n;
}

uint64_t PatchBuilder::count(float size, uint64_t enough) {
    segment(size);
    uint64_t cells = 0;
    for (std::size_t i = 0; i < mesh_.facets.size() && cells <= enough; ++i) {
        const Facet& f = mesh_.facets[i];
        const std::array<Vec3, 4> c = corners(f);
        // Never more than size x size in a cell: a bound before anything is cut.
        const double least = double(length(cross(c[1] - c[0], c[2] - c[0]))) / 2 / (double(size) * size);
        const uint64_t sides = backs_[i] ? 2 : 1;
        cells += least > double(enough) ? enough + 1 : sides * cellsOf(f, c, segmentsOfFacet(f), sizeOn(uint32_t(i), size), nullptr);
    }
    return cells;
}

// As count(), but what is smaller than a patch of that size counts by its area: a thousand triangles of a chair do not keep a wall whole.
double PatchBuilder::weigh(float size, double enough) {
    segment(size);
    const double usual = 0.5 * double(size) * double(size);
    double sum = 0;
    for (std::size_t i = 0; i < mesh_.facets.size() && sum <= enough; ++i) {
        const Facet& f = mesh_.facets[i];
        const std::array<Vec3, 4> c = corners(f);
        const double area = double(length(cross(c[1] - c[0], c[2] - c[0]))) / (f.corners == 4 ? 1 : 2), sides = backs_[i] ? 2 : 1;
        if (area > enough * 2 * usual) return enough + 1; // a bound before anything is cut
        const uint64_t cells = cellsOf(f, c, segmentsOfFacet(f), sizeOn(uint32_t(i), size), nullptr);
        sum += sides * (cells > 1 ? double(cells) : std::min(1.0, area / usual));
    }
    return sum;
}

// The size that gives so many patches, by bisection of its logarithm; the nearest that was met.
float PatchBuilder::sizeFor(uint64_t wanted) {
    float longest = 0;
    for (const PatchMesh::Edge& e : mesh_.edges) longest = max(longest, lengthOf(e));
    if (!(longest > 0)) return 1;
    float large = longest * 1.001f, small = large, best = large;
    double nearest = weigh(large, double(settings_.most));
    if (nearest >= double(wanted)) return large;
    const auto difference = [wanted](double n) { return std::fabs(n - double(wanted)); };
    const auto meet = [&](float size) {
        const double n = weigh(size, 4 * double(wanted) + 1000);
        if (difference(n) < difference(nearest)) nearest = n, best = size;
        return n;
    };
    do small /= 2;
    while (meet(small) < double(wanted) && small > longest * 1e-6f);
    for (int i = 0; i < 16 && difference(nearest) * 50 > double(wanted); ++i) {
        const float middle = std::sqrt(small * large);
        (meet(middle) < double(wanted) ? large : small) = middle;
    }
    return best;
}

Vec3 PatchBuilder::position(const Facet& f, const std::array<Vec3, 4>& c, const Cut& cut, uint32_t point) const {
    const Cut::Point& p = cut.points[point];
    if (point < f.corners) return c[point];
    if (p.edge != 255) { // from the edge alone, so that all that share it have the same bits
        const PatchMesh::Edge& e = mesh_.edges[f.edge[p.edge]];
        const uint32_t n = cut.segments[p.edge], along = f.point[p.edge] == e.a ? p.position : n - p.position;
        return mesh_.points[e.a] + (mesh_.points[e.b] - mesh_.points[e.a]) * (float(along) / float(n));
    }
    if (f.corners == 3) return c[0] + (c[1] - c[0]) * p.s + (c[2] - c[0]) * p.t;
    return c[0] + (c[1] - c[0]) * p.s + (c[3] - c[0] + (c[2] - c[1] + (c[0] - c[3])) * p.s) * p.t;
}

namespace {

// Coordinates of a facet to a triangle of it and the weights of Hit.
SurfaceMeans::Where where(const Facet& f, float s, float t) noexcept {
    float w[4] = {1 - s - t, s, t, 0};
    uint32_t half = 0;
    if (f.corners == 4) {
        const float a = s + f.twistS * s * t, b = t + f.twistT * s * t, p = 1 + f.twistS, q = 1 + f.twistT;
        const bool lower = a * q > b * p; // of corners 0, 1, 2; else 0, 2, 3
        w[2] = lower ? b / q : a / p;
        w[1] = lower ? a - w[2] * p : 0;
        w[3] = lower ? 0 : b - w[2] * q;
        w[0] = 1 - w[1] - w[2] - w[3];
        const auto& of = f.cornerOf[0];
        const bool has1 = of[0] == 1 || of[1] == 1 || of[2] == 1;
        half = lower == has1 ? 0 : 1;
    }
    const auto& of = f.cornerOf[half];
    const float u = clamp01(w[of[1]]);
    return {f.triangle[half], u, std::clamp(w[of[2]], 0.f, 1 - u)};
}

Vec3 newell(const Patch& p) noexcept { return cross(p.corner[2] - p.corner[0], p.corner[p.corners - 1] - p.corner[1]); }

void shape(Patch& p, const Facet& f) noexcept {
    const Vec3 n = p.corners == 3 ? cross(p.corner[1] - p.corner[0], p.corner[2] - p.corner[0]) : newell(p);
    const float twice = length(n);
    p.area = twice / 2;
    p.normal = f.normal;
    p.part = f.part;
    p.error = 2 * f.error;
    p.centre = Vec3{};
    for (uint32_t k = 0; k < p.corners; ++k) p.centre += p.corner[k] * (1 / float(p.corners));
}

Patch turned(const Patch& p) noexcept {
    Patch b = p;
    std::swap(b.corner[1], b.corner[p.corners - 1]);
    std::swap(b.vertex[1], b.vertex[p.corners - 1]);
    b.normal = -p.normal;
    return b;
}

Spectrum below1(const Spectrum& s) noexcept {
    return {std::clamp(s[0], 0.f, oneMinusEpsilon), std::clamp(s[1], 0.f, oneMinusEpsilon), std::clamp(s[2], 0.f, oneMinusEpsilon)};
}

} // namespace

void PatchBuilder::measure(uint32_t facet, const Cut& cut, std::span<Patch> front, std::span<Patch> back) const {
    const Facet& f = mesh_.facets[facet];
    const DrawnPart& part = work_.scene.parts()[f.part];
    SurfaceMeans means(work_.scene, part, work_.shutter.open);
    const std::span<const uint32_t> triangles(f.triangle.data(), f.corners == 4 ? 2 : 1);
    const auto put = [&](std::size_t cell, const Surface& s) {
        Patch& p = front[cell];
        p.coverage = s.coverage;
        p.area *= s.coverage;
        p.reflectance = below1(s.front.reflectance);
        p.emission = s.front.radiance * pi;
        if (back.empty()) return;
        Patch& b = back[cell];
        b.coverage = s.coverage;
        b.area *= s.coverage;
        b.reflectance = below1(s.back.reflectance);
        b.emission = s.back.radiance * pi;
    };
    if (means.plain(triangles)) {
        const SurfaceMeans::Where middle[] = {{f.triangle[0], 1 / 3.f, 1 / 3.f}};
        const Surface s = means.mean(middle);
        for (std::size_t i = 0; i < front.size(); ++i) put(i, s);
        return;
    }
    const uint32_t n = means.pointsFor(f.triangle[0], float(f.corners == 4 ? 2 : 1) / float(front.size()));
    std::vector<SurfaceMeans::Where> points(n);
    for (std::size_t i = 0; i < front.size(); ++i) {
        const auto& cell = cut.cells[i];
        for (uint32_t k = 0; k < n; ++k) {
            const Point2 u = sobolPair(k, 0x9e3779b9u, 0x85ebca6bu);
            const Point2 x = cut.corners == 4 ? u : uniformTriangle(u);
            const auto mix = [&](auto member) {
                const auto at = [&](uint32_t corner) { return cut.points[cell[corner]].*member; };
                if (cut.corners == 3) return at(0) + (at(1) - at(0)) * x.x + (at(2) - at(0)) * x.y;
                return (at(0) * (1 - x.x) + at(1) * x.x) * (1 - x.y) + (at(3) * (1 - x.x) + at(2) * x.x) * x.y;
            };
            points[k] = where(f, mix(&Cut::Point::s), mix(&Cut::Point::t));
        }
        put(i, means.mean(points));
    }
}

void PatchBuilder::fill(uint32_t facet, float size, Patches& patches, Patches::Table& table) const {
    const Facet& f = mesh_.facets[facet];
    const Patches::Table::Cells& place = table.facets[facet];
    const std::array<Vec3, 4> c = corners(f);
    Cut cut;
    const std::size_t n = cellsOf(f, c, segmentsOfFacet(f), sizeOn(facet, size), &cut);
    std::copy(cut.nodes.begin(), cut.nodes.end(), table.nodes.begin() + place.nodes);
    const std::span<Patch> front(&patches.patches_[place.front], n);
    const std::span<Patch> back = place.back == ~0u ? std::span<Patch>() : std::span<Patch>(&patches.patches_[place.back], n);
    for (std::size_t i = 0; i < n; ++i) {
        Patch& p = front[i];
        p.corners = cut.corners;
        for (uint32_t k = 0; k < cut.corners; ++k) {
            p.corner[k] = position(f, c, cut, cut.cells[i][k]);
            p.vertex[k] = numbers_->of(facet, cut, cut.cells[i][k]);
        }
        shape(p, f);
        if (back.empty()) continue;
        back[i] = turned(p);
        for (uint32_t k = 0; k < cut.corners; ++k) back[i].vertex[k] += numbers_->count();
        p.other = place.back + uint32_t(i);
        back[i].other = place.front + uint32_t(i);
    }
    measure(facet, cut, front, back);
}

void PatchBuilder::layOut(float size, Patches& patches, Patches::Table& table) {
    segment(size);
    numbers_.emplace(mesh_, segments_);
    uint64_t cells = 0, nodes = 0;
    for (uint32_t i = 0; i < mesh_.facets.size(); ++i) {
        const Facet& f = mesh_.facets[i];
        const auto n = segmentsOfFacet(f);
        const uint64_t count = cellsOf(f, corners(f), n, sizeOn(i, size), nullptr);
        Patches::Table::Cells& place = table.facets.emplace_back();
        place.normal = f.normal;
        place.segments = {n[0], n[1]};
        place.twistS = f.twistS, place.twistT = f.twistT;
        place.cornerOf = f.cornerOf;
        place.kind = f.corners == 4 ? CutKind::grid : n[0] == n[1] && n[1] == n[2] ? CutKind::uniform : CutKind::bisected;
        place.nodes = uint32_t(nodes);
        if (place.kind == CutKind::bisected) nodes += count - 1;
        place.front = uint32_t(cells);
        cells += count;
        if (backs_[i]) {
            place.back = uint32_t(cells);
            cells += count;
        }
        numbers_->addInside(i, count);
    }
    table.nodes.resize(nodes);
    patches.patches_.resize(cells);
}

void PatchBuilder::compactPoints(Patches& patches, uint32_t points) const {
    std::vector<uint32_t> number(points, ~0u);
    for (Patch& p : patches.patches_)
        for (uint32_t k = 0; k < p.corners; ++k) {
            uint32_t& n = number[p.vertex[k]];
            if (n == ~0u) n = patches.points_++;
            p.vertex[k] = n;
        }
}

void PatchBuilder::indexParts(Patches::Table& table) const {
    const auto parts = work_.scene.parts();
    for (uint32_t i = 0; i < parts.size(); ++i) {
        const DrawnPart& p = parts[i];
        if (p.instance == Hit::none) {
            if (table.firstOfGeometry.size() <= p.geometry) table.firstOfGeometry.resize(p.geometry + 1);
            table.firstOfGeometry[p.geometry] = mesh_.first[i];
        } else if (table.instances.size() <= p.instance) {
            table.instances.resize(p.instance + 1);
            table.instances[p.instance] = {p.geometry, i};
        }
    }
    table.firstOfPart = mesh_.first;
    table.facetOf = mesh_.facetOf;
}

void PatchBuilder::tell(const Patches& patches, const Patches::Table& table, float size) const {
    const auto backs = std::count_if(patches.patches_.begin(), patches.patches_.end(), [](const Patch& p) { return p.other != ~0u; }) / 2;
    work_.notes.tell(
        "patches", fmt::format("{} of {:.3g} m at most, {} of them backs that light reaches", patches.size(), patches.longestEdge_, backs));
    chiaro::radiosity::tell(grades_, work_.notes);
    if (table.crossings.cut > 0)
        work_.notes.tell(
            "patches", fmt::format("{} cut where another surface runs through them, with light on both of its sides", table.crossings.cut));
    if (parted_ > 0) work_.notes.tell("patches", fmt::format("{} points have a value for each side of what stands on them", parted_));
    const auto whole = std::count_if(table.facets.begin(), table.facets.end(), [](const Patches::Table::Cells& c) {
        return c.kind != CutKind::bisected && c.segments[0] == 1 && c.segments[1] == 1;
    });
    const std::size_t uncut = table.crossings.cut > 0 ? table.crossings.root.size() : patches.size();
    if (settings_.size == 0 && double(uncut) > 1.5 * settings_.count)
        work_.notes.tell("patches",
                         fmt::format("more than the {} asked for: {} of {} triangles and flat pairs of them are smaller than the "
                                     "{:.3g} m to which the large ones are cut, and stay whole",
                                     settings_.count, whole, table.facets.size(), size));
    if (mesh_.degenerate) work_.notes.tell("patches", fmt::format("{} degenerate triangles left out", mesh_.degenerate));
    if (!mesh_.moving.empty())
        work_.notes.warn(fmt::format("radiosity takes things that move where they are when the shutter opens: {} of {} parts of the scene",
                                     mesh_.moving.size(), work_.scene.parts().size()));
    tellMaterials(work_.scene, work_.notes);
}

Patches PatchBuilder::build() {
    refuseEarly();
    mesh_ = patchMesh(work_.scene, work_.shutter);
    backs_ = reachedBacks(work_, mesh_);
    float size = settings_.size > 0 ? settings_.size : sizeFor(settings_.count);
    grades_ = grades(work_, mesh_, backs_, size, std::max(settings_.count, leastLooks));
    if (settings_.size == 0) size = sizeFor(settings_.count);
    const uint64_t n = count(size, settings_.most);
    if (n > settings_.most) refuse();
    if (const double bytes = double(n) * (sizeof(Patch) + 64); bytes > double(work_.memoryLimit))
        throw Error(Exit::resources, fmt::format("{} patches need about {:.2g} GB, limit {:.2g} GB. Ask for fewer, or raise --max-memory.",
                                                 n, bytes / 1e9, double(work_.memoryLimit) / 1e9));
    Patches patches;
    patches.time_ = work_.shutter.open;
    const auto table = std::make_shared<Patches::Table>();
    layOut(size, patches, *table);
    work_.run.chunks(
        mesh_.facets.size(), [&](uint64_t i) { fill(uint32_t(i), size, patches, *table); }, nullptr);
    indexParts(*table);
    patches.table_ = table;
    patches.lit_ = work_.scene.lights().count() > 0;
    for (const Patch& p : patches.patches_)
        for (uint32_t k = 0; k < p.corners; ++k)
            patches.longestEdge_ = max(patches.longestEdge_, length(p.corner[(k + 1) % p.corners] - p.corner[k]));
    uint32_t points = 2 * numbers_->count();
    table->crossings = cutCrossed(work_, patches, patches.patches_, points);
    const std::vector<Open> open = openParts(work_, patches);
    for (std::size_t i = 0; i < open.size(); ++i) {
        Patch& p = patches.patches_[i];
        p.open = open[i].share;
        p.area *= open[i].share;
        p.centre = open[i].centre;
    }
    compactPoints(patches, points);
    parted_ = partPoints(work_, patches.patches_, patches.points_, patches.time_);
    tell(patches, *table, size);
    return patches;
}

Patches Patches::of(const Work& work, const PatchSettings& settings) { return PatchBuilder(work, settings).build(); }

} // namespace chiaro::radiosity
