#include "integrators/wide/path_follow.h"

namespace chiaro {

void followPathsAvx2(const WidePaths& paths, const PathClasses& classes, const Footprint& pixel, StartSource& source, SampleLanes& samples,
                     PathStream& stream) noexcept {
    avx2::PathFollower(paths, classes, pixel, samples, stream).follow(source);
}

} // namespace chiaro
