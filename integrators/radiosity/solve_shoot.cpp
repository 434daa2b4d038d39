#include "integrators/radiosity/solve_shoot.h"
#include "core/render/fault.h"
#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace chiaro::radiosity {
namespace {

// Rows that have been made, and those that will probably be asked for next.
class RowStore {
public:
    RowStore(RowOf make, std::size_t room, const Executor& run) : make_(make), room_(room), run_(run) {}
    bool has(uint32_t i) const { return rows_.contains(i); }
    const std::vector<Factor>& operator[](uint32_t i) const { return rows_.at(i); }
    void fetch(std::span<const uint32_t> wanted) {
        if (bytes_ > room_) {
            rows_.clear();
            bytes_ = 0;
        }
        std::vector<std::vector<Factor>> made(wanted.size());
        run_.chunks(
            wanted.size(), [&](uint64_t k) { make_(wanted[k], made[k]); }, nullptr);
        for (std::size_t k = 0; k < wanted.size(); ++k) {
            bytes_ += made[k].size() * sizeof(Factor) + 64;
            most_ = std::max(most_, bytes_);
            rows_.insert_or_assign(wanted[k], std::move(made[k]));
        }
    }
    std::size_t most() const noexcept { return most_; }

private:
    RowOf make_;
    std::size_t room_, bytes_ = 0, most_ = 0;
    const Executor& run_;
    std::unordered_map<uint32_t, std::vector<Factor>> rows_;
};

class Shooting {
public:
    Shooting(const System& system, const Limits& limits, const ShootSettings& settings)
        : system_(system), settings_(settings), tail_(limits.bounces > limits.apart), levels_(limits.levels()), powers_(system.size(), 0) {
        solution.terms.assign(levels_, Lights3(system.size(), Light(0)));
        unshot_.assign(levels_, Lights3(system.size(), Light(0)));
        double area = 0;
        for (std::size_t i = 0; i < system.size(); ++i) {
            area += double(system.areas[i]);
            mean_ += widened(system.reflectance[i]) * double(system.areas[i]);
            if (levels_ == 0) continue;
            unshot_[0][i] += system.emission[i];
            receive(0, i, system.received[i]);
        }
        if (area > 0) mean_ *= 1 / area;
        area_ = area;
        for (std::size_t i = 0; i < system.size(); ++i) recount(i);
        sent_ = left();
    }
    double left() const noexcept {
        double sum = 0;
        for (const double p : powers_) sum += std::fabs(p);
        return sum;
    }
    double sent() const noexcept { return sent_; }
    uint32_t next() const noexcept { // of the most unshot power, the first of equals
        std::size_t best = 0;
        for (std::size_t i = 1; i < powers_.size(); ++i)
            if (std::fabs(powers_[i]) > std::fabs(powers_[best])) best = i;
        return uint32_t(best);
    }
    // The strongest that have no row yet, first of all the one that is next.
    std::vector<uint32_t> candidates(const RowStore& rows, uint32_t first, std::size_t count) const {
        std::vector<uint32_t> best{first};
        const auto stronger = [&](uint32_t a, uint32_t b) { return std::fabs(powers_[a]) > std::fabs(powers_[b]); };
        for (uint32_t i = 0; i < powers_.size(); ++i) {
            if (i == first || powers_[i] == 0 || (best.size() == count && !stronger(i, best.back())) || rows.has(i)) continue;
            if (best.size() == count) best.pop_back();
            best.insert(std::upper_bound(best.begin() + 1, best.end(), i, stronger), i);
        }
        return best;
    }
    void shoot(uint32_t i, std::span<const Factor> row) {
        const double area = double(system_.areas[i]);
        std::vector<Light> sends(levels_);
        for (uint32_t k = 0; k < levels_; ++k) sends[k] = std::exchange(unshot_[k][i], Light(0));
        if (settings_.overshoot && tail_) {
            const Light ahead = overshoot(i, sends);
            sends.back() += ahead;
            unshot_.back()[i] = ahead * -1.0;
        }
        for (const Factor& f : row) {
            const double share = double(f.factor) * area / double(system_.areas[f.patch]);
            for (uint32_t k = 0; k < levels_; ++k) receive(k, f.patch, sends[k] * share);
            recount(f.patch);
        }
        recount(i);
    }
    // Irradiance on all surfaces alike, if what is unshot goes round evenly.
    Light ambient() const noexcept {
        Light sum(0);
        for (const Lights3& level : unshot_)
            for (std::size_t i = 0; i < level.size(); ++i) sum += level[i] * double(system_.areas[i]);
        for (std::size_t c = 0; c < 3; ++c) sum[c] /= area_ * std::max(1 - mean_[c], 1e-3);
        return sum;
    }
    void finish() {
        if (settings_.ambient && tail_) {
            const Light everywhere = ambient();
            for (Light& h : solution.terms.back()) h += everywhere;
        }
        solution.unshot.assign(system_.size(), Light(0));
        for (const Lights3& level : unshot_)
            for (std::size_t i = 0; i < level.size(); ++i) solution.unshot[i] += level[i];
    }

