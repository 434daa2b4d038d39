#include "io/file_bytes.h"
#include "tools/cli/info_scene.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string text(const Json& j) { return printable(j.get<std::string>()); }

// Characters, not bytes: names are UTF-8.
std::size_t widthOf(const std::string& s) {
    return std::size_t(std::count_if(s.begin(), s.end(), [](unsigned char c) { return (c & 0xc0) != 0x80; }));
}
std::string padded(const std::string& s, std::size_t width) { return s + std::string(width - std::min(width, widthOf(s)), ' '); }

// A name in quotes, its middle left out where it is very long.
std::string quoted(const Json& name) {
    const std::string s = text(name);
    constexpr std::size_t most = 40;
    if (widthOf(s) <= most || s.size() != widthOf(s)) return fmt::format("\"{}\"", s);
    return fmt::format("\"{}...{}\"", s.substr(0, most / 2), s.substr(s.size() - most / 2 + 3));
}

// The first few of a list, in columns, then how many more there are (--json has all).
template <class Cells> void printTable(const char* label, const Json& list, Cells&& cells) {
    constexpr std::size_t shown = 40;
    fmt::print("{:<12} {}\n", label, list.size());
    std::vector<std::vector<std::string>> rows;
    std::vector<std::size_t> widths;
    for (std::size_t i = 0; i < std::min(shown, list.size()); ++i) {
        rows.push_back(cells(list[i], i));
        widths.resize(std::max(widths.size(), rows.back().size()));
        for (std::size_t c = 0; c < rows.back().size(); ++c) widths[c] = std::max(widths[c], widthOf(rows.back()[c]));
    }
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t c = 0; c < row.size(); ++c) line += padded(row[c], widths[c]) + "  ";
        fmt::print("{:<12}   {}\n", "", line.substr(0, line.find_last_not_of(' ') + 1));
    }
    if (list.size() > shown) fmt::print("{:<12}   ... and {} more (--json lists them)\n", "", list.size() - shown);
}

void printBounds(const Json& bounds) {
    const auto at = [&](int end, int axis) { return bounds[std::size_t(end)][std::size_t(axis)].get<double>(); };
    fmt::print("{:<12} {:.4g} x {:.4g} x {:.4g} m, from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})\n", "bounds",
               at(1, 0) - at(0, 0), at(1, 1) - at(0, 1), at(1, 2) - at(0, 2), at(0, 0), at(0, 1), at(0, 2), at(1, 0), at(1, 1), at(1, 2));
}

void printFile(const Json& file) {
    fmt::print("{:<12} {}, glTF {}{}{}\n", "file", memorySize(file["bytes"].get<double>()), text(file["version"]),
               text(file["generator"]).empty() ? "" : fmt::format(", written by {}", text(file["generator"])),
               text(file["copyright"]).empty() ? "" : fmt::format(", {}", text(file["copyright"])));
    if (file["scenes"].size() > 1)
        printTable("scenes", file["scenes"], [&](const Json& s, std::size_t n) {
            return std::vector{fmt::format("{}", n), quoted(s), std::string(n == file["scene"].get<std::size_t>() ? "shown" : "")};
        });
    if (!file["extensions"].empty())
        printTable("extensions", file["extensions"], [](const Json& e, std::size_t) {
            const auto places = e["places"].get<std::size_t>();
            return std::vector{text(e["name"]), text(e["use"]), e["required"].get<bool>() ? std::string("required") : std::string(),
                               places == 0 ? "announced only" : fmt::format("{} place{}", places, places == 1 ? "" : "s")};
        });
    if (!file["skins"].empty())
        printTable("skins", file["skins"], [](const Json& s, std::size_t n) {
            return std::vector{fmt::format("{}", n), quoted(s["name"]), fmt::format("{} joints", s["joints"].get<std::size_t>())};
        });
    if (const auto targets = file["morphTargets"].get<std::size_t>()) fmt::print("{:<12} {}\n", "morph targets", targets);
}

