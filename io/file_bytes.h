// A file as bytes, and text from a file made fit for a message of one line.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro {

// The whole of a regular file. Throws Error(Exit::file); an absent one is answered with the nearest name in its folder.
std::vector<std::byte> readBytes(const std::filesystem::path& path);

// "; similar here: NAME" where the folder of an absent file holds a name near to it; else empty.
std::string similarNames(const std::filesystem::path& path);
std::string printable(std::string text);                        // control characters replaced
std::string shown(std::string_view text, size_t longest = 120); // printable, quoted, cut when long

} // namespace chiaro
