#include "tests/core/wide_lookup_run.h"

namespace chiaro::test {

void skyAvx2(const Sky& sky, LookupLanes& lanes) { avx2::runSky(sky, lanes); }
void treeAvx2(const LightTreeView& tree, uint32_t lanes, TreeLanes& asked) { avx2::runTree(tree, lanes, asked); }
void textureAvx2(const WideTexture& texture, bool footprint, uint32_t lanes, LookupLanes& asked) {
    avx2::runTexture(texture, footprint, lanes, asked);
}

} // namespace chiaro::test
