#include "integrators/radiosity/solve_matrix.h"
#include "core/render/error.h"
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::radiosity {
namespace {

constexpr uint64_t rowsPerChunk = 64;

// sum_j F_ij B_j
Light received(const FormFactorMatrix& m, std::size_t i, std::span<const Light> radiosity) noexcept {
    Light sum(0);
    for (const Factor& e : m.exchange(uint32_t(i))) sum += radiosity[e.patch] * double(e.factor);
    return sum * (1 / double(m.areas[i]));
}

// The bounces that are told apart, and what is left to be sent after them: nothing where the limits end there.
struct Start {
    Solution solution;
    Lights3 left;
};
Start begin(const System& system, const FormFactorMatrix& m, const Limits& limits, const Run& run) {
    Limits apart = limits;
    apart.bounces = std::min(limits.bounces, limits.apart);
    apart.tolerance = 0;
    const auto bounce = [&](std::span<const Light> from, std::span<Light> to) { gather(run.run, m, from, to); };
    Start s{neumann(system, bounce, apart, run), {}};
    if (!s.solution.complete || limits.bounces <= limits.apart) return s;
    s.left.resize(system.size());
    const Lights3& last = limits.apart == 0 ? system.emission : s.solution.terms.back();
    for (std::size_t i = 0; i < system.size(); ++i)
        s.left[i] =
            limits.apart == 0 ? last[i] + widened(system.reflectance[i]) * system.received[i] : widened(system.reflectance[i]) * last[i];
    s.solution.terms.resize(limits.levels());
    s.solution.terms.back().assign(system.size(), Light(0));
    return s;
}
double largest(const Light& v) noexcept { return std::max({std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])}); }

// One channel of the symmetric problem.
class Cholesky {
public:
    Cholesky(const System& system, const FormFactorMatrix& m, std::size_t channel) : system_(system), m_(m), channel_(channel) {
        const auto n = Eigen::Index(system.size());
        root_.resize(n);
        scale_.resize(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const double rho = double(system.reflectance[std::size_t(i)][channel]), area = double(system.areas[std::size_t(i)]);
            root_[i] = std::sqrt(rho * area);
            scale_[i] = std::sqrt(rho / area);
        }
        factor_ = Eigen::MatrixXf::Identity(n, n);
        for (Eigen::Index i = 0; i < n; ++i)
            for (const Factor& e : m.exchange(uint32_t(i)))
                if (Eigen::Index(e.patch) <= i) factor_(i, e.patch) -= float(scale_[i] * double(e.factor) * scale_[e.patch]);
        llt_.emplace(factor_);
        if (llt_->info() != Eigen::Success)
            throw Error(Exit::failed, "radiosity: the form factors give more light than they take; raise rays= for better ones");
    }
    // v of M v = sqrt(A rho) h0; the residual, relative.
    double solve(const Eigen::VectorXd& h0, Eigen::VectorXd& v) const {
        const Eigen::VectorXd right = root_.cwiseProduct(h0);
        v = Eigen::VectorXd::Zero(right.size());
        Eigen::VectorXd residual = right;
        const double norm = right.norm();
        for (int i = 0; i < 40 && residual.norm() > 1e-13 * norm; ++i) {
            const Eigen::VectorXf step = llt_->solve((residual / residual.norm()).cast<float>());
            v += step.cast<double>() * residual.norm();
            residual = right - product(v);
        }
        return norm > 0 ? residual.norm() / norm : 0;
    }
    double radiosity(const Eigen::VectorXd& v, Eigen::Index i) const noexcept { return scale_[i] * v[i]; } // rho H

private:
    Eigen::VectorXd product(const Eigen::VectorXd& v) const {
        Eigen::VectorXd out(v.size());
        for (Eigen::Index i = 0; i < v.size(); ++i) {
            double sum = 0;
            for (const Factor& e : m_.exchange(uint32_t(i))) sum += double(e.factor) * scale_[e.patch] * v[e.patch];
            out[i] = v[i] - scale_[i] * sum;
        }
        return out;
    }
    const System& system_;
    const FormFactorMatrix& m_;
    std::size_t channel_;
    Eigen::VectorXd root_, scale_;
    Eigen::MatrixXf factor_;
    std::optional<Eigen::LLT<Eigen::Ref<Eigen::MatrixXf>>> llt_;
};

bool sameChannel(const System& s, std::size_t a, std::size_t b) {
    return std::all_of(s.reflectance.begin(), s.reflectance.end(), [&](const Spectrum& r) { return r[a] == r[b]; });
}

} // namespace

void gather(const Executor& run, const FormFactorMatrix& m, std::span<const Light> radiosity, std::span<Light> irradiance) {
    const uint64_t n = irradiance.size();
    run.chunks((n + rowsPerChunk - 1) / rowsPerChunk,
               [&](uint64_t chunk) {
                   for (uint64_t i = chunk * rowsPerChunk; i < std::min(n, (chunk + 1) * rowsPerChunk); ++i)
                       irradiance[i] = received(m, i, radiosity);
               },
               nullptr);
}

