// chiaro info IMAGE: size, channels, what they hold, and the recipe that the file carries.
#pragma once
#include <string>

namespace chiaro::cli {

void printImageInfo(const std::string& file, bool json);

} // namespace chiaro::cli
