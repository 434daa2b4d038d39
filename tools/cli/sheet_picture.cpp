#include "tools/cli/sheet_picture.h"
#include <algorithm>
#include <cmath>

namespace chiaro::cli {
namespace {

// Which pixels of the source lie in one of the target, along one axis, and how much of each: in whole numbers, of 1/to of a source pixel.
struct Cover {
    std::size_t first = 0;
    std::vector<double> shares; // sum 1
};
std::vector<Cover> covers(uint64_t from, uint64_t to) {
    std::vector<Cover> all(to);
    for (uint64_t i = 0; i < to; ++i) {
        const uint64_t begin = i * from, end = begin + from;
        all[i].first = begin / to;
        for (uint64_t k = all[i].first; k * to < end; ++k) {
            const uint64_t overlap = std::min(end, (k + 1) * to) - std::max(begin, k * to);
            all[i].shares.push_back(double(overlap) / double(from));
        }
    }
    return all;
}

} // namespace

SheetSize sheetSize(SheetSize picture, SheetSize frame, uint32_t enough) {
    const uint32_t larger = std::max(picture.width, picture.height);
    if (picture.width <= frame.width && picture.height <= frame.height) {
        const uint32_t most = std::min(frame.width / picture.width, frame.height / picture.height);
        const uint32_t factor = std::clamp(enough / larger, 1u, most);
        return {picture.width * factor, picture.height * factor};
    }
    const double scale = std::min(double(frame.width) / picture.width, double(frame.height) / picture.height);
    return {std::max(1u, uint32_t(std::lround(picture.width * scale))), std::max(1u, uint32_t(std::lround(picture.height * scale)))};
}

SheetPixels sheetPixels(std::span<const float> rgb, SheetSize from, SheetSize to) {
    SheetPixels out;
    out.rgb.resize(std::size_t(to.width) * to.height * 3);
    out.unusable.resize(std::size_t(to.width) * to.height);
    const std::vector<Cover> columns = covers(from.width, to.width), rows = covers(from.height, to.height);
    for (uint32_t y = 0; y < to.height; ++y)
        for (uint32_t x = 0; x < to.width; ++x) {
            const Cover &column = columns[x], &row = rows[y];
            double sum[3] = {};
            for (std::size_t j = 0; j < row.shares.size(); ++j)
                for (std::size_t i = 0; i < column.shares.size(); ++i) {
                    const std::size_t at = (row.first + j) * from.width + column.first + i;
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += rgb[3 * at + c] * (row.shares[j] * column.shares[i]);
                }
            const std::size_t at = std::size_t(y) * to.width + x;
            out.unusable[at] = !(std::isfinite(sum[0]) && std::isfinite(sum[1]) && std::isfinite(sum[2]));
            for (std::size_t c = 0; c < 3 && !out.unusable[at]; ++c) out.rgb[3 * at + c] = float(sum[c]);
        }
    return out;
}

} // namespace chiaro::cli
