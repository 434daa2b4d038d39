// Files are written beside their place and renamed over it: whoever reads meets the old file or the new one, never a half. A failure
// leaves the old file as it was and nothing beside it.
#pragma once
#include "core/render/error.h"
#include <cstddef>
#include <filesystem>
#include <span>

namespace chiaro {

// Throws Error(Exit::resources) when the disk (or a quota) is full, else Error(Exit::file).
void replaceFile(const std::filesystem::path& file, std::span<const std::byte> content);

// Throws Error(Exit::file) if replaceFile could not work there: no such folder, no permission, a folder in its place. Meant to be asked
// before the work whose result is to be kept; leaves nothing behind.
void checkWritable(const std::filesystem::path& file);

} // namespace chiaro
