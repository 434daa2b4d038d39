#include "tools/report/pack.h"
#include "core/render/error.h"
#include <Imath/half.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <zlib.h>

namespace chiaro::report {
namespace {

int32_t asSigned(uint32_t v, int bits) noexcept {
    const uint32_t half = 1u << (bits - 1);
    return int32_t((v & (2 * half - 1)) ^ half) - int32_t(half);
}

int32_t predict(Predictor p, int32_t left, int32_t above, int32_t aboveLeft, int32_t aboveRight) noexcept {
    if (p == Predictor::mean) return (left + above + aboveLeft + aboveRight + 2) >> 2;
    if (aboveLeft >= std::max(left, above)) return std::min(left, above);
    if (aboveLeft <= std::min(left, above)) return std::max(left, above);
    return left + above - aboveLeft;
}

// Residuals as unsigned numbers, small ones first (0, -1, 1, -2, ...): all low bytes, then all high bytes. Outside the picture the nearest
// known neighbour stands in; before the first pixel that is 0.
void appendResiduals(std::string& out, const std::vector<uint16_t>& plane, uint32_t width, uint32_t height, int bits, Predictor p) {
    const std::size_t start = out.size(), n = plane.size();
    out.resize(start + (bits > 8 ? 2 : 1) * n);
    for (uint32_t y = 0; y < height; ++y) {
        const uint16_t* row = plane.data() + std::size_t(y) * width;
        const auto at = [&](const uint16_t* from, uint32_t x) { return asSigned(from[x], bits); };
        const uint16_t* up = row - width;
        for (uint32_t x = 0; x < width; ++x) {
            int32_t guess = 0;
            if (y == 0) {
                if (x > 0) guess = at(row, x - 1);
            } else {
                const int32_t above = at(up, x), left = x > 0 ? at(row, x - 1) : above;
                guess = predict(p, left, above, x > 0 ? at(up, x - 1) : above, x + 1 < width ? at(up, x + 1) : above);
            }
            const int32_t r = asSigned(uint32_t(int32_t(row[x]) - guess), bits);
            const uint32_t code = r < 0 ? uint32_t(-2 * r - 1) : uint32_t(2 * r);
            const std::size_t i = start + std::size_t(y) * width + x;
            out[i] = char(code & 255);
            if (bits > 8) out[i + n] = char(code >> 8);
        }
    }
}

std::string residuals(const Planes& p, Predictor predictor) {
    std::string out;
    for (const std::vector<uint16_t>& plane : p.planes) appendResiduals(out, plane, p.width, p.height, p.bits, predictor);
    return out;
}

std::string deflated(const std::string& raw) {
    z_stream z{};
    // Residuals: what Z_FILTERED is made for.
    if (deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS, 8, Z_FILTERED) != Z_OK)
        throw Error(Exit::resources, "the report: no memory left to compress pictures");
    std::string out;
    std::vector<char> block(std::size_t(1) << 18);
    const char* next = raw.data();
    std::size_t left = raw.size();
    for (int state = Z_OK; state != Z_STREAM_END;) {
        if (z.avail_in == 0) {
            const std::size_t some = std::min(left, std::size_t(1) << 30);
            z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(next)); // zlib's interface; it does not write there
            z.avail_in = uInt(some);
            next += some;
            left -= some;
        }
        z.next_out = reinterpret_cast<Bytef*>(block.data());
        z.avail_out = uInt(block.size());
        state = deflate(&z, left == 0 ? Z_FINISH : Z_NO_FLUSH);
        out.append(block.data(), block.size() - z.avail_out);
    }
    deflateEnd(&z);
    return out;
}

// Every eighth band of eight rows, as a smaller picture; the whole where that is little.
Planes sample(const Planes& p) {
    constexpr uint32_t band = 8, every = 64;
    if (p.height < 2 * every || std::size_t(p.width) * p.height < 100'000) return p;
    Planes out{p.width, 0, p.bits, std::vector<std::vector<uint16_t>>(p.planes.size())};
    for (uint32_t y = every / 2; y + band <= p.height; y += every) {
        for (std::size_t c = 0; c < p.planes.size(); ++c) {
            const auto from = p.planes[c].begin() + std::ptrdiff_t(std::size_t(y) * p.width);
            out.planes[c].insert(out.planes[c].end(), from, from + std::ptrdiff_t(std::size_t(band) * p.width));
        }
        out.height += band;
    }
    return out;
}

} // namespace

