#include "integrators/wide/path_follow.h"

namespace chiaro {

void followPathsAvx512(const WidePaths& paths, uint32_t maxDepth, const Footprint& pixel, StartSource& source, SampleLanes& samples,
                       PathStream& stream) noexcept {
    avx512::PathFollower(paths, maxDepth, pixel, samples, stream).follow(source);
}

} // namespace chiaro
