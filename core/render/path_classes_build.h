// From a deterministic automaton that reads paths from the light on to the tables that PathClasses looks up: the smallest automaton in
// either direction, the layer of every pair of their states, and the depth limit.
#pragma once
#include "core/render/path_classes.h"
#include "core/render/path_expression_dfa.h"

namespace chiaro {

// layers: of each state of the automaton, for the path that ends there. Error(Exit::usage) where 16 bits do not hold the states.
PathTables buildPathTables(const PathDfa&, const std::vector<Layer>& layers, uint32_t maxDepth);

} // namespace chiaro
