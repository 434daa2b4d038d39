#include "tools/cli/console.h"
#include "core/render/error.h"
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace chiaro::cli {
namespace {

void labelled(std::string_view label, const char* color, std::string_view message) {
    std::string oneLine(message);
    for (char& c : oneLine)
        if (c == '\n' || c == '\r') c = ' ';
    if (colored())
        fmt::print(stderr, "\x1b[1;{}m{}:\x1b[0m {}\n", color, label, oneLine);
    else
        fmt::print(stderr, "{}: {}\n", label, oneLine);
}

} // namespace

void printError(std::string_view message) { labelled("error", "31", message); }
void printWarning(std::string_view message) { labelled("warning", "33", message); }

bool stderrIsTerminal() { return isatty(STDERR_FILENO) == 1; }

bool colored() {
    const char* no = std::getenv("NO_COLOR"); // no-color.org: any value but the empty one
    return stderrIsTerminal() && !(no && *no);
}

std::string duration(double seconds) {
    if (seconds < 1) return fmt::format("{:.2f} s", seconds);
    if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
    const long whole = std::lround(seconds);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

std::string memorySize(double bytes) {
    if (bytes < 1e6) return fmt::format("{:.0f} kB", std::ceil(bytes / 1e3));
    if (bytes < 1e9) return fmt::format("{:.0f} MB", bytes / 1e6);
    return bytes < 1e13 ? fmt::format("{:.1f} GB", bytes / 1e9) : fmt::format("{:.0f} TB", bytes / 1e12);
}

std::string percent(double fraction) {
    if (!std::isfinite(fraction)) return "unknown";
    const double p = fraction * 100;
    return p < 10 ? fmt::format("{:.2g} %", p) : fmt::format("{:.0f} %", p);
}

std::size_t residentBytes() {
    std::ifstream statm("/proc/self/statm");
    std::size_t total = 0, resident = 0;
    statm >> total >> resident;
    return resident * std::size_t(sysconf(_SC_PAGESIZE));
}

void Console::phase(std::string_view word, std::string_view text) const {
    if (!quiet_) fmt::print(stderr, "{:<8} {}\n", word, text);
}

void Console::line(std::string_view text) const {
    if (!quiet_) fmt::print(stderr, "{}\n", text);
}

void Console::warnings(const Diagnostics& notes) {
    const std::vector<std::string> all = notes.warnings();
    for (; shown_ < all.size(); ++shown_) printWarning(all[shown_]);
}

void Console::facts(const Diagnostics& notes) {
    const std::vector<Diagnostics::Fact> all = notes.facts();
    for (; factsShown_ < all.size(); ++factsShown_) phase(all[factsShown_].subject, all[factsShown_].message);
}

} // namespace chiaro::cli