    Solution solution;

private:
    // Light that has been scattered k times arrives; what is reflected has been so once more.
    void receive(uint32_t k, std::size_t i, const Light& h) noexcept {
        solution.terms[k][i] += h;
        const uint32_t on = k + 1 < levels_ ? k + 1 : k;
        if ((on > k || tail_) && !fault(Fault::unshotForgotten)) unshot_[on][i] += h * widened(system_.reflectance[i]);
    }
    void recount(std::size_t i) noexcept {
        double sum = 0;
        for (const Lights3& level : unshot_) sum += luminance(level[i]);
        powers_[i] = sum * double(system_.areas[i]);
    }
    // What i will still reflect of the ambient light; not more than it sends anyway, so that the steps still converge.
    Light overshoot(uint32_t i, std::span<const Light> sends) const noexcept {
        const Light all = ambient(), rho = widened(system_.reflectance[i]);
        Light ahead(0), own(0);
        for (const Light& s : sends) own += s;
        for (std::size_t c = 0; c < 3; ++c) ahead[c] = std::clamp(all[c] * rho[c], 0.0, std::max(0.8 * own[c], 0.0));
        return ahead;
    }

    const System& system_;
    const ShootSettings& settings_;
    bool tail_;
    uint32_t levels_;
    std::vector<Lights3> unshot_; // by scatterings, as the terms
    std::vector<double> powers_;
    Light mean_{0}; // reflectance, by area
    double area_ = 0, sent_ = 0;
};

} // namespace

Solution solveShooting(const System& system, RowOf makeRow, const Limits& limits, const ShootSettings& settings, const Run& run) {
    constexpr std::size_t ahead = 16;
    Limits exact = limits; // so many bounces and no more are told one by one
    if (limits.bounces != Limits::converged) exact.apart = limits.bounces;
    Shooting state(system, exact, settings);
    RowStore rows(makeRow, settings.roomForRows, run.run);
    double left = state.left();
    for (uint32_t step = 0; settings.steps == 0 || step < settings.steps; ++step) {
        if (!(left > limits.tolerance * state.sent())) break;
        if (run.stop.requested()) return std::move(state.solution);
        const uint32_t i = state.next();
        // A step that is the last needs no others.
        if (!rows.has(i))
            rows.fetch(state.candidates(rows, i, settings.steps == 0 ? ahead : std::min<std::size_t>(ahead, settings.steps - step)));
        state.shoot(i, rows[i]);
        if (settings.order) settings.order->push_back(i);
        left = state.left();
        state.solution.residuals.push_back(left / state.sent());
    }
    state.finish();
    Solution& s = state.solution;
    while (s.terms.size() > limits.levels()) { // as asked for
        const Lights3 last = std::move(s.terms.back());
        s.terms.pop_back();
        for (std::size_t i = 0; i < last.size(); ++i) s.terms.back()[i] += last[i];
    }
    s.bytes = rows.most() + system.size() * sizeof(Light) * (2 * exact.levels() + 2);
    s.complete = true;
    return std::move(s);
}

} // namespace chiaro::radiosity
