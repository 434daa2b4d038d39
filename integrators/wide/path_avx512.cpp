#include "integrators/wide/path_follow.h"

namespace chiaro {

void followPathsAvx512(const WidePaths& paths, uint32_t maxDepth, StartSource& source, SampleLanes& samples, PathStream& stream) noexcept {
    avx512::PathFollower(paths, maxDepth, samples, stream).follow(source);
}

} // namespace chiaro
