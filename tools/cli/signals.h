// Ctrl-C and SIGTERM: the first asks the render to stop and keep what there is, the second ends the program at once (exit 130).
#pragma once
#include "core/render/executor.h"

namespace chiaro::cli {

class StopOnSignal {
public:
    explicit StopOnSignal(StopToken&);
    ~StopOnSignal(); // the system's own behaviour again
    StopOnSignal(const StopOnSignal&) = delete;
    StopOnSignal& operator=(const StopOnSignal&) = delete;
};

} // namespace chiaro::cli
