#include "tests/report/unpack.h"
#include "tools/report/pack.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <zlib.h>

namespace chiaro::test {

std::string fromText(std::string_view text, std::size_t bytes) {
    std::vector<char> bits;
    const auto value = [](char c) {
        int v = 0;
        for (char k = '!'; k < c; ++k) v += k != '<' && k != '&' && k != '\\';
        return v;
    };
    for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
        const int v = value(text[i]) + 91 * value(text[i + 1]);
        for (int b = 0; b < 13; ++b) bits.push_back(char(v >> b & 1));
    }
    std::string out(bytes, '\0');
    for (std::size_t i = 0; i < bytes; ++i)
        for (std::size_t b = 0; b < 8; ++b) out[i] = char(uint8_t(out[i]) | int(bits.at(8 * i + b)) << b);
    return out;
}

std::string inflated(const std::string& bytes) {
    for (uLongf size = uLongf(bytes.size()) * 8 + 1000;; size *= 4) {
        std::string out(size, '\0');
        uLongf written = size;
        const int state =
            uncompress(reinterpret_cast<Bytef*>(out.data()), &written, reinterpret_cast<const Bytef*>(bytes.data()), uLong(bytes.size()));
        if (state == Z_BUF_ERROR) continue;
        if (state != Z_OK) throw std::runtime_error("not deflated");
        out.resize(written);
        return out;
    }
}

std::vector<std::vector<int32_t>> planesFrom(const std::string& raw, uint32_t width, uint32_t height, int bits, int count, int predictor) {
    const std::size_t n = std::size_t(width) * height;
    std::vector<std::vector<int32_t>> out;
    const auto wrapped = [&](int32_t v) {
        const int32_t range = 1 << bits;
        v = ((v % range) + range) % range;
        return v >= range / 2 ? v - range : v;
    };
    std::size_t start = 0;
    for (int c = 0; c < count; ++c, start += (bits > 8 ? 2 : 1) * n) {
        std::vector<int32_t> p(n);
        const auto at = [&](uint32_t x, uint32_t y) { return p[std::size_t(y) * width + x]; };
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                const std::size_t i = std::size_t(y) * width + x;
                int code = uint8_t(raw.at(start + i));
                if (bits > 8) code += 256 * uint8_t(raw.at(start + n + i));
                const int32_t residual = code % 2 == 1 ? -(code + 1) / 2 : code / 2;
                int32_t guess = 0;
                if (y == 0) {
                    if (x > 0) guess = at(x - 1, 0);
                } else {
                    const int32_t a = at(x, y - 1), l = x > 0 ? at(x - 1, y) : a, al = x > 0 ? at(x - 1, y - 1) : a,
                                  ar = x + 1 < width ? at(x + 1, y - 1) : a;
                    guess = predictor == 0 ? int32_t(std::floor((l + a + al + ar + 2) / 4.0))
                                           : std::max(std::min(l, a), std::min(std::max(l, a), l + a - al)); // the median of three
                }
                p[i] = wrapped(guess + residual);
            }
        out.push_back(std::move(p));
    }
    return out;
}

std::string Page::block(int number) const {
    const std::string open = "<script type=\"text/plain\" id=\"block" + std::to_string(number) + "\">";
    const std::size_t at = text.find(open);
    if (at == std::string::npos) throw std::runtime_error("no such block");
    const std::size_t start = at + open.size();
    return text.substr(start, text.find('<', start) - start);
}

std::string Page::withoutBlocks() const {
    const std::size_t first = text.find("<script type=\"text/plain\""), script = text.find("<script type=\"module\"");
    return first == std::string::npos ? text : text.substr(0, first) + text.substr(script);
}

std::vector<float> Page::picture(const nlohmann::json& image) const {
    const uint32_t width = image["width"], height = image["height"];
    const int mantissa = data["mantissa"], mask = (1 << (6 + mantissa)) - 1;
    const std::string raw = inflated(fromText(block(image["block"]), image["bytes"]));
    const auto planes = planesFrom(raw, width, height, 6 + mantissa, 3, image["predictor"]);
    std::vector<float> out;
    const double unit = std::ldexp(1.0, int(data["exponent"]));
    for (std::size_t i = 0; i < planes[0].size(); ++i) {
        const int g = planes[0][i];
        for (const int code : {g + planes[1][i], g, g + planes[2][i]})
            out.push_back(float(report::fromHalf(uint16_t((code & mask) << (10 - mantissa))) * unit));
    }
    return out;
}

std::vector<double> Page::map(const nlohmann::json& map) const {
    const std::string raw = inflated(fromText(block(map["block"]), map["bytes"]));
    const double low = map["low"], high = map["high"], steps = data["mapSteps"];
    std::vector<double> out;
    const auto planes = planesFrom(raw, map["width"], map["height"], 8, 1, map["predictor"]);
    for (const int32_t code : planes[0])
        out.push_back(code == -128 ? std::numeric_limits<double>::quiet_NaN() : low + (high - low) * (code + steps) / (2 * steps));
    return out;
}

Page pageFrom(std::string text) {
    const std::string open = "id=\"data\">";
    const std::size_t start = text.find(open) + open.size(), end = text.find("</script>", start);
    Page page{std::move(text), {}};
    page.data = nlohmann::json::parse(page.text.substr(start, end - start));
    return page;
}

} // namespace chiaro::test
