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

std::string csvQuoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

} // namespace chiaro::cli
