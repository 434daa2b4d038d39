// The report as JSON for the page: numbers that JSON has no word for travel as null (NaN) or text (infinities), and the text can stand
// inside a <script> element, for `<`, `>`, `&` and everything beyond ASCII is escaped.
#pragma once
#include "tools/report/fit.h"
#include <string>

namespace chiaro::report {

std::string asJson(const Report&, const Fitted&);

} // namespace chiaro::report
