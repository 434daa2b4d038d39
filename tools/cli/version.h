// What this program is: filled in by the build.
#pragma once
#include <string_view>

namespace chiaro::cli {

extern const std::string_view version, commit, buildType;

} // namespace chiaro::cli
