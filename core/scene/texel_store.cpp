#include "core/scene/texel_store.h"
#include "core/math/half.h"
#include "core/render/function_ref.h"
#include "core/scene/texel_math.h"
#include "core/scene/texture.h"
#include <bit>
#include <cstring>
#include <new>

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

// The code of 8 bits whose encoded value is nearest: a first guess by linear value, from there on by the borders between codes.
class SrgbEncoder {
public:
    SrgbEncoder() {
        for (int c = 0; c < 255; ++c) upper_[c] = srgbToLinear((float(c) + 0.5f) / 255);
        upper_[255] = infinity;
        for (int i = 0, code = 0; i < guesses; ++i) {
            while (upper_[code] < float(i) / guesses) ++code;
            guess_[i] = uint8_t(code);
        }
    }
    uint8_t operator()(float linear) const noexcept {
        const float v = clamp01(linear);
        uint32_t code = guess_[std::min(int(v * guesses), guesses - 1)];
        while (upper_[code] < v) ++code;
        return uint8_t(code);
    }

private:
    static constexpr int guesses = 4096;
    float upper_[256];
    uint8_t guess_[guesses];
};

// Shares of up to three texels of a side that go into texel i of the next level.
struct Taps {
    uint32_t first = 0, count = 1;
    float weight[3] = {1, 0, 0};
};
Taps taps(uint32_t i, uint32_t from) noexcept {
    if (from == 1) return {};
    if (from % 2 == 0) return {2 * i, 2, {0.5f, 0.5f, 0}};
    const float n = float(from), half = float(from / 2);
    return {2 * i, 3, {(half - float(i)) / n, half / n, float(i + 1) / n}};
}

// Rows of one level, channels interleaved, as floats in linear light.
using Rows = FunctionRef<const float*(uint32_t y)>;

std::vector<float> halved(uint32_t width, uint32_t height, int channels, Rows rows) {
    const uint32_t w = std::max(width / 2, 1u), h = std::max(height / 2, 1u);
    std::vector<float> to(std::size_t(w) * h * channels);
    std::vector<Taps> across(w);
    for (uint32_t x = 0; x < w; ++x) across[x] = taps(x, width);
    for (uint32_t y = 0; y < h; ++y) {
        float* const row = &to[std::size_t(y) * w * channels];
        const Taps down = taps(y, height);
        for (uint32_t j = 0; j < down.count; ++j) {
            const float* const from = rows(down.first + j);
            for (uint32_t x = 0; x < w; ++x)
                for (int c = 0; c < channels; ++c) {
                    float sum = 0;
                    for (uint32_t i = 0; i < across[x].count; ++i)
                        sum += across[x].weight[i] * from[std::size_t(across[x].first + i) * channels + c];
                    row[std::size_t(x) * channels + c] += down.weight[j] * sum;
                }
        }
    }
    return to;
}

} // namespace

const float* decoding8(Transfer t) noexcept {
    static const std::vector<float> linear = decodeTable<uint8_t>(false), srgb = decodeTable<uint8_t>(true);
    return (t == Transfer::srgb ? srgb : linear).data();
}
const float* decoding16(Transfer t) noexcept {
    static const std::vector<float> linear = decodeTable<uint16_t>(false), srgb = decodeTable<uint16_t>(true);
    return (t == Transfer::srgb ? srgb : linear).data();
}
const float* decodingHalf() noexcept {
    static const std::vector<float> table = [] {
        std::vector<float> all(65536);
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = halfToFloat(uint16_t(i));
        return all;
    }();
    return table.data();
}

TexelStore::TexelStore(const ImageDesc& image, Pyramids wanted) : type_(image.type), channels_(image.channels) {
    channelBytes_ = type_ == PixelType::u8 ? 1 : type_ == PixelType::f32 ? 4 : 2;
    texelBytes_ = channelBytes_ * (channels_ == 3 ? 4 : uint32_t(channels_));
    for (const Transfer t : {Transfer::linear, Transfer::srgb})
        decoded_[std::size_t(t)] = type_ == PixelType::u8    ? decoding8(t)
                                   : type_ == PixelType::u16 ? decoding16(t)
                                   : type_ == PixelType::f16 ? decodingHalf()
                                                             : nullptr;
    const auto width = uint32_t(image.width), height = uint32_t(image.height);
    // As square as 64 bytes allow, but no wider or higher than the picture.
    const uint32_t all = uint32_t(std::countr_zero(64 / texelBytes_));
    const uint32_t wide = uint32_t(std::bit_width(width - 1)), high = uint32_t(std::bit_width(height - 1));
    tileX_ = std::min({(all + 1) / 2, wide, all});
    tileY_ = std::min(all - tileX_, high);
    tileX_ = std::min(all - tileY_, wide);
    std::size_t texels = 0;
    add(Transfer::linear, texels, width, height);
    levels_[std::size_t(Transfer::srgb)] = levels_[std::size_t(Transfer::linear)];
    // Floating-point pictures are linear by nature: one pyramid serves both.
    const bool one = type_ == PixelType::f32 || type_ == PixelType::f16, any = wanted.linear || wanted.srgb;
    for (const Transfer t : {Transfer::linear, Transfer::srgb}) {
        if (one ? !any || t == Transfer::srgb : !(t == Transfer::srgb ? wanted.srgb : wanted.linear)) continue;
        for (uint32_t w = width, h = height; (w > 1 || h > 1) && levels_[std::size_t(t)].size() < mostLevels;) {
            w = std::max(w / 2, 1u), h = std::max(h / 2, 1u);
            add(t, texels, w, h);
        }
    }
    if (one) levels_[std::size_t(Transfer::srgb)] = levels_[std::size_t(Transfer::linear)];
    bytes_ = texels * texelBytes_;
    data_.reset(static_cast<std::byte*>(std::aligned_alloc(64, (bytes_ + 16 + 63) / 64 * 64)));
    if (!data_) throw std::bad_alloc();
    std::memset(data_.get(), 0, (bytes_ + 16 + 63) / 64 * 64);
    const std::size_t bytes = std::size_t(channels_) * channelBytes_;
    const MipLevel& base = levels_[0][0];
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) std::memcpy(at(base, x, y), image.pixels.data() + (std::size_t(y) * width + x) * bytes, bytes);
    if (levels_[0].size() > 1) reduce(Transfer::linear);
    if (!one && levels_[1].size() > 1) reduce(Transfer::srgb);
}

