// The sheet: all pictures of a comparison side by side in one PNG, as a paper or a README shows them. One exposure and one view for all,
// said in the title; under each picture its name, what it cost, how far it is from the reference, and the verdict.
//
// At most 2400 pixels wide. Pictures are enlarged by whole factors, so that pixels stay squares, or reduced by averaging linear light over
// the area of each new pixel. A pixel that is not finite, and one into which such a pixel was averaged, has a colour of its own.
#pragma once
#include "io/color.h"
#include "tools/judge/tiny_font.h"
#include "tools/report/report.h"
#include <filesystem>

namespace chiaro::cli {

// Works on any report: without entries there is a title, an entry without a picture keeps its place and its label.
judge::Canvas drawSheet(const report::Report&, const DisplayTransform&);
// Throws Error: the file cannot be written.
void writeSheet(const report::Report&, const std::filesystem::path&, const DisplayTransform&);

} // namespace chiaro::cli
