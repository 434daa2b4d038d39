// Halves: every code by the format's own definition, rounding, and pictures that keep them.
#include "core/math/half.h"
#include "tests/core/texels.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <cmath>
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

// IEEE 754-2008, 3.4.
double defined(uint32_t code) {
    const int exponent = int(code >> 10 & 31), mantissa = int(code & 1023);
    const double size = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
    return code & 0x8000 ? -size : size;
}
bool isFinite(uint32_t code) { return (code >> 10 & 31) != 31; }

Textures one(ImageDesc image) {
    std::vector<ImageDesc> images;
    images.push_back(std::move(image));
    return {std::move(images), {{0, Wrap::repeat, Wrap::mirror, TextureFilter::linear}}};
}

} // namespace

TEST_SUITE("half") {
    TEST_CASE("every code is the number that the format defines, and comes back") {
        int wrong = 0;
        for (uint32_t code = 0; code < 65536; ++code) {
            const float v = halfToFloat(uint16_t(code));
            if (isFinite(code))
                wrong += double(v) != defined(code) || std::signbit(v) != (code >> 15 != 0) || floatToHalf(v) != code;
            else
                wrong +=
                    (code & 1023) ? !std::isnan(v) || !std::isnan(halfToFloat(floatToHalf(v))) : !std::isinf(v) || floatToHalf(v) != code;
        }
        CHECK(wrong == 0);
    }

    TEST_CASE("what lies between two goes to the nearer one, half way to the even one") {
        int wrong = 0;
        for (uint32_t code = 0; code < 0x7bff; ++code) {
            const double a = defined(code), b = defined(code + 1), middle = (a + b) / 2;
            const auto at = [](double v) { return uint32_t(floatToHalf(float(v))); };
            wrong += at(middle) != code + (code & 1);
            wrong += at(std::nextafter(float(middle), 0.f)) != code;
            wrong += at(std::nextafter(float(middle), 1e9f)) != code + 1;
            wrong += at(-middle) != (0x8000 | (code + (code & 1)));
        }
        CHECK(wrong == 0);
        CHECK(floatToHalf(65519.996f) == 0x7bff);
        CHECK(floatToHalf(65520.f) == 0x7c00);
        CHECK(floatToHalf(1e30f) == 0x7c00);
        CHECK(floatToHalf(1e-30f) == 0);
    }

    TEST_CASE("a picture of halves takes half the memory of one of floats and is read the same") {
        stats::Random u(3);
        for (int channels = 1; channels <= 4; ++channels)
            for (const auto& [width, height] : {std::pair{32, 32}, {13, 50}, {1, 9}}) {
                std::vector<uint16_t> codes;
                std::vector<float> values;
                for (int i = 0; i < width * height * channels; ++i) {
                    codes.push_back(floatToHalf(std::exp(12 * float(u()) - 6)));
                    values.push_back(halfToFloat(codes.back()));
                }
                ImageDesc image = imageOf(width, height, channels, codes);
                image.type = PixelType::f16;
                const Textures halves = one(std::move(image)), floats = one(imageOf(width, height, channels, values));
                CAPTURE(channels);
                CAPTURE(width);
                const TexelStore &h = halves.images()[0], &f = floats.images()[0];
                if (width > 1) CHECK(double(halves.bytes()) < 0.6 * double(floats.bytes()));
                int wrong = 0;
                for (const Transfer transfer : {Transfer::linear, Transfer::srgb}) {
                    REQUIRE(h.levels(transfer).size() == f.levels(transfer).size());
                    for (int i = 0; i < 200; ++i) {
                        const Point2 uv{float(u()) * 6 - 3, float(u()) * 6 - 3};
                        const Vec4 a = halves.lookup(0, uv, transfer), b = floats.lookup(0, uv, transfer);
                        wrong += !(a == b);
                    }
                    for (std::size_t level = 1; level < h.levels(transfer).size(); ++level) {
                        const MipLevel &to = h.levels(transfer)[level], &from = f.levels(transfer)[level];
                        for (uint32_t y = 0; y < to.height; ++y)
                            for (uint32_t x = 0; x < to.width; ++x) {
                                const Vec4 a = h.texel(to, x, y, transfer), b = f.texel(from, x, y, transfer);
                                for (const auto& [p, q] : {std::pair{a.x, b.x}, {a.y, b.y}, {a.z, b.z}, {a.w, b.w}})
                                    wrong += !(std::fabs(p - q) <= 0x1p-11f * q + 0x1p-25f);
                            }
                    }
                }
                CHECK(wrong == 0);
            }
    }
} // TEST_SUITE