void TexelStore::add(Transfer t, std::size_t& texels, uint32_t width, uint32_t height) {
    const auto tiles = [](uint32_t n, uint32_t side) { return (n + (1u << side) - 1) >> side; };
    const uint32_t across = tiles(width, tileX_);
    levels_[std::size_t(t)].push_back({width, height, across, uint32_t(texels)});
    texels += (std::size_t(across) * tiles(height, tileY_)) << (tileX_ + tileY_);
}

std::byte* TexelStore::at(const MipLevel& l, uint32_t x, uint32_t y) const noexcept {
    return data_.get() + std::size_t(texelNumber(l.first, l.across, x, y, tileX_, tileY_)) * texelBytes_;
}

// Each level from the one above it before that was rounded to codes.
void TexelStore::reduce(Transfer transfer) {
    static const SrgbEncoder encode;
    const std::vector<MipLevel>& levels = levels_[std::size_t(transfer)];
    const int n = channels_;
    const auto colour = [&](int c) { return !((n == 2 || n == 4) && c == n - 1); };
    std::vector<float> scratch(std::size_t(levels[0].width) * n), above, here;
    const auto decoded = [&](uint32_t y) -> const float* {
        for (uint32_t x = 0; x < levels[0].width; ++x) {
            const Vec4 v = texel(levels[0], x, y, transfer);
            float* const to = &scratch[std::size_t(x) * n];
            to[0] = v.x;
            if (n == 2) to[1] = v.w;
            if (n >= 3) to[1] = v.y, to[2] = v.z;
            if (n == 4) to[3] = v.w;
        }
        return scratch.data();
    };
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const MipLevel &from = levels[i - 1], &to = levels[i];
        const auto kept = [&](uint32_t y) -> const float* { return &above[std::size_t(y) * from.width * n]; };
        here = i == 1 ? halved(from.width, from.height, n, decoded) : halved(from.width, from.height, n, kept);
        above.swap(here);
        for (uint32_t y = 0; y < to.height; ++y)
            for (uint32_t x = 0; x < to.width; ++x) {
                const float* const v = &above[(std::size_t(y) * to.width + x) * n];
                std::byte* const texel = at(to, x, y);
                for (int c = 0; c < n; ++c) {
                    const bool srgb = transfer == Transfer::srgb && colour(c);
                    if (type_ == PixelType::u8) {
                        const uint8_t code = srgb ? encode(v[c]) : uint8_t(clamp01(v[c]) * 255 + 0.5f);
                        std::memcpy(texel + c, &code, 1);
                    } else if (type_ == PixelType::u16) {
                        const auto code = uint16_t(clamp01(srgb ? linearToSrgb(v[c]) : v[c]) * 65535 + 0.5f);
                        std::memcpy(texel + 2 * c, &code, 2);
                    } else if (type_ == PixelType::f16) {
                        const uint16_t code = floatToHalf(v[c]);
                        std::memcpy(texel + 2 * c, &code, 2);
                    } else {
                        std::memcpy(texel + 4 * c, &v[c], 4);
                    }
                }
            }
    }
}

Vec4 TexelStore::texel(const MipLevel& level, uint32_t x, uint32_t y, Transfer transfer) const noexcept {
    const int n = channels_;
    const std::byte* const from = at(level, x, y);
    float c[4] = {1, 1, 1, 1};
    if (type_ == PixelType::u8) {
        const float* const table = decoded_[std::size_t(transfer)];
        const auto* p = reinterpret_cast<const uint8_t*>(from);
        for (int i = 0; i < n; ++i) c[i] = table[p[i]];
        if (n == 2 || n == 4) c[n - 1] = float(p[n - 1]) / 255;
    } else if (type_ != PixelType::f32) {
        const float* const table = decoded_[std::size_t(transfer)];
        uint16_t p[4];
        std::memcpy(p, from, std::size_t(n) * sizeof p[0]);
        for (int i = 0; i < n; ++i) c[i] = table[p[i]];
        if (type_ == PixelType::u16 && (n == 2 || n == 4)) c[n - 1] = float(p[n - 1]) / 65535;
    } else {
        std::memcpy(c, from, std::size_t(n) * sizeof c[0]); // floating-point pictures are linear by nature
    }
    if (n <= 2) return {c[0], c[0], c[0], n == 2 ? c[1] : 1};
    return {c[0], c[1], c[2], c[3]};
}

void TexelStore::row(uint32_t y, std::vector<std::byte>& to) const {
    const MipLevel& base = levels_[0][0];
    const std::size_t bytes = std::size_t(channels_) * channelBytes_;
    to.resize(base.width * bytes);
    for (uint32_t x = 0; x < base.width; ++x) std::memcpy(&to[x * bytes], at(base, x, y), bytes);
}

} // namespace chiaro
