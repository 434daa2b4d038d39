// Solved pre-passes on disk. A file holds one solution or several, each with what it belongs to as readable text, the seconds that it took,
// and a checksum of all of it; whoever reads compares the text with his own before he trusts the numbers. Several, because integrators
// that sort their light paths differently need solutions of their own of the same scene and settings.
//
// Layout: a line of text that names the format, then for each solution
//   uint64 bytes of the heading | heading | uint64 bytes of the payload | payload | uint64 XXH3 of everything before it in this solution
// in the machine's own byte order. The heading is lines of "name value"; the payload is what Prepass::save wrote.
#pragma once
#include "core/render/archive.h"
#include "core/render/function_ref.h"
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace chiaro {

// What a solution belongs to: names without spaces, values without line breaks, in the order of their telling.
using SolutionKey = std::vector<std::pair<std::string, std::string>>;
std::string valueOf(const SolutionKey&, std::string_view name); // empty: there is none

struct StoredSolution {
    SolutionKey key;
    double seconds = 0;             // that solving took
    uint64_t offset = 0, bytes = 0; // of its payload in the file
};

// All that a file holds, every checksum proven. Throws Error(Exit::file) that names the file and what is wrong with it.
std::vector<StoredSolution> readSolutions(const std::filesystem::path&);
// The payload of one of them. Throws Error(Exit::file) also where `load` leaves some of it over.
void loadSolution(const std::filesystem::path&, const StoredSolution&, FunctionRef<void(Reader&)> load);
// Adds one to those that the file holds, written beside and renamed: the file is the old one or the new one. A file that is not there is
// made. Throws as replaceFile and readSolutions do.
void addSolution(const std::filesystem::path&, const SolutionKey&, double seconds, FunctionRef<void(Writer&)> save);

} // namespace chiaro
