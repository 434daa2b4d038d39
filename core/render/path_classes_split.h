// The classes that a picture is split into: --split. Each set parts all paths, so that its layers sum to the picture.
#pragma once
#include "core/render/path_expression.h"
#include <span>
#include <string>

namespace chiaro {

struct NamedPaths {
    std::string_view name, paths, meaning;
};
// The classes of --split paths, disjoint; what none of them holds is "rest": mixed interreflection that ends on a diffuse surface.
std::span<const NamedPaths> defaultPathClasses();

struct PathClass {
    std::string name;
    PathExpression paths;
};
struct PathSplit {
    std::vector<PathClass> classes; // the first that holds a path takes it; together they hold all paths
    bool restAdded = false;         // the last one was not asked for, and may go when it is empty
};
inline constexpr std::size_t mostPathClasses = 31; // a film has 32 layers, the first for what is no light path
PathSplit parseSplit(std::string_view split, uint32_t maxDepth);

} // namespace chiaro
