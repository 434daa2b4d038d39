#include "io/file_bytes.h"
#include "core/render/error.h"
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>

namespace chiaro {

namespace {

constexpr uint64_t maxBytes = uint64_t(1) << 34;

} // namespace

std::string similarNames(const std::filesystem::path& path) {
    std::vector<std::string> names;
    std::error_code ignored;
    const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    for (auto it = std::filesystem::directory_iterator(folder, ignored); !ignored && it != std::filesystem::directory_iterator();
         it.increment(ignored))
        if (names.size() < 10'000) names.push_back(it->path().filename().string());
    const std::string best = nearest(path.filename().string(), names);
    return best.empty() ? "" : "; similar here: " + best;
}

std::string printable(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return text;
}

std::string shown(std::string_view text, size_t longest) {
    return printable('"' + std::string(text.substr(0, longest)) + (text.size() > longest ? "...\"" : "\""));
}

std::vector<std::byte> readBytes(const std::filesystem::path& path) {
    std::error_code failed;
    const auto status = std::filesystem::status(path, failed);
    const std::string name = path.string();
    if (status.type() == std::filesystem::file_type::not_found)
        throw Error(Exit::file, fmt::format("{}: no such file{}", name, similarNames(path)));
    if (status.type() == std::filesystem::file_type::directory)
        throw Error(Exit::file, fmt::format("{}: is a folder. Give the file inside it.", name));
    if (!std::filesystem::is_regular_file(status))
        throw Error(Exit::file, fmt::format("{}: cannot be read ({}).", name, failed ? failed.message() : "not a regular file"));
    const uintmax_t size = std::filesystem::file_size(path, failed);
    if (failed) throw Error(Exit::file, fmt::format("{}: cannot be read ({}).", name, failed.message()));
    if (size > maxBytes) throw Error(Exit::file, fmt::format("{}: has {} bytes, limit {}. Split it.", name, size, maxBytes));
    std::vector<std::byte> bytes(size);
    errno = 0;
    std::ifstream in(path, std::ios::binary);
    if (!in || (size && !in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size))))
        throw Error(Exit::file,
                    fmt::format("{}: cannot be read ({}).", name, errno ? std::strerror(errno) : "it changed while being read"));
    return bytes;
}

} // namespace chiaro
