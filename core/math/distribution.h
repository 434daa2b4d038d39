// Discrete distributions. AliasTable chooses in constant time (Walker 1974, built by Vose's method, 1991). The cell and the test inside it
// take two different random numbers: one float for both is biased once the table has more cells than the float has spare bits.
#pragma once
#include "core/math/vec.h"
#include <span>
#include <vector>

namespace chiaro {

struct Choice {
    uint32_t index = 0;
    float pmf = 0;
    float u = 0; // what is left of the number that made the alias test: uniform in [0, 1) again
};

class AliasTable {
public:
    AliasTable() = default;
    explicit AliasTable(std::span<const double> weights); // non-negative, finite; all zero: nothing can be chosen
    bool empty() const noexcept { return cells_.empty(); }
    std::size_t size() const noexcept { return cells_.size(); }
    double sum() const noexcept { return sum_; }
    // uCell picks the cell with 32 bits of a double, uTest decides between the cell and its alias.
    Choice choose(double uCell, float uTest) const noexcept;
    float pmf(uint32_t index) const noexcept { return cells_[index].pmf; }
    // A cell as it is, for choices made in lanes: the probability of staying, and where to else.
    float keep(uint32_t cell) const noexcept { return cells_[cell].keep; }
    uint32_t alias(uint32_t cell) const noexcept { return cells_[cell].alias; }

private:
    struct Cell {
        float keep = 1; // probability of staying
        uint32_t alias = 0;
        float pmf = 0;
    };
    std::vector<Cell> cells_;
    double sum_ = 0;
};

} // namespace chiaro
