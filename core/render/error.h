// Errors and warnings as users see them: one line that says what is wrong, where, and how to mend it. Errors are thrown while reading,
// compiling and preparing, never from the sampling loop.
#pragma once
#include <cstddef>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

namespace chiaro {

// The exit codes of the command line; 0 to 4 are those of OpenImageIO's idiff.
enum class Exit : int {
    done = 0,
    warning = 1,
    failed = 2,
    unsupported = 3,
    file = 4,
    stopped = 5,
    resources = 6,
    usage = 64,
    internal = 70,
    killed = 130
};

class Error : public std::runtime_error {
public:
    Error(Exit exitCode, std::string message) : std::runtime_error(std::move(message)), code(exitCode) {}
    Exit code;
};

// Warnings of one run, in the order of their arrival; the same text is kept once. Beside them what was chosen or found automatically and a
// user may want to fix or to quote: "photons  2.1 M in 0.4 s, radius 0.031 m      keep it with: -i photon:radius=0.031".
class Diagnostics {
public:
    void warn(std::string message);
    void tell(std::string subject, std::string message);
    struct Fact {
        std::string subject, message; // subject: one word
        friend bool operator==(const Fact&, const Fact&) = default;
    };
    std::vector<std::string> warnings() const;
    std::vector<Fact> facts() const;

private:
    mutable std::mutex mutex_;
    std::vector<std::string> warnings_;
    std::vector<Fact> facts_;
};

// The member of candidates that is nearest to word by edit distance, or empty when none is near enough to be meant.
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);

} // namespace chiaro
