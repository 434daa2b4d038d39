// A report with everything in it, for the tests of the page.
#pragma once
#include "tools/report/report.h"

namespace chiaro::test {

report::Report exampleTexts();                                       // title, settings, notes: no entries yet
void describe(report::Entry&, report::Standing, std::size_t number); // times, verdict and coverage
void addCurves(report::Report&, std::size_t entries);                // and the times to an error
// A small report: three pictures and a reference of the given size with noise, a layer each, maps and metrics.
report::Report exampleReport(uint32_t width, uint32_t height);

} // namespace chiaro::test
