#include "tools/bench/memory.h"
#include <algorithm>
#include <fstream>
#include <string>

namespace chiaro::bench {
namespace {

std::size_t forgotten = 0; // the highest peak before a reset

// "VmHWM:     1234 kB"
std::size_t statusBytes(const std::string& name) {
    std::ifstream in("/proc/self/status");
    for (std::string word; in >> word;) {
        if (word == name + ":") {
            std::size_t kilobytes = 0;
            return in >> kilobytes ? kilobytes * 1024 : 0;
        }
        std::getline(in, word);
    }
    return 0;
}

} // namespace

std::size_t residentBytes() { return statusBytes("VmRSS"); }
std::size_t peakBytes() { return statusBytes("VmHWM"); }
std::size_t peakOfAll() { return std::max(forgotten, peakBytes()); }

bool resetPeak() {
    const std::size_t before = peakBytes();
    std::ofstream out("/proc/self/clear_refs");
    if (!(out << 5 << std::flush)) return false;
    forgotten = std::max(forgotten, before);
    return true;
}

} // namespace chiaro::bench
