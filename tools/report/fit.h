// A report of a bounded size. Pictures are stored as halves with a common power of two (so that neither lamps overflow nor dark scenes lose
// digits); where they do not fit, what costs least is given up first, in this order: layers, the deepest first, in all entries alike; maps
// become half as wide and high (means of 2 x 2); mantissa bits (10 to 7; maps 8 to 5 bits); maps of means of 4 x 4, and two bits more (5
// bits are 1.6 %, below the steps of a screen, and far below noise that needs so much room); then all pictures become half as wide and
// high, with everything else again. Pictures of more than four million pixels are reduced in any case. Whatever was given up is said in a
// sentence.
#pragma once
#include "tools/report/pack.h"
#include "tools/report/report.h"

namespace chiaro::report {

struct Block {
    uint32_t width = 0, height = 0; // as stored
    Packed packed;
};
struct Fitted {
    int exponent = 0;                   // value = half x 2^exponent
    uint32_t factor = 1, mapFactor = 1; // a stored pixel is the mean of so many of the full picture, squared
    int mantissa = 10, mapSteps = 127;
    std::size_t layers = 0; // kept, of each entry
    // By entry: the picture, its kept layers, its maps. No block for a picture of no pixels.
    struct Entry {
        std::vector<Block> pictures, maps;
    };
    std::vector<Entry> entries;
    std::vector<std::string> reductions;
};

// budget: characters that the blocks may take. Throws Error(Exit::internal) where a picture's values do not match its size.
Fitted fit(const Report&, std::uintmax_t budget);

} // namespace chiaro::report
