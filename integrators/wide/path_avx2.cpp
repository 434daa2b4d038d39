#include "integrators/wide/path_follow.h"

namespace chiaro {

void followPathsAvx2(const WidePaths& paths, uint32_t maxDepth, const Footprint& pixel, StartSource& source, SampleLanes& samples,
                     PathStream& stream) noexcept {
    avx2::PathFollower(paths, maxDepth, pixel, samples, stream).follow(source);
}

} // namespace chiaro
