// PathExpression: a set of light paths in Heckbert's notation (Adaptive Radiosity Textures for Bidirectional Ray Tracing, 1990), written
// from the light to the eye, as the automaton that reads it. White space means nothing.
//   L any light, La area, Ld delta (point, spot, directional), Le environment    E the eye
//   D diffuse, G glossy, S specular, . any event; with R or T behind it: reflected or transmitted only
//   x? none or one   x* any number   x+ one or more   x{n} n   x{n,m} n to m   x{n,} n or more   x|y either   (x) together
// Every alternative begins with a light and ends with E. Errors: Error(Exit::usage) with the place, counted from 1, and the fix.
#pragma once
#include "core/render/events.h"
#include <string>
#include <string_view>
#include <vector>

namespace chiaro {

// Letters as bits: the kinds of light, then the events, then the eye.
using LetterSet = uint16_t;
constexpr LetterSet letter(LightKind k) noexcept { return LetterSet(1u << int(k)); }
constexpr LetterSet letter(Event e) noexcept { return LetterSet(1u << (lightKindCount + int(e))); }
inline constexpr LetterSet anyLight = (1u << lightKindCount) - 1;
inline constexpr LetterSet anyEvent = ((1u << eventCount) - 1) << lightKindCount;
inline constexpr LetterSet eyeLetter = 1u << (lightKindCount + eventCount);

class PathExpression {
public:
    // option: what the user typed it behind, for the message.
    static PathExpression parse(std::string_view text, std::string_view option = "--paths");
    static PathExpression all() { return parse("L .* E"); }

    // Thompson's construction (1968). A node reads one of its letters and goes on at to[0]; one without letters goes on at both, freely.
    // Whoever reads the eye has read a whole path.
    struct Node {
        LetterSet letters = 0;
        int to[2] = {-1, -1};
    };
    const std::vector<Node>& nodes() const noexcept { return nodes_; }
    int start() const noexcept { return start_; }

private:
    std::vector<Node> nodes_;
    int start_ = -1;
};

} // namespace chiaro
