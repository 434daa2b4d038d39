// What an OpenEXR file says of its size, read before the library opens it: the library asks for memory and time by these numbers alone, and
// a few hundred bytes can name billions of lines.
// Source: "OpenEXR File Layout" (openexr.com).
#pragma once
#include <cstddef>
#include <span>
#include <string>

namespace chiaro {

// Throws Error(Exit::file) where a window is out of bounds, or where the file is too short for as many blocks as its windows have.
void checkExrHeader(std::span<const std::byte> bytes, const std::string& name);

} // namespace chiaro
