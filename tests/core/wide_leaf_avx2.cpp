#include "tests/core/wide_leaf_run.h"

namespace chiaro::test {

void leafAvx2(LeafLanes& lanes) { avx2::runLeaf(lanes); }

} // namespace chiaro::test
