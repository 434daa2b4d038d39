// Solved pre-passes on disk (io/keyed_file.h): one solution or several, each with what it belongs to and the seconds that it took. Several,
// because integrators that sort their light paths differently need solutions of their own of the same scene and settings. The payload is
// what Prepass::save wrote.
#pragma once
#include "io/keyed_file.h"

namespace chiaro {

using SolutionKey = FileKey;

struct StoredSolution {
    SolutionKey key;
    double seconds = 0; // that solving took
    KeyedEntry entry;
};

// All that a file holds, every checksum proven. Throws Error(Exit::file) that names the file and what is wrong with it.
std::vector<StoredSolution> readSolutions(const std::filesystem::path&);
// The payload of one of them. Throws Error(Exit::file) also where `load` leaves some of it over.
void loadSolution(const std::filesystem::path&, const StoredSolution&, FunctionRef<void(Reader&)> load);
// Adds one to those that the file holds. A file that is not there is made. Throws as writeKeyed does.
void addSolution(const std::filesystem::path&, const SolutionKey&, double seconds, FunctionRef<void(Writer&)> save);

} // namespace chiaro