Solution solveJacobi(const System& system, const FormFactorMatrix& m, const Limits& limits, const Run& run) {
    const auto bounce = [&](std::span<const Light> from, std::span<Light> to) { gather(run.run, m, from, to); };
    Solution s = neumann(system, bounce, limits, run);
    s.bytes = m.bytes() + system.size() * sizeof(Light) * (limits.levels() + 4);
    return s;
}

// The tail H = F (S + rho H), S what is left to be sent, in place.
Solution solveGaussSeidel(const System& system, const FormFactorMatrix& m, const Limits& limits, const Run& run) {
    if (limits.bounces != Limits::converged) return solveJacobi(system, m, limits, run); // so many bounces are so many products
    Start start = begin(system, m, limits, run);
    Solution& s = start.solution;
    if (!s.complete || start.left.empty()) return std::move(s);
    s.complete = false;
    Lights3 b = start.left;
    Lights3& h = s.terms.back();
    const double sent = power(system.emission, system.areas) + power(b, system.areas);
    s.residuals = {1};
    while (s.residuals.back() > limits.tolerance) {
        if (run.stop.requested()) return std::move(s);
        double change = 0;
        for (std::size_t i = 0; i < system.size(); ++i) {
            const Light next = received(m, i, b), rho = widened(system.reflectance[i]);
            change += luminance(rho * Light(std::fabs(next[0] - h[i][0]), std::fabs(next[1] - h[i][1]), std::fabs(next[2] - h[i][2]))) *
                      double(system.areas[i]);
            h[i] = next;
            b[i] = start.left[i] + rho * next;
        }
        s.residuals.push_back(sent > 0 ? change / sent : 0);
        if (s.residuals.size() > 100000 || s.residuals.back() > 1e6)
            throw Error(Exit::failed, "radiosity: the light grows from sweep to sweep; raise rays= for better form factors");
    }
    s.residuals.erase(s.residuals.begin());
    s.bytes = m.bytes() + system.size() * sizeof(Light) * (limits.levels() + 4);
    s.complete = true;
    return std::move(s);
}

Solution solveDirect(const System& system, const FormFactorMatrix& m, const Limits& limits, const Run& run) {
    if (limits.bounces != Limits::converged) return solveJacobi(system, m, limits, run);
    const std::size_t n = system.size();
    // Channels that reflect alike share a factor.
    std::size_t of[3] = {0, 1, 2};
    if (sameChannel(system, 1, 0)) of[1] = 0;
    if (sameChannel(system, 2, 0)) of[2] = 0;
    if (of[2] == 2 && sameChannel(system, 2, 1)) of[2] = of[1];
    const std::size_t distinct = 1 + (of[1] == 1) + (of[2] == 2), need = n * n * sizeof(float);
    const bool together = distinct > 1 && run.run.threads() > 1 && need * distinct + m.bytes() <= run.memoryLimit;
    const std::size_t bytes = m.bytes() + need * (together ? distinct : 1);
    if (bytes > run.memoryLimit)
        throw Error(Exit::resources, fmt::format("radiosity: factorising {} x {} form factors needs {:.1f} GB, limit {:.1f} GB. Use "
                                                 "solver=gauss-seidel, solver=hierarchical, or fewer patches.",
                                                 n, n, double(bytes) / 1e9, double(run.memoryLimit) / 1e9));
    Start start = begin(system, m, limits, run);
    Solution& s = start.solution;
    if (!s.complete || start.left.empty()) return std::move(s);
    Lights3 h0(n), b = start.left;
    gather(run.run, m, start.left, h0);
    double residual[3] = {};
    const auto one = [&](uint64_t c) {
        if (of[c] != c) return;
        const Cholesky factor(system, m, c);
        for (std::size_t channel = c; channel < 3; ++channel) {
            if (of[channel] != c) continue;
            Eigen::VectorXd right(Eigen::Index{0} + Eigen::Index(n)), v;
            for (std::size_t i = 0; i < n; ++i) right[Eigen::Index(i)] = h0[i][channel];
            residual[channel] = factor.solve(right, v);
            for (std::size_t i = 0; i < n; ++i) b[i][channel] += factor.radiosity(v, Eigen::Index(i));
        }
    };
    if (together)
        run.run.chunks(3, one, nullptr);
    else
        for (uint64_t c = 0; c < 3; ++c) one(c);
    gather(run.run, m, b, s.terms.back());
    s.residuals = {largest(Light(residual[0], residual[1], residual[2]))};
    s.bytes = bytes;
    return std::move(s);
}

} // namespace chiaro::radiosity
