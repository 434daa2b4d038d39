#include "core/scene/texture.h"
#include "core/render/fault.h"
#include "core/render/in_parallel.h"
#include "core/scene/ray_cone.h"
#include "core/scene/texel_math.h"
#include "core/scene/texture_slots.h"

namespace chiaro {
namespace {

Vec4 operator+(const Vec4& a, const Vec4& b) noexcept { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }
Vec4 operator*(const Vec4& a, float s) noexcept { return {a.x * s, a.y * s, a.z * s, a.w * s}; }

Vec4 bilinear(const TexelStore& image, const MipLevel& level, const TextureDesc& t, Point2 uv, Transfer transfer) noexcept {
    const TexelQuad<float> q = texelQuad(uv, level.width, level.height, t.wrapS, t.wrapT);
    const bool late = fault(Fault::filterBeforeDecode) && transfer == Transfer::srgb;
    const auto at = [&](uint32_t x, uint32_t y) { return image.texel(level, x, y, late ? Transfer::linear : transfer); };
    const Vec4 a = at(q.x0, q.y0), b = at(q.x1, q.y0), c = at(q.x0, q.y1), d = at(q.x1, q.y1);
    const Vec4 m{mixed(q, a.x, b.x, c.x, d.x), mixed(q, a.y, b.y, c.y, d.y), mixed(q, a.z, b.z, c.z, d.z), mixed(q, a.w, b.w, c.w, d.w)};
    return late ? Vec4{srgbToLinear(m.x), srgbToLinear(m.y), srgbToLinear(m.z), m.w} : m;
}

} // namespace

float srgbToLinear(float v) noexcept { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }
float linearToSrgb(float v) noexcept { return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f; }

Point2 apply(const float (&m)[2][3], Point2 uv) noexcept {
    return {m[0][0] * uv.x + m[0][1] * uv.y + m[0][2], m[1][0] * uv.x + m[1][1] * uv.y + m[1][2]};
}

std::vector<Pyramids> wantedPyramids(std::span<const MaterialDesc> materials, std::span<const TextureDesc> textures, std::size_t images) {
    std::vector<Pyramids> wanted(images, Pyramids{false, false});
    for (const MaterialDesc& m : materials)
        forEachSlot(m, [&](const TextureSlot& slot, Transfer t) {
            if (slot.texture < 0 || textures[slot.texture].image < 0) return;
            Pyramids& image = wanted[textures[slot.texture].image];
            (t == Transfer::srgb ? image.srgb : image.linear) = true;
        });
    return wanted;
}

Textures::Textures(std::vector<ImageDesc> images, std::vector<TextureDesc> textures, std::vector<Pyramids> pyramids, const Executor* run)
    : textures_(std::move(textures)) {
    pyramids.resize(images.size());
    std::vector<bool> smooth(images.size(), false);
    for (const TextureDesc& t : textures_)
        if (t.image >= 0 && t.filter == TextureFilter::linear) smooth[t.image] = true;
    std::vector<std::optional<TexelStore>> made(images.size());
    inParallel(run, images.size(), [&](uint64_t i) {
        made[i].emplace(images[i], smooth[i] ? pyramids[i] : Pyramids{false, false});
        images[i].pixels = {};
    });
    for (std::optional<TexelStore>& image : made) {
        for (const Transfer t : {Transfer::linear, Transfer::srgb}) filtered_ = filtered_ || image->levels(t).size() > 1;
        images_.push_back(std::move(*image));
    }
}

std::size_t Textures::bytes() const noexcept {
    std::size_t sum = 0;
    for (const TexelStore& i : images_) sum += i.bytes();
    return sum;
}

Vec4 Textures::lookup(int texture, Point2 uv, Transfer transfer) const noexcept {
    const TextureDesc& t = textures_[texture];
    const TexelStore& image = images_[t.image];
    const MipLevel& level = image.levels(transfer)[0];
    if (t.filter == TextureFilter::linear) return bilinear(image, level, t, uv, transfer);
    const float x = tame(uv.x, t.wrapS) * float(level.width), y = tame(uv.y, t.wrapT) * float(level.height);
    return image.texel(level, wrapped(truncated(floor(x)), level.width, t.wrapS), wrapped(truncated(floor(y)), level.height, t.wrapT),
                       transfer);
}

Vec4 Textures::lookup(int texture, Point2 uv, Transfer transfer, Point2 major, Point2 minor) const noexcept {
    const TextureDesc& t = textures_[texture];
    const TexelStore& image = images_[t.image];
    const std::span<const MipLevel> levels = image.levels(transfer);
    if (t.filter == TextureFilter::nearest || levels.size() == 1) return lookup(texture, uv, transfer);
    const TexelEllipse<float> e = texelEllipse(major, minor, float(levels[0].width), float(levels[0].height));
    const auto [level, share] = levelsOf(e.width, uint32_t(levels.size() - 1));
    const int probes = int(e.probes);
    Vec4 sum{0, 0, 0, 0};
    for (int i = 0; i < probes; ++i) {
        const float along = float(i) - 0.5f * (e.probes - 1);
        const Point2 at{uv.x + e.step.x * along, uv.y + e.step.y * along};
        Vec4 v = bilinear(image, levels[level], t, at, transfer);
        if (share > 0) v = v * (1 - share) + bilinear(image, levels[level + 1], t, at, transfer) * share;
        if (probes == 1) return v;
        sum = sum + v;
    }
    return sum * (1 / e.probes);
}

} // namespace chiaro
