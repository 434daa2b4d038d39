#include "tools/cli/memory.h"
#include "core/render/error.h"
#include "core/scene/scene.h"
#include "tools/cli/command.h"
#include "tools/cli/console.h"
#include "tools/cli/values.h"
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

namespace chiaro::cli {
namespace {

constexpr std::size_t unlimited = ~std::size_t(0);

// A limit file of a control group: a number, or "max".
std::size_t limitIn(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string text;
    in >> text;
    std::size_t bytes = unlimited;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), bytes);
    return failed == std::errc() && end == text.data() + text.size() ? bytes : unlimited;
}

// The tightest limit of the groups that hold this process, up to the root. In /proc/self/cgroup a line is "number:controllers:path";
// without controllers it is version 2. Inside a container the path may be one of the host, that is not mounted: then the root's own limit
// counts.
std::size_t groupLimit() {
    const std::filesystem::path mount = "/sys/fs/cgroup";
    std::size_t least = std::min(limitIn(mount / "memory.max"), limitIn(mount / "memory/memory.limit_in_bytes"));
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1);
        const bool old = ("," + controllers + ",").find(",memory,") != std::string::npos;
        if (!old && !controllers.empty()) continue;
        const std::filesystem::path base = old ? mount / "memory" : mount;
        for (std::filesystem::path path = line.substr(second + 1); path.has_relative_path(); path = path.parent_path())
            least = std::min(least, limitIn(base / path.relative_path() / (old ? "memory.limit_in_bytes" : "memory.max")));
    }
    return least;
}

// A size that --max-memory reads back, rounded up.
std::string asOption(double bytes) {
    return bytes < 1e9 ? fmt::format("{:.0f}M", std::ceil(bytes / 1e6)) : fmt::format("{:.0f}G", std::ceil(bytes / 1e9));
}

std::array<std::pair<const char*, std::size_t>, 6> named(const SceneBytes& b) {
    return {{{"geometry", b.geometry},
             {"hierarchy", b.hierarchy},
             {"placement", b.placement},
             {"lights", b.lights},
             {"materials", b.materials},
             {"textures", b.textures}}};
}

[[noreturn]] void terminated() {
    try {
        if (const std::exception_ptr e = std::current_exception()) std::rethrow_exception(e);
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "error: %s\n", outOfMemory);
        std::_Exit(int(Exit::resources));
    } catch (...) {}
    std::abort();
}

} // namespace

std::size_t machineBytes() {
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    const std::size_t physical = pages > 0 && size > 0 ? std::size_t(pages) * std::size_t(size) : unlimited;
    const std::size_t least = std::min(physical, groupLimit());
    return least == unlimited ? 0 : least;
}

std::size_t peakBytes() {
    rusage used{};
    return getrusage(RUSAGE_SELF, &used) == 0 ? std::size_t(used.ru_maxrss) * 1024 : 0; // Linux counts in kilobytes
}

std::string MemoryBudget::text() const {
    return given ? fmt::format("--max-memory is {}", memorySize(double(bytes)))
                 : fmt::format("this machine has {}", memorySize(double(machineBytes())));
}

std::size_t MemoryBudget::beside(const Scene& scene) const noexcept {
    if (bytes == unlimited) return bytes;
    const std::size_t taken = scene.counts().bytes.total();
    return bytes > taken ? bytes - taken : 0;
}

MemoryBudget readMemoryBudget(const Arguments& arguments) {
    constexpr double share = 0.8;
    if (findOption(*arguments.command, "max-memory") && arguments.given("max-memory"))
        return {parseMemory("max-memory", arguments.text("max-memory")), true};
    const std::size_t machine = machineBytes();
    return {machine == 0 ? unlimited : std::size_t(share * double(machine)), false};
}

void admitScene(const std::string& name, const SceneSizes& sizes, const MemoryBudget& budget) {
    const SceneForecast f = forecast(sizes);
    if (f.most <= budget.bytes) return;
    const double triangles = double(f.kept.geometry + f.kept.hierarchy), textures = double(f.kept.textures),
                 places = double(f.kept.placement), lights = double(f.kept.lights), materials = double(f.kept.materials);
    std::string parts;
    for (const auto& [part, bytes] :
         {std::pair{"triangles", triangles}, {"textures", textures}, {"instances", places}, {"lights", lights}, {"materials", materials}})
        if (bytes > 0.02 * double(f.most)) parts += fmt::format("{}{} {}", parts.empty() ? " (" : ", ", part, memorySize(bytes));
    if (!parts.empty()) parts += ')';
    const char* remedy = textures > triangles && textures > materials ? "Make the textures smaller"
                         : materials > triangles                      ? "Use fewer materials"
                                                                      : "Use fewer triangles, or instances of shared meshes";
    throw Error(Exit::resources,
                fmt::format("{} needs about {}{}, {}. {}{}.", name, memorySize(double(f.most)), parts, budget.text(), remedy,
                            budget.given ? fmt::format(", or --max-memory {}", asOption(double(f.most) * 1.05)) : std::string()));
}

nlohmann::ordered_json sceneBytesJson(const SceneBytes& b) {
    nlohmann::ordered_json all;
    for (const auto& [part, bytes] : named(b)) all[part] = bytes;
    all["total"] = b.total();
    return all;
}

std::string sceneBytesText(const SceneBytes& b) {
    std::string text;
    for (const auto& [part, bytes] : named(b))
        if (bytes > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", part, memorySize(double(bytes)));
    return text;
}

std::string besideText(const Scene& scene, double needed) {
    const double taken = double(scene.counts().bytes.total());
    return taken < 0.05 * needed ? "" : fmt::format(" beside the {} of the scene", memorySize(taken));
}

void exitOnOutOfMemory() { std::set_terminate(terminated); }

} // namespace chiaro::cli
