#include "tests/core/wide_leaf_run.h"

namespace chiaro::test {

void leafAvx512(LeafLanes& lanes) { avx512::runLeaf(lanes); }

} // namespace chiaro::test
