#include "integrators/radiosity/patch_grade.h"
#include "core/math/sobol.h"
#include "core/math/warp.h"
#include "integrators/radiosity/patch_surface.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::radiosity {
namespace {

constexpr float leastGrade = 1 / 16.f; // no finer than that
constexpr float slack = 3;             // times the edge that would be best: walls with the usual light stay as they are
constexpr float nearly = 0.7f;         // is as good as all
constexpr double tail = 5e-3;          // of the light that is sent on: from surfaces that nobody looks at
constexpr int across = 4;              // points along either edge of a facet
constexpr uint32_t rays = 8;           // from each, twice
constexpr uint32_t firstRays = 8;      // from anywhere on a facet, for the first look
constexpr uint64_t perChunk = 64;

struct Candidate {
    uint32_t facet = 0;
    bool back = false;
    double power = 0; // of direct light that it sends on, lumen
    double area = 0;
};

class Grader {
public:
    Grader(const Work& work, const PatchMesh& mesh, std::span<const uint8_t> backs) : work_(work), mesh_(mesh), backs_(backs) {}
    std::vector<Grade> run(float size, uint64_t most) const {
        std::vector<Candidate> all = candidates(size);
        double power = 0, area = 0;
        for (const Candidate& c : all) power += c.power, area += c.area;
        std::vector<Grade> out(mesh_.facets.size());
        if (!(power > 0)) return out;
        std::sort(all.begin(), all.end(),
                  [](const Candidate& a, const Candidate& b) { return a.power != b.power ? a.power > b.power : a.facet < b.facet; });
        double sum = 0;
        std::size_t n = 0;
        while (n < std::min<uint64_t>(all.size(), most) && sum < (1 - tail) * power) sum += all[n++].power;
        // What is usual: the mean exitance, and the edge of a cube of that surface.
        const double usual = std::sqrt(area / 6), exitance = power / area;
        std::vector<Grade> found(n);
        forAll(n, [&](std::size_t i) { found[i] = look(all[i], usual, exitance); });
        for (std::size_t i = 0; i < n; ++i) {
            Grade& g = out[all[i].facet];
            g.first = min(g.first, found[i].first);
            g.last = min(g.last, found[i].last);
        }
        return out;
    }

private:
    template <class F> void forAll(std::size_t n, F&& one) const {
        work_.run.chunks((n + perChunk - 1) / perChunk,
                         [&](uint64_t chunk) {
                             for (std::size_t i = chunk * perChunk; i < std::min<std::size_t>(n, (chunk + 1) * perChunk); ++i) one(i);
                         },
                         &work_.stop);
    }
    const Vec3& corner(const Facet& f, uint32_t k) const noexcept { return mesh_.points[f.point[k]]; }
    double areaOf(const Facet& f) const noexcept {
        const Vec3 first = corner(f, 1) - corner(f, 0), last = corner(f, f.corners - 1) - corner(f, 0);
        return double(length(cross(first, last))) / (f.corners == 4 ? 1 : 2);
    }
    Vec3 point(const Facet& f, float s, float t) const noexcept {
        const Vec3 &a = corner(f, 0), &b = corner(f, 1), &c = corner(f, f.corners - 1);
        Vec3 p = a + (b - a) * s + (c - a) * t;
        if (f.corners == 4) p += (corner(f, 2) - b + (a - c)) * (s * t);
        return p;
    }
    // Luminance of the direct light that arrives at a point, by rays to the lights alone.
    double arrives(const Facet& f, bool back, const Vec3& p, const Sampler& base, uint32_t begin, uint32_t n) const noexcept {
        SurfacePoint from;
        from.p = p;
        from.ng = from.ns = back ? -f.normal : f.normal;
        from.error = f.error;
        from.time = work_.shutter.open;
        double sum = 0;
        for (uint32_t k = begin; k < begin + n; ++k) {
            Sampler u = base.at(k);
            const PickAndPoint to = u.get3D();
            const auto light = work_.scene.lights().sampleTowards(from, to.pick, to.u);
            if (!light || !(light->pdfW > 0)) continue;
            const float cosine = dot(from.ng, light->wi);
            if (!(cosine > 0) || work_.scene.occluded(light->shadow)) continue;
            sum += double(luminance(light->radiance) * cosine / light->pdfW);
        }
        return sum / n;
    }
    Sampler samplerOf(const Candidate& c, uint32_t salt) const noexcept {
        return Sampler(0, SamplerKind::sobol, Stream::prepass, hashCombine(salt, uint64_t(c.facet) * 2 + c.back), 0);
    }
    std::vector<Candidate> candidates(float size) const {
        std::vector<Candidate> all;
        for (uint32_t i = 0; i < mesh_.facets.size(); ++i) {
            const Facet& f = mesh_.facets[i];
            if (!mayReflect(work_.scene.material(work_.scene.parts()[f.part].material))) continue;
            for (const bool back : {false, true})
                if (!back || backs_[i]) all.push_back({i, back, 0, areaOf(f)});
        }
        forAll(all.size(), [&](std::size_t i) { all[i].power = firstLook(all[i], size); });
        return all;
    }
    // Small facets stand for the light alone, and are never cut.
    double firstLook(const Candidate& c, float size) const {
        const Facet& f = mesh_.facets[c.facet];
        const float longest = max(length(corner(f, 1) - corner(f, 0)), length(corner(f, f.corners - 1) - corner(f, 0)));
        const Sampler base = samplerOf(c, 0x6ade);
        const uint32_t n = longest > leastGrade * size ? firstRays : 1;
        double sum = 0;
        for (uint32_t k = 0; k < n; ++k) {
            const Point2 u = sobolPair(k, uint32_t(hashMix(c.facet)), uint32_t(hashMix(c.facet) >> 32));
            const Point2 at = f.corners == 4 ? u : uniformTriangle(u);
            sum += arrives(f, c.back, point(f, at.x, at.y), base, k, 1);
        }
        if (sum == 0) return 0;
        const DrawnPart& part = work_.scene.parts()[f.part];
        SurfaceMeans means(work_.scene, part, work_.shutter.open);
        const SurfaceMeans::Where middle[] = {{f.triangle[0], 1 / 3.f, 1 / 3.f}};
        const Surface s = means.mean(middle);
        return sum / n * c.area * double(luminance((c.back ? s.back : s.front).reflectance));
    }
    Grade look(const Candidate& c, double usual, double exitance) const {
        const Facet& f = mesh_.facets[c.facet];
        const Sampler base = samplerOf(c, 0x6adf);
        // The same rays from all points, twice: the product of two differences has no noise in its mean.
        double light[2][across][across];
        double sum = 0;
        int points = 0;
        const auto has = [&](int i, int j) { return f.corners == 4 || i + j < across; };
        for (int i = 0; i < across; ++i)
            for (int j = 0; j < across; ++j) {
                if (!has(i, j)) continue;
                const float inset = f.corners == 4 ? 0.5f : 1 / 3.f;
                const Vec3 p = point(f, (float(i) + inset) / across, (float(j) + inset) / across);
                for (uint32_t k = 0; k < 2; ++k) sum += light[k][i][j] = arrives(f, c.back, p, base, k * rays, rays);
                ++points;
            }
        const double mean = sum / (2 * points);
        if (!(mean > 0)) return {};
        const auto grade = [&](int di, int dj, uint32_t end) {
            double squares = 0;
            int pairs = 0;
            for (int i = 0; i + di < across; ++i)
                for (int j = 0; j + dj < across; ++j) {
                    if (!has(i + di, j + dj)) continue;
                    squares += (light[0][i + di][j + dj] - light[0][i][j]) * (light[1][i + di][j + dj] - light[1][i][j]);
                    ++pairs;
                }
            const double change = across * std::sqrt(std::max(squares / pairs, 0.0)) / mean; // from end to end, relative
            const double over = double(length(corner(f, end) - corner(f, 0))) / std::max(change, 1e-6);
            const float best = slack * float(std::sqrt(over / usual) * std::pow(exitance * c.area / c.power, 0.25));
            return best > nearly ? 1.f : max(best, leastGrade);
        };
        return {grade(1, 0, 1), grade(0, 1, f.corners - 1)};
    }

    const Work& work_;
    const PatchMesh& mesh_;
    std::span<const uint8_t> backs_;
};

} // namespace

std::vector<Grade> grades(const Work& work, const PatchMesh& mesh, std::span<const uint8_t> backs, float size, uint64_t most) {
    if (work.scene.lights().count() == 0) return {};
    return Grader(work, mesh, backs).run(size, most);
}

void tell(std::span<const Grade> grades, Diagnostics& notes) {
    const auto of = [](const Grade& g) { return min(g.first, g.last); };
    const auto finer = std::count_if(grades.begin(), grades.end(), [&](const Grade& g) { return of(g) < 1; });
    if (finer == 0) return;
    float finest = 1;
    for (const Grade& g : grades) finest = min(finest, of(g));
    notes.tell("patches", fmt::format("{} triangles and flat pairs of them cut finer, down to {:.2g} of the usual edge, for the light on "
                                      "them changes fast",
                                      finer, finest));
}

} // namespace chiaro::radiosity
