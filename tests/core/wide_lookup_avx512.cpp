#include "tests/core/wide_lookup_run.h"

namespace chiaro::test {

void skyAvx512(const Sky& sky, LookupLanes& lanes) { avx512::runSky(sky, lanes); }
void treeAvx512(const LightTreeView& tree, uint32_t lanes, TreeLanes& asked) { avx512::runTree(tree, lanes, asked); }
void textureAvx512(const WideTexture& texture, bool footprint, uint32_t lanes, LookupLanes& asked) {
    avx512::runTexture(texture, footprint, lanes, asked);
}

} // namespace chiaro::test