void printCameras(const Json& i) {
    printTable("cameras", i["cameras"], [](const Json& c, std::size_t n) {
        return std::vector{fmt::format("{}", n), quoted(c["name"]), text(c["projection"]),
                           c.contains("yfov") ? fmt::format("vertical angle {:.4g} deg", c["yfov"].get<double>()) : std::string(),
                           c["aspect"].get<double>() > 0 ? fmt::format("aspect {:.4g}", c["aspect"].get<double>()) : std::string()};
    });
    if (!i["animations"].empty())
        printTable("animations", i["animations"], [](const Json& a, std::size_t n) {
            std::vector<std::string> channels;
            for (const auto& [path, count] : a["channels"].items())
                channels.push_back(fmt::format("{} {}", count.get<std::size_t>(), path));
            return std::vector{fmt::format("{}", n), quoted(a["name"]), fmt::format("{:.4g} s", a["seconds"].get<double>()),
                               fmt::format("{}", fmt::join(channels, ", ")), std::string(a["plays"].get<bool>() ? "plays" : "")};
        });
}

void printSurfaces(const Json& i) {
    printTable("lights", i["lights"], [](const Json& l, std::size_t) {
        const uint64_t triangles = l["triangles"].get<uint64_t>();
        return std::vector{text(l["kind"]), quoted(l["name"]), fmt::format("{:.4g} lm", l["lumen"].get<double>()),
                           triangles ? fmt::format("{} triangles", triangles) : std::string()};
    });
    fmt::print("{:<12} {}\n", "environment", text(i["environment"]));
    printTable("materials", i["materials"], [](const Json& m, std::size_t) {
        return std::vector{quoted(m["name"]), text(m["kind"]),
                           fmt::format("{}", fmt::join(m["lobes"].get<std::vector<std::string>>(), " + ")),
                           m["textures"].empty() ? std::string()
                                                 : fmt::format("{} texture{}", m["textures"].size(), m["textures"].size() == 1 ? "" : "s")};
    });
    printTable("textures", i["textures"]["images"], [](const Json& p, std::size_t n) {
        return std::vector{fmt::format("{}", n),
                           quoted(p["name"]),
                           fmt::format("{} x {}", p["size"][0].get<int>(), p["size"][1].get<int>()),
                           text(p["channels"]),
                           text(p["depth"]),
                           text(p["format"]),
                           memorySize(p["bytes"].get<double>())};
    });
}

void printMemory(const Json& memory, double triangles) {
    std::string parts;
    for (const auto& [part, bytes] : memory.items())
        if (part != "total" && part != "peak" && bytes.get<double>() > 0)
            parts += fmt::format(", {} {}", part, memorySize(bytes.get<double>()));
    const double total = memory["total"].get<double>(), textures = memory["textures"].get<double>();
    const std::string each = triangles > 0 ? fmt::format("; {:.0f} bytes a triangle without textures", (total - textures) / triangles) : "";
    fmt::print("{:<12} {}{}{}; {} with all of chiaro\n", "memory", memorySize(total), parts, each,
               memorySize(memory["peak"].get<double>()));
}

} // namespace

void printScene(const Json& i) {
    fmt::print("{:<12} {}   hash {}\n", "scene", text(i["scene"]), text(i["hash"]));
    if (i.contains("file")) printFile(i["file"]);
    if (i.contains("bounds")) printBounds(i["bounds"]);
    const Json& t = i["triangles"];
    fmt::print("{:<12} {} stored, {} drawn, {} emissive\n", "triangles", t["stored"].get<uint64_t>(), t["drawn"].get<uint64_t>(),
               t["emissive"].get<uint64_t>());
    fmt::print("{:<12} {}\n", "instances", i["instances"].get<uint64_t>());
    printCameras(i);
    printSurfaces(i);
    printMemory(i["memory"], t["stored"].get<double>());
    for (const char* kind : {"approximated", "ignored", "added"})
        for (const Json& line : i[kind]) fmt::print("{:<12} {}\n", kind, text(line));
    for (const Json& line : i["warnings"]) fmt::print("{:<12} {}\n", "warning", text(line));
}

} // namespace chiaro::cli
