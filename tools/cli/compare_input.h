// The pictures of a comparison that come from files: read, brought to the area that all have, and said no to where that cannot be.
#pragma once
#include "core/render/view.h"
#include "tools/cli/compare_settings.h"
#include "tools/cli/picture_side.h"

namespace chiaro::cli {

struct FilePictures {
    std::vector<PictureSide> pictures; // in the order of CompareSettings::images
    std::optional<PictureSide> reference;
    uint32_t width = 0, height = 0; // of the whole picture
    Rect area;                      // of it: what is compared
};
// view: of the scene; its crop is the area where nothing says otherwise. Throws Error(Exit::unsupported) with the sizes that do not match.
FilePictures loadPictures(const CompareSettings&, const View* view, Diagnostics&);

} // namespace chiaro::cli
