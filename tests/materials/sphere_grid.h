// Integrals of a closure over the cells of a grid on the sphere (cos theta by phi), adaptive: what a histogram of samples is held against.
#pragma once
#include "materials/dispersion.h"
#include "tests/materials/closures.h"
#include <algorithm>
#include <vector>

namespace chiaro::test {

// The density of sampling, and the scattered energy f |cos|, green.
struct Integrals {
    double pdf = 0, energy = 0;
    Integrals& operator+=(const Integrals& o) {
        pdf += o.pdf, energy += o.energy;
        return *this;
    }
};

class SphereGrid {
public:
    // Rows by cos theta, thin beside the horizon, where grazing lobes lie flat.
    // One more where the half vector of a refraction turns over: the density jumps there.
    const std::vector<double>& rows() const { return rows_; }
    // Columns by the azimuth from the plane of incidence, where a lobe seen at grazing is a ridge as thin as alpha cos theta.
    static const std::vector<double>& columns() {
        static const std::vector<double> e = bothWays({0, 1e-4, 5e-4, 2e-3, 8e-3, 0.025, 0.07, 0.15}, std::numbers::pi, 14);
        return e;
    }
    std::size_t size() const { return (rows().size() - 1) * (columns().size() - 1); }

    SphereGrid(const Bsdf& bsdf, const Vec3& wo, const BsdfParameters& p, double tolerance = 4e-6) : bsdf_(bsdf), tolerance_(tolerance) {
        const Vec3 o = surface.toLocal(wo);
        phi0_ = std::atan2(double(-o.y), double(-o.x));
        rows_ = bothWays({0, 5e-4, 2e-3, 6e-3, 0.015, 0.035, 0.07}, 1, 14);
        const double alpha = std::max(double(p.roughness) * p.roughness, 1e-3);
        peaks_.push_back({cast<double>(Vec3{-o.x, -o.y, o.z}), alpha});
        peaks_.push_back({cast<double>(-o), alpha});
        if (p.clearcoat > 0) {
            const Vec3 n = lengthSquared(p.clearcoatNormal) > 0 ? surface.toLocal(p.clearcoatNormal) : Vec3{0, 0, 1};
            const double coat = double(p.clearcoatRoughness) * p.clearcoatRoughness;
            if (coat >= 1e-3) peaks_.push_back({cast<double>(reflect(o, n)), coat});
        }
        if (p.ior > 0) refraction(o, p, alpha);
        std::sort(rows_.begin(), rows_.end());
        rows_.erase(std::unique(rows_.begin(), rows_.end()), rows_.end());
    }

    std::size_t cellOf(const Vec3& w) const {
        const Vec3 l = surface.toLocal(w);
        const double phi = std::remainder(std::atan2(double(l.y), double(l.x)) - phi0_, turn);
        return find(rows(), double(l.z)) * (columns().size() - 1) + find(columns(), phi);
    }

    std::vector<Integrals> cells() const {
        std::vector<Integrals> r;
        for (std::size_t row = 0; row + 1 < rows().size(); ++row)
            for (std::size_t column = 0; column + 1 < columns().size(); ++column) {
                const Box b{std::acos(rows()[row + 1]), std::acos(rows()[row]), columns()[column], columns()[column + 1]};
                r.push_back(refine(b, rule(b), 0));
            }
        return r;
    }

private:
    // Each channel's own, where colours part.
    void refraction(const Vec3& o, const BsdfParameters& p, double alpha) {
        const bool outside = o.z > 0;
        const Spectrum iors = p.dispersion > 0 ? Dispersion::iors(p.ior, p.dispersion) : Spectrum(p.ior);
        for (std::size_t i = 0; i < (p.dispersion > 0 ? 3u : 1u); ++i) {
            const double n = double(iors[i]), eta = outside ? 1 / n : n, turned = -eta * double(o.z),
                         k = 1 - eta * eta * (1 - double(o.z) * o.z);
            if (std::fabs(turned) < 1) rows_.push_back(turned);
            if (n != 1 && k > 0)
                peaks_.push_back(
                    {{-eta * o.x, -eta * o.y, outside ? -std::sqrt(k) : std::sqrt(k)}, alpha * std::min(1.0, std::fabs(eta - 1))});
        }
    }
    static constexpr double turn = 2 * std::numbers::pi;
    static std::vector<double> bothWays(std::vector<double> up, double end, int steps) {
        const double last = up.back();
        for (int i = 1; i <= steps; ++i) up.push_back(last + (end - last) * i / steps);
        std::vector<double> all;
        for (std::size_t i = up.size() - 1; i > 0; --i) all.push_back(-up[i]);
        all.insert(all.end(), up.begin(), up.end());
        return all;
    }
    static std::size_t find(const std::vector<double>& edges, double x) {
        return std::size_t(std::upper_bound(edges.begin() + 1, edges.end() - 1, x) - edges.begin()) - 1;
    }
    struct Box {
        double t0, t1, p0, p1; // theta and azimuth
    };
    Vec3d at(double theta, double phi) const {
        const double s = std::sin(theta);
        return {s * std::cos(phi + phi0_), s * std::sin(phi + phi0_), std::cos(theta)};
    }
    // Gauss-Legendre, three points each way.
    Integrals rule(const Box& b) const {
        static constexpr double x[] = {-0.7745966692414834, 0, 0.7745966692414834}, w[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
        Integrals sum;
        const double area = (b.t1 - b.t0) * (b.p1 - b.p0);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const double t = (b.t0 + b.t1 + x[i] * (b.t1 - b.t0)) / 2, phi = (b.p0 + b.p1 + x[j] * (b.p1 - b.p0)) / 2;
                const BsdfValue v = bsdf_.evaluate(surface.toWorld(cast<float>(at(t, phi))));
                const double weight = w[i] * w[j] * area * std::sin(t);
                sum += {weight * double(v.pdfW), weight * double(v.f()[1]) * std::fabs(std::cos(t))};
            }
        return sum;
    }
    // A lobe narrower than the rule's spacing would be overlooked: near the directions where lobes stand, boxes go down to their width.
    bool mayHide(const Box& b) const {
        const Vec3d middle = at((b.t0 + b.t1) / 2, (b.p0 + b.p1) / 2);
        const double radius = std::max(length(at(b.t0, b.p0) - middle), length(at(b.t1, b.p1) - middle));
        for (const Peak& p : peaks_)
            if (radius > p.width && length(p.at - middle) < radius + 2 * p.width) return true;
        return false;
    }
    Integrals refine(const Box& b, const Integrals& whole, int depth) const {
        const double t = (b.t0 + b.t1) / 2, p = (b.p0 + b.p1) / 2;
        const Box parts[] = {{b.t0, t, b.p0, p}, {t, b.t1, b.p0, p}, {b.t0, t, p, b.p1}, {t, b.t1, p, b.p1}};
        Integrals fine[4], sum;
        for (int i = 0; i < 4; ++i) sum += fine[i] = rule(parts[i]);
        const bool settled = std::fabs(sum.pdf - whole.pdf) < tolerance_ + 5e-4 * sum.pdf &&
                             std::fabs(sum.energy - whole.energy) < tolerance_ + 5e-4 * sum.energy;
        if (depth >= 12 || (settled && !mayHide(b))) return sum;
        Integrals r;
        for (int i = 0; i < 4; ++i) r += refine(parts[i], fine[i], depth + 1);
        return r;
    }

    const Bsdf& bsdf_;
    double tolerance_, phi0_ = 0;
    struct Peak {
        Vec3d at;
        double width;
    };
    std::vector<Peak> peaks_;
    std::vector<double> rows_;
};

} // namespace chiaro::test
