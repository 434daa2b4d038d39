// chiaro render --pixel x,y --sample n: exactly that sample again, its value on stdout. No file is touched.
#pragma once
#include "tools/cli/settings.h"

namespace chiaro::cli {

int replaySample(const RenderSettings&, const LoadedScene&, const View&, const Executor&, Diagnostics&, Console&);

} // namespace chiaro::cli
