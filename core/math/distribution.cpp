#include "core/math/distribution.h"
#include <numeric>

namespace chiaro {
namespace {

// The test number is a multiple of 2^-24 (Sampler::get1D), and so is every keep: the table's probabilities are exact, and the pmf is read
// off the table as it is. A rounded keep with an unrounded pmf would give a rare choice far more than its share.
constexpr double steps = 0x1p24;
double quantised(double keep, bool possible) noexcept { return possible ? std::clamp(std::round(keep * steps), 1.0, steps) / steps : 0; }

} // namespace

AliasTable::AliasTable(std::span<const double> weights) {
    sum_ = std::accumulate(weights.begin(), weights.end(), 0.0);
    if (!(sum_ > 0) || !std::isfinite(sum_)) {
        sum_ = 0;
        return;
    }
    const std::size_t n = weights.size();
    cells_.resize(n);
    std::vector<double> scaled(n);
    std::vector<uint32_t> small, large;
    for (uint32_t i = 0; i < n; ++i) {
        scaled[i] = weights[i] / sum_ * double(n);
        (scaled[i] < 1 ? small : large).push_back(i);
    }
    while (!small.empty() && !large.empty()) {
        const uint32_t s = small.back(), l = large.back();
        small.pop_back();
        cells_[s].keep = float(quantised(scaled[s], weights[s] > 0));
        cells_[s].alias = l;
        scaled[l] -= 1 - scaled[s];
        if (scaled[l] < 1) {
            large.pop_back();
            small.push_back(l);
        }
    }
    // What is left on either stack is 1 up to rounding; a weight of exactly zero must still never be chosen.
    const uint32_t heaviest = uint32_t(std::max_element(weights.begin(), weights.end()) - weights.begin());
    for (const auto* rest : {&small, &large})
        for (const uint32_t i : *rest) {
            cells_[i].keep = weights[i] > 0 ? 1.f : 0.f;
            cells_[i].alias = weights[i] > 0 ? i : heaviest;
        }
    std::vector<double> share(n);
    for (uint32_t i = 0; i < n; ++i) {
        share[i] += double(cells_[i].keep);
        share[cells_[i].alias] += 1 - double(cells_[i].keep);
    }
    for (uint32_t i = 0; i < n; ++i) cells_[i].pmf = float(share[i] / double(n));
}

Choice AliasTable::choose(double uCell, float uTest) const noexcept {
    const auto i = std::min(uint32_t(uCell * double(cells_.size())), uint32_t(cells_.size() - 1));
    const Cell& cell = cells_[i];
    if (uTest < cell.keep) return {i, cell.pmf, std::min(uTest / cell.keep, oneMinusEpsilon)};
    return {cell.alias, cells_[cell.alias].pmf, std::min((uTest - cell.keep) / (1 - cell.keep), oneMinusEpsilon)};
}

} // namespace chiaro
