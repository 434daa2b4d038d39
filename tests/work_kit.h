// All that a pre-pass may use, without a view: for tests that solve, trace photons or cut patches.
#pragma once
#include "tests/scene_kit.h"

namespace chiaro::test {

struct Bare {
    explicit Bare(const Scene& s, unsigned threads = 1, uint64_t seed = 0, std::size_t memory = ~std::size_t(0),
                  SamplerKind sampler = SamplerKind::sobol, const PathQuery& query = {})
        : scene(s), classes(PathClasses::make(query)), run(threads),
          work{scene, classes, scene.shutter(), seed, sampler, run, stop, progress, notes, memory} {}
    Bare(const Bare&) = delete;
    const Scene& scene;
    PathClasses classes;
    Executor run;
    StopToken stop;
    Progress progress;
    Diagnostics notes;
    Work work;
};

} // namespace chiaro::test
