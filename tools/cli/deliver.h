// Results as text: to a file that is replaced whole, or to stdout.
#pragma once
#include "tools/cli/console.h"
#include <span>
#include <string>

namespace chiaro::cli {

// Before the work begins. Empty: not wanted; "-": stdout. Throws Error(Exit::file).
void checkTextOutputs(std::span<const std::string> files);
// To the file, or for "-" to stdout in place of the text.
void deliver(const std::string& where, const std::string& content, const Console&);
// A field of CSV: in quotes where it needs them (RFC 4180).
std::string csvQuoted(const std::string&);

} // namespace chiaro::cli
