// From a film to what the judge looks at.
#pragma once
#include "core/render/film.h"
#include "tools/judge/picture.h"

namespace chiaro::cli {

// The mean of every pixel of the crop; no error layer.
judge::Picture judgedPicture(const Film&, std::string name);
// One layer of the film alone.
judge::Picture judgedLayer(const Film&, int layer, std::string name);
double meanLuminance(const judge::Picture&);

} // namespace chiaro::cli
