#include "core/scene/texture.h"
#include "core/render/fault.h"
#include <cstring>

namespace chiaro {
namespace {

template <class T> std::vector<float> decodeTable(bool srgb) {
    std::vector<float> table(std::size_t(std::numeric_limits<T>::max()) + 1);
    for (std::size_t i = 0; i < table.size(); ++i) {
        const float v = float(i) / float(table.size() - 1);
        table[i] = srgb ? srgbToLinear(v) : v;
    }
    return table;
}
const std::vector<float>& table8(Transfer t) {
    static const std::vector<float> linear = decodeTable<uint8_t>(false), srgb = decodeTable<uint8_t>(true);
    return t == Transfer::srgb ? srgb : linear;
}
const std::vector<float>& table16(Transfer t) {
    static const std::vector<float> linear = decodeTable<uint16_t>(false), srgb = decodeTable<uint16_t>(true);
    return t == Transfer::srgb ? srgb : linear;
}

int wrap(int i, int n, Wrap mode) noexcept {
    if (i >= 0 && i < n) return i;
    if (mode == Wrap::clamp) return i < 0 ? 0 : n - 1;
    const int period = mode == Wrap::repeat ? n : 2 * n, m = ((i % period) + period) % period;
    return m < n ? m : period - 1 - m;
}

// Texture coordinates far outside any sensible range would overflow the texel index. Two pictures are a period of every mode.
float tame(float v, Wrap mode) noexcept {
    if (!std::isfinite(v)) return 0;
    return mode == Wrap::clamp ? std::clamp(v, -1.f, 2.f) : std::fmod(v, 2.f);
}

} // namespace

float srgbToLinear(float v) noexcept { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }
float linearToSrgb(float v) noexcept { return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f; }

Point2 apply(const float (&m)[2][3], Point2 uv) noexcept {
    return {m[0][0] * uv.x + m[0][1] * uv.y + m[0][2], m[1][0] * uv.x + m[1][1] * uv.y + m[1][2]};
}

Textures::Textures(std::vector<ImageDesc> images, std::vector<TextureDesc> textures)
    : images_(std::move(images)), textures_(std::move(textures)) {
    for (const Transfer t : {Transfer::linear, Transfer::srgb}) table8(t), table16(t);
}

int Textures::width(int texture) const noexcept { return images_[textures_[texture].image].width; }
int Textures::height(int texture) const noexcept { return images_[textures_[texture].image].height; }

std::size_t Textures::bytes() const noexcept {
    std::size_t sum = 0;
    for (const ImageDesc& i : images_) sum += i.pixels.size();
    return sum;
}

Vec4 Textures::texel(const ImageDesc& image, int x, int y, Transfer transfer) const noexcept {
    const int n = image.channels;
    const std::size_t first = (std::size_t(y) * image.width + x) * n;
    float c[4] = {1, 1, 1, 1};
    if (image.type == PixelType::u8) {
        const std::vector<float>& colour = table8(transfer);
        const auto* p = reinterpret_cast<const uint8_t*>(image.pixels.data()) + first;
        for (int i = 0; i < n; ++i) c[i] = colour[p[i]];
        if (n == 2 || n == 4) c[n - 1] = float(p[n - 1]) / 255;
    } else if (image.type == PixelType::u16) {
        const std::vector<float>& colour = table16(transfer);
        uint16_t p[4];
        std::memcpy(p, image.pixels.data() + first * sizeof p[0], n * sizeof p[0]);
        for (int i = 0; i < n; ++i) c[i] = colour[p[i]];
        if (n == 2 || n == 4) c[n - 1] = float(p[n - 1]) / 65535;
    } else {
        std::memcpy(c, image.pixels.data() + first * sizeof c[0], n * sizeof c[0]); // floating-point pictures are linear by nature
    }
    if (n <= 2) return {c[0], c[0], c[0], n == 2 ? c[1] : 1};
    return {c[0], c[1], c[2], c[3]};
}

Vec4 Textures::lookup(int texture, Point2 uv, Transfer transfer) const noexcept {
    const TextureDesc& t = textures_[texture];
    const ImageDesc& image = images_[t.image];
    const float x = tame(uv.x, t.wrapS) * float(image.width), y = tame(uv.y, t.wrapT) * float(image.height);
    const bool late = fault(Fault::filterBeforeDecode) && transfer == Transfer::srgb;
    const auto at = [&](int i, int j) {
        return texel(image, wrap(i, image.width, t.wrapS), wrap(j, image.height, t.wrapT), late ? Transfer::linear : transfer);
    };
    if (t.filter == TextureFilter::nearest) return at(int(std::floor(x)), int(std::floor(y)));
    const float x0 = std::floor(x - 0.5f), y0 = std::floor(y - 0.5f), fx = x - 0.5f - x0, fy = y - 0.5f - y0;
    const int i = int(x0), j = int(y0);
    const Vec4 a = at(i, j), b = at(i + 1, j), c = at(i, j + 1), d = at(i + 1, j + 1);
    const auto mix = [&](float p, float q, float r, float s) { return (p * (1 - fx) + q * fx) * (1 - fy) + (r * (1 - fx) + s * fx) * fy; };
    const Vec4 m{mix(a.x, b.x, c.x, d.x), mix(a.y, b.y, c.y, d.y), mix(a.z, b.z, c.z, d.z), mix(a.w, b.w, c.w, d.w)};
    return late ? Vec4{srgbToLinear(m.x), srgbToLinear(m.y), srgbToLinear(m.z), m.w} : m;
}

} // namespace chiaro
