// What the user reads while chiaro works: one line a phase on stderr. Results go to stdout and are no business of this file.
#pragma once
#include <string>
#include <string_view>

namespace chiaro {
class Diagnostics;
}

namespace chiaro::cli {

// "error: ..." and "warning: ..." on lines of their own; in colour on a terminal unless $NO_COLOR is set.
void printError(std::string_view message);
void printWarning(std::string_view message);
bool stderrIsTerminal();
bool colored();
std::string duration(double seconds); // "0.03 s", "2.6 s", "1 min 20 s", "2 h 05 min"
std::string memorySize(double bytes); // "84 MB", "1.2 GB"
std::string percent(double fraction); // "0.21 %", "2.6 %", "61 %", "unknown"
std::size_t residentBytes();          // of this process; 0 where unknown

// The lines of a run: a word of at most eight letters, then what there is to say.
class Console {
public:
    explicit Console(bool quiet = false) : quiet_(quiet) {}
    void phase(std::string_view word, std::string_view text) const;
    void line(std::string_view text) const;
    bool quiet() const { return quiet_; }
    // Those of the warnings that were not yet shown.
    void warnings(const Diagnostics&);
    // Those of the automatic choices that were not yet shown, a line each.
    void facts(const Diagnostics&);
    std::size_t shown() const { return shown_; }

private:
    bool quiet_;
    std::size_t shown_ = 0, factsShown_ = 0;
};

} // namespace chiaro::cli