uint16_t toHalf(float v) noexcept { return imath_float_to_half(v); }
float fromHalf(uint16_t h) noexcept { return imath_half_to_float(h); }

uint16_t shortened(uint16_t half, int mantissa) noexcept {
    const int drop = 10 - mantissa;
    const uint32_t sign = half & 0x8000u, magnitude = half & 0x7fffu;
    if (drop == 0) return half;
    if (magnitude > 0x7c00u) return uint16_t((sign | 0x7e00u) >> drop);
    if (magnitude == 0x7c00u) return uint16_t(half >> drop);
    const uint32_t odd = (magnitude >> drop) & 1, rounded = (magnitude + (1u << (drop - 1)) - 1 + odd) >> drop;
    return uint16_t((sign >> drop) | std::min(rounded, (0x7c00u >> drop) - 1));
}

uint16_t lengthened(uint16_t code, int mantissa) noexcept { return uint16_t(code << (10 - mantissa)); }

Planes planesOf(std::span<const uint16_t> rgb, uint32_t width, uint32_t height, int mantissa) {
    const std::size_t n = std::size_t(width) * height;
    const int bits = 6 + mantissa;
    const uint32_t mask = (1u << bits) - 1;
    Planes out{width, height, bits, std::vector<std::vector<uint16_t>>(3, std::vector<uint16_t>(n))};
    for (std::size_t i = 0; i < n; ++i) {
        const uint32_t r = shortened(rgb[3 * i], mantissa), g = shortened(rgb[3 * i + 1], mantissa),
                       b = shortened(rgb[3 * i + 2], mantissa);
        out.planes[0][i] = uint16_t(g);
        out.planes[1][i] = uint16_t((r - g) & mask);
        out.planes[2][i] = uint16_t((b - g) & mask);
    }
    return out;
}

Planes planesOf(std::span<const float> map, uint32_t width, uint32_t height, double low, double high, int steps) {
    Planes out{width, height, 8, {std::vector<uint16_t>(std::size_t(width) * height)}};
    for (std::size_t i = 0; i < out.planes[0].size(); ++i) {
        const double t = (map[i] - low) / (high - low);
        const int code = std::isnan(t) ? -128 : int(std::lround((2 * std::clamp(t, 0.0, 1.0) - 1) * steps));
        out.planes[0][i] = uint16_t(code & 255);
    }
    return out;
}

std::size_t packedSize(const Planes& p) {
    const Planes part = sample(p);
    const std::size_t size =
        std::min(deflated(residuals(part, Predictor::mean)).size(), deflated(residuals(part, Predictor::median)).size());
    return part.height == 0 ? size : std::size_t(double(size) * p.height / part.height);
}

Packed pack(const Planes& p) {
    const Planes part = sample(p);
    const bool mean = deflated(residuals(part, Predictor::mean)).size() <= deflated(residuals(part, Predictor::median)).size();
    const Predictor predictor = mean ? Predictor::mean : Predictor::median;
    return {deflated(residuals(p, predictor)), predictor};
}

std::string asText(std::string_view bytes) {
    static const std::string letters = [] {
        std::string s;
        for (char c = '!'; c <= '~'; ++c)
            if (c != '<' && c != '&' && c != '\\') s += c;
        return s;
    }();
    std::string out;
    out.reserve(bytes.size() * 16 / 13 + 4);
    uint32_t held = 0;
    int count = 0;
    const auto emit = [&](uint32_t v) {
        out += letters[v % 91];
        out += letters[v / 91];
    };
    for (const char c : bytes) {
        held |= uint32_t(uint8_t(c)) << count;
        count += 8;
        if (count < 13) continue;
        emit(held & 8191);
        held >>= 13;
        count -= 13;
    }
    if (count > 0) emit(held);
    return out;
}

} // namespace chiaro::report
