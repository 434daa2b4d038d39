#include "core/scene/sky.h"
#include "core/math/distribution.h"
#include <cstring>
#include <span>

namespace chiaro {
namespace {

// What the look-up shows on average over each texel: the texels themselves, or with a linear filter their blend with the neighbours (the
// tent over a texel: 1/8, 3/4, 1/8 along each axis).
std::vector<double> meanLuminance(std::span<const Vec4> texels, int width, int height, TextureFilter filter) {
    std::vector<double> own(texels.size());
    for (std::size_t i = 0; i < own.size(); ++i) own[i] = std::max(0.0, double(luminance(Spectrum(texels[i].x, texels[i].y, texels[i].z))));
    if (filter == TextureFilter::nearest) return own;
    std::vector<double> across(own.size()), mean(own.size());
    const auto index = [width](int x, int y) { return std::size_t(y) * width + x; };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            across[index(x, y)] =
                0.75 * own[index(x, y)] + 0.125 * (own[index((x + width - 1) % width, y)] + own[index((x + 1) % width, y)]);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            mean[index(x, y)] =
                0.75 * across[index(x, y)] + 0.125 * (across[index(x, std::max(0, y - 1))] + across[index(x, std::min(height - 1, y + 1))]);
    return mean;
}

} // namespace

Sky::Sky(const EnvironmentDesc& d) : filter_(d.filter) {
    const int width = d.image.width, height = d.image.height;
    frame_ = {uint32_t(width), uint32_t(height), std::cos(d.rotate), std::sin(d.rotate)};
    for (int row = 0; row <= height; ++row) rows_.push_back(float(std::cos(std::numbers::pi * row / height)));
    rows_.back() = -1;
    const std::size_t count = std::size_t(width) * height;
    std::vector<float> rgb(count * 3);
    std::memcpy(rgb.data(), d.image.pixels.data(), rgb.size() * sizeof(float));
    texels_.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
        texels_.push_back({rgb[3 * i] * d.scale, rgb[3 * i + 1] * d.scale, rgb[3 * i + 2] * d.scale, 0});
    rgb = {};
    std::vector<double> solidAngle(height);
    for (int y = 0; y < height; ++y)
        solidAngle[y] =
            (std::cos(std::numbers::pi * y / height) - std::cos(std::numbers::pi * (y + 1) / height)) * 2 * std::numbers::pi / width;
    std::vector<double> weights = meanLuminance(texels_, width, height, filter_);
    for (std::size_t i = 0; i < count; ++i) weights[i] *= solidAngle[i / width];
    const AliasTable table(weights);
    sum_ = table.sum();
    cells_.resize(count + 1);
    if (table.empty()) return;
    for (std::size_t i = 0; i < count; ++i) {
        const auto cell = uint32_t(i);
        cells_[i] = {table.keep(cell), table.alias(cell)};
        texels_[i].w =
            float(double(table.pmf(cell)) / (fault(Fault::skySineMissing) ? 4 * std::numbers::pi / double(count) : solidAngle[i / width]));
    }
}

std::size_t Sky::bytes() const noexcept {
    return texels_.capacity() * sizeof(Vec4) + cells_.capacity() * sizeof(Cell) + rows_.capacity() * sizeof(float);
}

Vec4 Sky::look(const SkyPlace<float>& p) const noexcept {
    // Around the horizon the picture goes on at its other side; above and below it ends.
    const int width = int(frame_.width), height = int(frame_.height);
    const auto texel = [&](int x, int y) -> const Vec4& {
        const int column = x < 0 ? x + width : x >= width ? x - width : x;
        return texels_[std::size_t(std::clamp(y, 0, height - 1)) * width + std::clamp(column, 0, width - 1)];
    };
    if (filter_ == TextureFilter::nearest) return texel(int(p.x), int(p.y));
    const float x0 = std::floor(p.x - 0.5f), y0 = std::floor(p.y - 0.5f), fx = p.x - 0.5f - x0, fy = p.y - 0.5f - y0;
    const int x = int(x0), y = int(y0);
    const Vec4 &a = texel(x, y), &b = texel(x + 1, y), &c = texel(x, y + 1), &d = texel(x + 1, y + 1);
    const SkyWeights<float> w = skyWeights(fx, fy);
    const Vec4& own = fx < 0.5f ? (fy < 0.5f ? a : c) : (fy < 0.5f ? b : d);
    return {skyBlend(w, a.x, b.x, c.x, d.x), skyBlend(w, a.y, b.y, c.y, d.y), skyBlend(w, a.z, b.z, c.z, d.z), own.w};
}

Vec4 Sky::at(const Vec3& direction) const noexcept { return look(skyPlace(frame_, direction)); }

std::optional<Sky::Sample> Sky::sample(double uCell, Point2 u) const noexcept {
    if (black()) return {};
    const uint32_t last = count() - 1, cell = std::min(uint32_t(uCell * double(count())), last);
    const auto [keep, alias] = cells_[cell];
    const bool stays = u.x < keep;
    const uint32_t texel = stays ? cell : alias, row = texel / frame_.width, column = texel % frame_.width;
    const float left = std::min((stays ? u.x : u.x - keep) / (stays ? keep : 1 - keep), oneMinusEpsilon);
    const float cosine = rows_[row] + (rows_[row + 1] - rows_[row]) * u.y;
    const SkyDirection<float> d = skyDirection(frame_, float(column) + left, cosine);
    const Vec4& own = texels_[texel];
    const Vec4 seen = filter_ == TextureFilter::nearest ? own : look(d.place);
    return Sample{d.w, {seen.x, seen.y, seen.z}, own.w}; // the density of the texel drawn, should rounding have left it
}

} // namespace chiaro
