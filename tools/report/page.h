// The page as text; the build makes the source file from page.html, style.css and the modules (page.cmake). Hashes: SHA-256, hexadecimal.
#pragma once

namespace chiaro::report {

extern const char* const pageHtml; // with marks such as {{script}} that writeReport fills
extern const char* const pageStyle;
extern const char* const pageStyleHash;
extern const char* const pageScript;
extern const char* const pageScriptHash;

} // namespace chiaro::report
