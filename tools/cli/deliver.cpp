#include "tools/cli/deliver.h"
#include "io/replace_file.h"
#include <fmt/format.h>

namespace chiaro::cli {

void checkTextOutputs(std::span<const std::string> files) {
    for (const std::string& file : files)
        if (!file.empty() && file != "-") checkWritable(file);
}

void deliver(const std::string& where, const std::string& content, const Console& console) {
    if (where.empty()) return;
    if (where == "-") {
        fmt::print("{}", content);
        return;
    }
    replaceFile(where, std::as_bytes(std::span(content)));
    console.phase("wrote", where);
}

} // namespace chiaro::cli
