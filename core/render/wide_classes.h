// WideClasses: the automaton of PathClasses as loops over lanes read it: all that a path asks of its state in 16 bytes, so that one load a
// path answers. Made once before a render, read by all threads. States are those of PathClasses.
#pragma once
#include "core/render/path_classes.h"

namespace chiaro {

struct alignas(16) WideClass {
    uint16_t next[eventCount]; // as Event has them: by halves of the words diffuse, glossy, specular; reflected first
    // The layers of lights that are reached here, a byte for each kind, and the bits below.
    uint32_t reached;
    static constexpr uint32_t continues = 1u << 24, sorts = 1u << 25;
    static constexpr uint32_t connects = 1u << 26; // a light may be wanted that a lobe which is not specular sees from the next vertex
};
static_assert(sizeof(WideClass) == 16);

class WideClasses {
public:
    explicit WideClasses(const PathClasses&);
    // Do the classes ask for nothing but a depth, in one layer? Then a path needs no state.
    bool onlyDepth() const noexcept { return onlyDepth_; }
    bool sorts() const noexcept { return sorts_; } // in any state
    const WideClass* rows() const noexcept { return rows_.data(); }

private:
    std::vector<WideClass> rows_;
    bool onlyDepth_, sorts_ = false;
};

} // namespace chiaro
