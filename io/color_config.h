// io/chiaro.ocio as text; the build makes the source file from it.
#pragma once

namespace chiaro {

extern const char* const builtInColorConfig;

} // namespace chiaro
