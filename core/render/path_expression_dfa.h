// What several path expressions say about one path, decided letter by letter: the subset construction (Rabin and Scott 1959) over all of
// them at once, and the questions that it answers, such as which light paths one expression holds and another does not.
#pragma once
#include "core/render/path_expression.h"
#include <array>
#include <optional>
#include <span>

namespace chiaro {

struct PathDfa {
    // State 0: no expression reads on.
    std::vector<std::array<uint32_t, eventCount>> next;
    std::array<uint32_t, lightKindCount> start{};
    std::vector<uint64_t> accepts; // bit i: expression i takes the path that ends here
};
// At most 64 expressions. Error(Exit::usage) where they need more than 20,000 states.
PathDfa determinise(std::span<const PathExpression>);

// What a scene and a render can hold at all: kinds of light and events that occur, scatterings.
struct PathsPresent {
    LetterSet letters = anyLight | anyEvent;
    uint32_t maxDepth = 0xffffffff;
};
// The shortest path, such as "Ld S D E", that is wanted and not covered; none: all wanted paths are covered. wanted "": all paths;
// covered "": none. A letter stands without R or T where either side that is present would do.
std::optional<std::string> firstMissing(std::string_view wanted, std::string_view covered, const PathsPresent& = {});
// The shortest path that is in both, such as wanted paths that an integrator misses. a "": all paths; b "": none.
std::optional<std::string> firstCommon(std::string_view a, std::string_view b, const PathsPresent& = {});
// The same, and not in the third; without "": none is.
std::optional<std::string> firstCommon(std::string_view a, std::string_view b, std::string_view without, const PathsPresent& = {});

} // namespace chiaro
