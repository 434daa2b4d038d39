// Files that belong to something: a solved pre-pass to its scene and settings, a checkpoint to its render. An entry of such a file says as
// readable text what it belongs to, and carries a checksum of all of it; whoever reads compares the text with his own before he trusts the
// numbers. Files are written beside their place and renamed: the file is the old one or the new one.
//
// Layout: a line of text that names the format, then for each entry
//   uint64 bytes of the heading | heading | uint64 bytes of the payload | payload | uint64 XXH3 of everything before it in this entry
// in the machine's own byte order. The heading is lines of "name value".
#pragma once
#include "core/render/archive.h"
#include "core/render/function_ref.h"
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace chiaro {

// What an entry belongs to: names without spaces, values without line breaks, in the order of their telling.
using FileKey = std::vector<std::pair<std::string, std::string>>;
std::string valueOf(const FileKey&, std::string_view name); // empty: there is none

struct FileKind {
    std::string_view magic;  // the first line
    std::string_view noun;   // "file of solved pre-passes"
    std::string_view advice; // what to do where one cannot be used
};
struct KeyedEntry {
    FileKey key;
    uint64_t offset = 0, bytes = 0; // of its payload in the file
};

// "FILE: why. ADVICE" as Error(Exit::file).
[[noreturn]] void refuseFile(const std::filesystem::path&, const FileKind&, std::string_view why);
// All that a file holds, every checksum proven. Throws Error(Exit::file) that names the file and what is wrong with it.
std::vector<KeyedEntry> readKeyed(const std::filesystem::path&, const FileKind&);
// The payload of one of them. Throws Error(Exit::file) also where `load` leaves some of it over.
void loadKeyed(const std::filesystem::path&, const FileKind&, const KeyedEntry&, FunctionRef<void(Reader&)> load);
// A file of this entry alone, or, to `add`, behind those that the file holds. `save` is called twice and must write the same: once to
// count. Throws as FileReplacement and readKeyed do.
void writeKeyed(const std::filesystem::path&, const FileKind&, const FileKey&, FunctionRef<void(Writer&)> save, bool add = false);

} // namespace chiaro
