#include "core/render/path_classes_split.h"
#include "core/render/error.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro {
namespace {

constexpr NamedPaths pathClasses[] = {
    {"emission", "L E", "lights seen directly"},
    {"specular", "L S+ E", "lights seen in mirrors and through glass"},
    {"direct-diffuse", "L D E", "direct light on diffuse surfaces"},
    {"direct-glossy", "L G E", "direct light on glossy surfaces: highlights"},
    {"caustics", "L S+ D E", "light focused by mirrors and glass on diffuse surfaces"},
    {"glossy-caustics", "L S* G (S|G)* D E", "the same by way of a glossy surface"},
    {"colour-bleeding", "L D D+ E", "diffuse interreflection"},
    {"reflections", "L .* (D|G) S+ E", "lit surfaces seen in mirrors and through glass"},
    {"indirect-glossy", "L .+ G E", "lit surfaces seen in glossy surfaces"},
};
constexpr NamedPaths otherClasses[] = {
    {"direct", "L .? E", "emission and one scattering"},
    {"indirect", "L . .+ E", "two scatterings and more"},
};
constexpr uint32_t bounceLayers = 8; // of one depth each; deeper paths share one

[[noreturn]] void fail(std::string_view split, const std::string& what) {
    throw Error(Exit::usage, fmt::format("--split \"{}\": {}", split, what));
}

PathSplit bounces(uint32_t maxDepth) {
    PathSplit s;
    for (uint32_t depth = 0; depth < bounceLayers && depth <= maxDepth; ++depth)
        s.classes.push_back({fmt::format("bounces-{}", depth), PathExpression::parse("L .{" + std::to_string(depth) + "} E")});
    if (maxDepth >= bounceLayers) s.classes.push_back({fmt::format("bounces-{}+", bounceLayers), PathExpression::all()});
    return s;
}

std::string_view trim(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    return begin == text.npos ? std::string_view() : text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}
// At the commas that are not inside {n,m}.
std::vector<std::string_view> parts(std::string_view list) {
    std::vector<std::string_view> all;
    std::size_t begin = 0;
    bool braces = false;
    for (std::size_t i = 0; i <= list.size(); ++i) {
        if (i < list.size()) braces = list[i] == '{' || (braces && list[i] != '}');
        if (i < list.size() && (list[i] != ',' || braces)) continue;
        all.push_back(trim(list.substr(begin, i - begin)));
        begin = i + 1;
    }
    return all;
}
// A layer's name parts at dots in every viewer, and an expression knows no other character that a name must not have.
std::string nameOf(std::string_view expression) {
    std::string name;
    for (const char c : expression) name += c == '.' ? "any" : std::string(1, c);
    return name;
}

PathClass oneClass(std::string_view split, std::string_view part) {
    if (const std::size_t equals = part.find('='); equals != part.npos) {
        const std::string_view name = trim(part.substr(0, equals));
        const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '+' ||
                   c == ' ';
        });
        if (name == "other") fail(split, "other is the name of what is no light path; choose another name");
        if (name.empty() || !plain) fail(split, fmt::format("\"{}\" is no name for a layer; use letters, digits, blanks and - _ +", name));
        return {std::string(name), PathExpression::parse(trim(part.substr(equals + 1)), "--split")};
    }
    std::vector<std::string> names{"rest", "paths", "bounces"};
    for (const std::span<const NamedPaths> table : {std::span<const NamedPaths>(pathClasses), std::span<const NamedPaths>(otherClasses)})
        for (const NamedPaths& known : table) {
            if (known.name == part) return {std::string(part), PathExpression::parse(known.paths)};
            names.emplace_back(known.name);
        }
    if (part.starts_with('L') || part.starts_with('(')) return {nameOf(part), PathExpression::parse(part, "--split")};
    if (part.empty()) fail(split, "empty class; write NAME=EXPRESSION between the commas");
    if (part == "paths" || part == "bounces") fail(split, fmt::format("{} stands alone; leave the other classes out", part));
    const std::string near = nearest(std::string(part), names);
    fail(split, fmt::format("unknown class \"{}\"; {}write NAME=EXPRESSION, or one of {}", part,
                            near.empty() ? "" : fmt::format("did you mean {}? Or ", near), fmt::join(names, ", ")));
}

} // namespace

std::span<const NamedPaths> defaultPathClasses() { return pathClasses; }

PathSplit parseSplit(std::string_view split, uint32_t maxDepth) {
    if (trim(split) == "bounces") return bounces(maxDepth);
    PathSplit s;
    if (trim(split) == "paths") {
        for (const NamedPaths& c : pathClasses) s.classes.push_back({std::string(c.name), PathExpression::parse(c.paths)});
        s.classes.push_back({"rest", PathExpression::all()});
        return s;
    }
    bool rest = false;
    for (const std::string_view part : parts(split)) {
        if (rest) fail(split, "nothing is left behind rest; put rest last");
        rest = part == "rest";
        s.classes.push_back(rest ? PathClass{"rest", PathExpression::all()} : oneClass(split, part));
        for (std::size_t i = 0; i + 1 < s.classes.size(); ++i)
            if (s.classes[i].name == s.classes.back().name)
                fail(split, fmt::format("two classes named \"{}\"; give each its own name: NAME=EXPRESSION", s.classes[i].name));
        if (s.classes.size() > mostPathClasses) fail(split, "more than 31 classes; join some with |");
    }
    if (!rest) {
        if (s.classes.size() == mostPathClasses) fail(split, "31 classes and the rest are more than a film's layers; join some with |");
        for (const PathClass& c : s.classes)
            if (c.name == "rest") fail(split, "rest is the name of what no class holds; choose another name");
        s.classes.push_back({"rest", PathExpression::all()});
        s.restAdded = true;
    }
    return s;
}

} // namespace chiaro
