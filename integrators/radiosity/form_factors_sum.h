// Sums for the patches that a row reaches: dense, one array a thread, emptied by what was touched.
#pragma once
#include "integrators/radiosity/form_factors.h"
#include <algorithm>

namespace chiaro::radiosity {

template <class T> class RowSum {
public:
    // This thread's, for rows over so many patches. Empty between rows.
    static RowSum& ofThread(std::size_t patches) {
        thread_local RowSum sums;
        if (sums.sum_.size() < patches) sums.sum_.resize(patches, T(0));
        return sums;
    }
    void add(uint32_t patch, T x) noexcept {
        T& s = sum_[patch];
        if (s == T(0)) touched_.push_back(patch);
        s += x;
    }
    // Into the row, ascending, times scale; then empty.
    void drain(double scale, std::vector<Factor>& row) {
        std::sort(touched_.begin(), touched_.end());
        for (const uint32_t p : touched_) {
            row.push_back({p, float(double(sum_[p]) * scale)});
            sum_[p] = T(0);
        }
        touched_.clear();
    }

private:
    std::vector<T> sum_;
    std::vector<uint32_t> touched_;
};

} // namespace chiaro::radiosity
