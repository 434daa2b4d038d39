// What this process holds, as the kernel counts it (/proc/self): resident bytes, zero where unknown.
#pragma once
#include <cstddef>

namespace chiaro::bench {

std::size_t residentBytes();
// The most since resetPeak(), or since the program began.
std::size_t peakBytes();
// False: this kernel cannot; peakBytes() goes on counting from the beginning.
bool resetPeak();
// The most of all, whatever was reset.
std::size_t peakOfAll();

} // namespace chiaro::bench
