#include "integrators/radiosity/patch_cut.h"
#include <algorithm>

namespace chiaro::radiosity {

uint32_t segmentsOf(float length, float size) noexcept {
    // An edge that is too long by no more than the rounding of its ends is not.
    const float n = std::ceil(length / size - 1e-4f);
    return n > 1 ? uint32_t(min(n, 1e6f)) : 1;
}

CellPlace placeInBisected(const CutNode* nodes, float s, float t) noexcept {
    float w[3] = {max(1 - s - t, 0.f), s, t};
    for (int32_t at = 0;;) {
        const CutNode& n = nodes[at];
        float &p = w[n.corner], &q = w[(n.corner + 1) % 3];
        const float f = n.share;
        int side = 0;
        if (p * f >= q * (1 - f)) { // M = (1 - f) P + f Q takes the place of Q
            p = p - q * (1 - f) / f;
            q = q / f;
        } else { // of P
            side = 1;
            q = q - p * f / (1 - f);
            p = p / (1 - f);
        }
        at = n.child[std::size_t(side)];
        if (at < 0) return {uint32_t(~at), w[1], w[2]};
    }
}

namespace {

// The numbers of the points along the edges of a facet: corners, then the points inside each edge, then those inside the facet.
struct Rim {
    std::array<uint32_t, 4> segments, first{};
    uint32_t corners, inside;
    Rim(uint32_t n, const std::array<uint32_t, 4>& s) : segments(s), corners(n), inside(n) {
        for (uint32_t k = 0; k < n; ++k) {
            first[k] = inside;
            inside += s[k] - 1;
        }
    }
    uint32_t at(uint32_t edge, uint32_t i) const noexcept {
        return i == 0 ? edge : i == segments[edge] ? (edge + 1) % corners : first[edge] + i - 1;
    }
};

void addRim(const Rim& rim, Cut& cut) {
    static constexpr float square[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, wedge[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    const auto corner = [&](uint32_t k) { return rim.corners == 4 ? square[k] : wedge[k]; };
    cut.points.assign(rim.inside, {});
    for (uint32_t k = 0; k < rim.corners; ++k) {
        const float *a = corner(k), *b = corner((k + 1) % rim.corners);
        for (uint32_t i = 0; i < rim.segments[k]; ++i) {
            const float f = float(i) / float(rim.segments[k]);
            cut.points[rim.at(k, i)] = {a[0] + (b[0] - a[0]) * f, a[1] + (b[1] - a[1]) * f, uint8_t(k), i};
        }
    }
}

void cutGrid(const Rim& rim, Cut& cut) {
    const uint32_t columns = rim.segments[0], rows = rim.segments[1];
    const auto at = [&](uint32_t i, uint32_t j) {
        if (j == 0) return rim.at(0, i);
        if (i == columns) return rim.at(1, j);
        if (j == rows) return rim.at(2, columns - i);
        if (i == 0) return rim.at(3, rows - j);
        return rim.inside + (j - 1) * (columns - 1) + i - 1;
    };
    for (uint32_t j = 1; j < rows; ++j)
        for (uint32_t i = 1; i < columns; ++i) cut.points.push_back({float(i) / float(columns), float(j) / float(rows)});
    for (uint32_t j = 0; j < rows; ++j)
        for (uint32_t i = 0; i < columns; ++i) cut.cells.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
}

void cutUniform(const Rim& rim, Cut& cut) {
    const uint32_t n = rim.segments[0];
    uint32_t next = rim.inside;
    std::vector<uint32_t> number; // of the points, row by row
    for (uint32_t j = 0; j <= n; ++j)
        for (uint32_t i = 0; i + j <= n; ++i) {
            const bool rimmed = j == 0 || i == 0 || i + j == n;
            if (!rimmed) cut.points.push_back({float(i) / float(n), float(j) / float(n)});
            number.push_back(j == 0 ? rim.at(0, i) : i + j == n ? rim.at(1, j) : i == 0 ? rim.at(2, n - j) : next++);
        }
    const auto at = [&](uint32_t i, uint32_t j) { return number[j * (n + 1) - j * (j - 1) / 2 + i]; };
    for (uint32_t j = 0; j < n; ++j)
        for (uint32_t i = 0; i + j < n; ++i) {
            cut.cells.push_back({at(i, j), at(i + 1, j), at(i, j + 1), 0});
            if (i + j + 1 < n) cut.cells.push_back({at(i + 1, j + 1), at(i, j + 1), at(i + 1, j), 0});
        }
}

// Bisection. Every edge, those of the facet and those that cuts make, is a list of points; a triangle holds a stretch of three of them.
class Bisection {
public:
    Bisection(const std::array<Vec3, 4>& corner, const Rim& rim, float size, Cut* cut) : corner_(corner), size_(size), cut_(cut) {
        if (cut) {
            for (uint32_t k = 0; k < 3; ++k) {
                lines_.emplace_back();
                for (uint32_t i = 0; i <= rim.segments[k]; ++i) lines_.back().push_back(rim.at(k, i));
            }
        }
        Piece whole;
        for (uint32_t k = 0; k < 3; ++k) whole.edge[k] = {k, 0, int32_t(rim.segments[k])};
        whole.at = {{{0, 0}, {1, 0}, {0, 1}}};
        if (cut) whole.point = {0, 1, 2};
        divide(whole);
    }
    uint32_t cells() const noexcept { return cells_; }

private:
    struct Stretch {
        uint32_t line = 0;
        int32_t from = 0, to = 0;
        uint32_t length() const noexcept { return uint32_t(std::abs(to - from)); }
    };
    struct Piece {
        std::array<Stretch, 3> edge;     // from each corner to the next
        std::array<Point2, 3> at;        // corners, in the coordinates of the facet
        std::array<uint32_t, 3> point{}; // their numbers
    };
    Vec3 place(Point2 p) const noexcept { return corner_[0] + (corner_[1] - corner_[0]) * p.x + (corner_[2] - corner_[0]) * p.y; }
    float longOf(const Piece& p, std::size_t k) const noexcept { return length(place(p.at[(k + 1) % 3]) - place(p.at[k])); }

    // What the piece becomes: ~cell or a node.
    int32_t divide(const Piece& p) {
        std::size_t k = 0;
        for (std::size_t j = 1; j < 3; ++j)
            if (p.edge[j].length() > p.edge[k].length() || (p.edge[j].length() == p.edge[k].length() && longOf(p, j) > longOf(p, k))) k = j;
        const Stretch& e = p.edge[k];
        if (e.length() < 2) {
            if (cut_) cut_->cells.push_back({p.point[0], p.point[1], p.point[2], 0});
            return ~int32_t(cells_++);
        }
        const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
        const int32_t middle = (e.from + e.to) / 2;
        const float share = float(std::abs(middle - e.from)) / float(e.length());
        const Point2 a = p.at[k], b = p.at[next], c = p.at[last], m{a.x + (b.x - a.x) * share, a.y + (b.y - a.y) * share};
        const uint32_t segments = segmentsOf(length(place(c) - place(m)), size_);
        const uint32_t line = newLine(m, c, segments, e, middle, p.point[last]);
        Piece first = p, second = p; // the first keeps corner k, the second the next
        first.edge[k].to = middle;
        first.edge[next] = {line, 0, int32_t(segments)};
        first.at[next] = m;
        second.edge[k].from = middle;
        second.edge[last] = {line, int32_t(segments), 0};
        second.at[k] = m;
        if (cut_) first.point[next] = second.point[k] = lines_[line].front();
        if (!cut_) return divide(first), divide(second), 0;
        const std::size_t node = cut_->nodes.size();
        cut_->nodes.push_back({share, {}, uint8_t(k)});
        const int32_t one = divide(first), two = divide(second);
        cut_->nodes[node].child = {one, two};
        return int32_t(node);
    }
    uint32_t newLine(Point2 from, Point2 to, uint32_t segments, const Stretch& cutEdge, int32_t middle, uint32_t end) {
        if (!cut_) return 0;
        std::vector<uint32_t> line{lines_[cutEdge.line][std::size_t(middle)]};
        for (uint32_t i = 1; i < segments; ++i) {
            const float f = float(i) / float(segments);
            line.push_back(uint32_t(cut_->points.size()));
            cut_->points.push_back({from.x + (to.x - from.x) * f, from.y + (to.y - from.y) * f});
        }
        line.push_back(end);
        lines_.push_back(std::move(line));
        return uint32_t(lines_.size() - 1);
    }

    const std::array<Vec3, 4>& corner_;
    float size_;
    Cut* cut_;
    std::vector<std::vector<uint32_t>> lines_;
    uint32_t cells_ = 0;
};

} // namespace

uint64_t cellsOf(const Facet& f, const std::array<Vec3, 4>& corner, const std::array<uint32_t, 4>& segments, float size, Cut* cut) {
    const bool grid = f.corners == 4, uniform = !grid && segments[0] == segments[1] && segments[1] == segments[2];
    const Rim rim(f.corners, segments);
    if (cut) {
        cut->kind = grid ? CutKind::grid : uniform ? CutKind::uniform : CutKind::bisected;
        cut->segments = segments;
        cut->corners = f.corners;
        cut->cells.clear();
        cut->nodes.clear();
        addRim(rim, *cut);
        if (grid) cutGrid(rim, *cut);
        if (uniform) cutUniform(rim, *cut);
    }
    if (grid) return uint64_t(segments[0]) * segments[1];
    if (uniform) return uint64_t(segments[0]) * segments[0];
    return Bisection(corner, rim, size, cut).cells();
}

} // namespace chiaro::radiosity
