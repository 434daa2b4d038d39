// Files are written beside their place and renamed over it: whoever reads meets the old file or the new one, never a half. A failure
// leaves the old file as it was and nothing beside it.
#pragma once
#include "core/render/error.h"
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace chiaro {

// A file that is being written beside its place; it vanishes unless commit() puts it there. Where the file system allows it has no name
// until then, so that not even a killed program leaves anything.
// write() and commit() throw Error(Exit::resources) when the disk (or a quota) is full, else Error(Exit::file).
class FileReplacement {
public:
    explicit FileReplacement(const std::filesystem::path& file);
    ~FileReplacement();
    FileReplacement(const FileReplacement&) = delete;
    FileReplacement& operator=(const FileReplacement&) = delete;
    void write(std::span<const std::byte>);
    void commit(); // to the disk, then into its place

private:
    friend void checkWritable(const std::filesystem::path&);
    struct Trial {};
    FileReplacement(const std::filesystem::path& file, Trial); // does not throw
    [[noreturn]] void fail(int code) const;
    std::filesystem::path file_, place_, name_; // as asked for; the file itself; the temporary one
    int handle_ = -1;
    bool named_ = false;
};

// All of it at once.
void replaceFile(const std::filesystem::path& file, std::span<const std::byte> content);

// Throws Error(Exit::file) if replaceFile could not work there: no such folder, no permission, a folder in its place. Meant to be asked
// before the work whose result is to be kept; leaves nothing behind.
void checkWritable(const std::filesystem::path& file);

} // namespace chiaro
