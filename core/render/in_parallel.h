// inParallel: independent pieces of work of which each may fail, such as the pictures of a scene that is read. What fails is told as if
// they had been done one after the other: the exception of the lowest number leaves, whichever thread met one first.
#pragma once
#include "core/render/executor.h"

namespace chiaro {

// fn(i) for every i < count; without an executor in this thread, in order, until one throws.
void inParallel(const Executor*, uint64_t count, FunctionRef<void(uint64_t)> fn);

} // namespace chiaro
