// The leaf code of sixteen lanes, for tests: one function for each instruction set, made from one template (wide_leaf_run.h).
#pragma once
#include <cstdint>

namespace chiaro::test {

struct alignas(64) LeafLanes {
    static constexpr uint32_t size = 16;
    // Asked.
    float x[size], y[size];                                          // [0, 1)
    uint32_t bits[size], lanes;                                      // any; a mask
    uint32_t keyLow[size], keyHigh[size], sample[size], depth[size]; // of a sampler; of the vertex that draws
    // Answered.
    uint32_t pick[size], reversed[size], high[size]; // high: the upper half of bits times 12345
    float u[size], v[size], one[size];               // drawn with pick; drawn alone
    float inverseRoot[size];                         // of y
    float hx[size], hy[size], hz[size];              // the hemisphere at (x, y)
    float packed[3 * size];                          // x, the lanes of the mask side by side
    alignas(16) float sums[size][4];                 // (x, y, x y) of the lanes of the mask, added to sums 15 - lane
};
using LeafProgram = void(LeafLanes&);
LeafProgram leafAvx2, leafAvx512;

} // namespace chiaro::test
