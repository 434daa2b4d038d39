#include "integrators/radiosity/patches.h"
#include "core/render/fault.h"
#include "integrators/radiosity/patch_places.h"
#include "integrators/radiosity/patch_table.h"

namespace chiaro::radiosity {

CellPlace Patches::Table::place(const Cells& f, uint32_t half, float u, float v) const noexcept {
    const std::array<uint8_t, 3>& of = f.cornerOf[half];
    float w[4] = {0, 0, 0, 0};
    w[of[0]] = max(1 - u - v, 0.f), w[of[1]] = u, w[of[2]] = v;
    if (f.kind == CutKind::uniform) return placeInUniform(f.segments[0], w[1], w[2]);
    if (f.kind == CutKind::bisected) return placeInBisected(&nodes[f.nodes], w[1], w[2]);
    if (f.twistS == 0 && f.twistT == 0) return placeInGrid(f.segments[0], f.segments[1], w[1] + w[2], w[3] + w[2]);
    // a = s + twistS s t, b = t + twistT s t: the bilinear map, inverted (the root that is 0 at the edge).
    const float a = w[1] + w[2] * (1 + f.twistS), b = w[3] + w[2] * (1 + f.twistT);
    const float k = 1 + f.twistT * a - f.twistS * b, t = 2 * b / (k + safeSqrt(k * k + 4 * f.twistS * b));
    return placeInGrid(f.segments[0], f.segments[1], a / (1 + f.twistS * t), t);
}

std::optional<Patches::Place> Patches::at(const Hit& hit, bool front) const noexcept {
    const uint32_t facet = table_->facet(hit);
    if (facet == ~0u) return {};
    const Table::Cells& f = table_->facets[facet / 2];
    if (fault(Fault::reflectanceOfOtherSide) && f.back != ~0u) front = !front;
    const uint32_t first = front ? f.front : f.back;
    if (first == ~0u) return {};
    const CellPlace p = table_->place(f, facet % 2, hit.u, hit.v);
    if (const Crossings::Piece* piece = table_->crossings.find(f.front + p.cell, f.kind == CutKind::grid, p.s, p.t)) {
        const Point2 in = within(*piece, p.s, p.t);
        return front ? Place{piece->front, in.x, in.y} : Place{piece->back, in.y, in.x};
    }
    return front ? Place{first + p.cell, p.s, p.t} : Place{first + p.cell, p.t, p.s}; // the back runs the other way around
}

uint32_t Patches::seen(const Hit& hit, const Vec3& direction) const noexcept {
    const uint32_t facet = table_->facet(hit);
    if (facet == ~0u) return ~0u;
    const Table::Cells& f = table_->facets[facet / 2];
    bool front = dot(direction, f.normal) < 0;
    if (fault(Fault::reflectanceOfOtherSide) && f.back != ~0u) front = !front;
    const uint32_t first = front ? f.front : f.back;
    if (first == ~0u) return ~0u;
    const CellPlace p = table_->place(f, facet % 2, hit.u, hit.v);
    if (const Crossings::Piece* piece = table_->crossings.find(f.front + p.cell, f.kind == CutKind::grid, p.s, p.t))
        return front ? piece->front : piece->back;
    return first + p.cell;
}

Vec3 Patches::point(uint32_t patch, Point2 u) const noexcept { return PatchPlaces(patches_[patch]).at(u.x, u.y); }

} // namespace chiaro::radiosity
