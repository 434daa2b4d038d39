// Pairwise summation: the rounding error of a sum of n terms grows with log n instead of n, in an order that is always the same
// (Higham, The Accuracy of Floating Point Summation, SIAM J. Sci. Comput. 14, 1993).
#pragma once
#include <cstddef>

namespace chiaro::judge {

// The sum of term(begin), ..., term(end - 1).
template <class Term> double pairwiseSum(std::size_t begin, std::size_t end, const Term& term) noexcept {
    constexpr std::size_t block = 64;
    if (end - begin > block) {
        const std::size_t middle = begin + (end - begin) / 2;
        return pairwiseSum(begin, middle, term) + pairwiseSum(middle, end, term);
    }
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += term(i);
    return sum;
}

template <class Term> double pairwiseMean(std::size_t count, const Term& term) noexcept {
    return pairwiseSum(0, count, term) / double(count); // NaN without terms
}

} // namespace chiaro::judge
