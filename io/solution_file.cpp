#include "io/solution_file.h"
#include <charconv>
#include <fmt/format.h>

namespace chiaro {
namespace {

namespace fs = std::filesystem;
constexpr FileKind kind{"chiaro solution 1", "file of solved pre-passes", "Delete it, or give another --prepass-file"};
constexpr std::string_view secondsName = "seconds";

} // namespace

std::vector<StoredSolution> readSolutions(const fs::path& file) {
    std::vector<StoredSolution> all;
    for (KeyedEntry& entry : readKeyed(file, kind)) {
        StoredSolution s;
        for (const auto& [name, value] : entry.key) {
            if (name != secondsName) {
                s.key.emplace_back(name, value);
                continue;
            }
            const auto [rest, failed] = std::from_chars(value.data(), value.data() + value.size(), s.seconds);
            if (failed != std::errc() || rest != value.data() + value.size()) refuseFile(file, kind, "its heading is damaged");
        }
        s.entry = std::move(entry);
        all.push_back(std::move(s));
    }
    return all;
}

void loadSolution(const fs::path& file, const StoredSolution& s, FunctionRef<void(Reader&)> load) { loadKeyed(file, kind, s.entry, load); }

void addSolution(const fs::path& file, const SolutionKey& key, double seconds, FunctionRef<void(Writer&)> save) {
    SolutionKey all = key;
    if (!valueOf(key, secondsName).empty()) throw Error(Exit::internal, "\"seconds\" cannot be part of a solution's key");
    all.emplace_back(secondsName, fmt::format("{}", seconds));
    writeKeyed(file, kind, all, save, true);
}

} // namespace chiaro
