#include "tools/report/pack.h"
#include "tests/report/unpack.h"
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <random>

using namespace chiaro;
using namespace chiaro::report;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
bool isNan(uint16_t h) { return (h & 0x7fff) > 0x7c00; }

// Halves of a picture with noise, black, negative values and everything that is not finite.
std::vector<uint16_t> someHalves(uint32_t width, uint32_t height) {
    std::mt19937 random(7);
    std::vector<uint16_t> out;
    for (std::size_t i = 0; i < std::size_t(width) * height * 3; ++i) {
        const float noise = 0.5f + float(random() % 1000) / 1000;
        out.push_back(i % 97 == 0 ? uint16_t(random()) : i % 7 == 0 ? 0 : toHalf(noise * float(1 + i % 3)));
    }
    return out;
}

std::vector<uint16_t> roundTrip(const std::vector<uint16_t>& halves, uint32_t width, uint32_t height, int mantissa) {
    const Packed packed = pack(planesOf(halves, width, height, mantissa));
    const std::string bytes = test::fromText(asText(packed.bytes), packed.bytes.size());
    CHECK(bytes == packed.bytes);
    const int bits = 6 + mantissa, mask = (1 << bits) - 1;
    const auto planes = test::planesFrom(test::inflated(bytes), width, height, bits, 3, int(packed.predictor));
    std::vector<uint16_t> out;
    for (std::size_t i = 0; i < planes[0].size(); ++i)
        for (const int code : {planes[0][i] + planes[1][i], planes[0][i], planes[0][i] + planes[2][i]})
            out.push_back(lengthened(uint16_t(code & mask), mantissa));
    return out;
}

} // namespace

TEST_SUITE("report") {

    TEST_CASE("every half is a float and comes back") {
        int wrong = 0;
        for (uint32_t h = 0; h < 65536; ++h) {
            const int exponent = int(h >> 10 & 31), mantissa = int(h & 1023);
            const double sign = h & 0x8000 ? -1 : 1;
            const float value = fromHalf(uint16_t(h));
            if (exponent == 31) {
                wrong += mantissa ? !std::isnan(value) : value != float(sign) * infinity;
                wrong += mantissa ? !isNan(toHalf(value)) : toHalf(value) != h;
            } else {
                const double expected = sign * (exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25));
                wrong += value != expected || toHalf(value) != h;
            }
        }
        CHECK(wrong == 0);
    }

    TEST_CASE("floats between two halves go to the nearer, ties to the even one") {
        int wrong = 0;
        for (uint32_t h = 0; h < 0x7bff; ++h) {
            const float low = fromHalf(uint16_t(h)), high = fromHalf(uint16_t(h + 1)), middle = 0.5f * (low + high);
            wrong += toHalf(middle) != (h & 1 ? h + 1 : h);
            wrong += toHalf(std::nextafter(middle, low)) != h;
            wrong += toHalf(std::nextafter(middle, high)) != h + 1;
        }
        CHECK(wrong == 0);
        CHECK(toHalf(65519.9f) == 0x7bff);
        CHECK(toHalf(65520.0f) == 0x7c00);
        CHECK(toHalf(std::numeric_limits<float>::max()) == 0x7c00);
        CHECK(toHalf(-infinity) == 0xfc00);
        CHECK(isNan(toHalf(std::numeric_limits<float>::quiet_NaN())));
        CHECK(toHalf(-0.0f) == 0x8000);
    }

    TEST_CASE("shortened halves are off by half a step at most; finite stays finite, NaN stays NaN") {
        for (int mantissa = 5; mantissa <= 10; ++mantissa) {
            int wrong = 0;
            for (uint32_t h = 0; h < 65536; ++h) {
                const uint16_t back = lengthened(shortened(uint16_t(h), mantissa), mantissa);
                if (isNan(uint16_t(h)))
                    wrong += !isNan(back);
                else if ((h & 0x7fff) == 0x7c00)
                    wrong += back != h;
                else {
                    wrong += (back & 0x7c00) == 0x7c00 || (back & 0x8000) != (h & 0x8000);
                    const uint32_t magnitude = h & 0x7fff, last = (0x7c00u >> (10 - mantissa) << (10 - mantissa)) - (1u << (10 - mantissa));
                    if (magnitude <= last) wrong += 2 * std::abs(int(back) - int(h)) > 1 << (10 - mantissa);
                }
            }
            CHECK_MESSAGE(wrong == 0, mantissa);
        }
    }

    TEST_CASE("pictures come back bit for bit") {
        for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 9u}, {9u, 1u}, {2u, 2u}, {37u, 23u}, {400u, 300u}}) {
            const std::vector<uint16_t> halves = someHalves(width, height);
            CHECK(roundTrip(halves, width, height, 10) == halves);
            for (int mantissa = 5; mantissa < 10; ++mantissa) {
                std::vector<uint16_t> expected;
                for (const uint16_t h : halves) expected.push_back(lengthened(shortened(h, mantissa), mantissa));
                CHECK(roundTrip(halves, width, height, mantissa) == expected);
            }
        }
    }

    TEST_CASE("a clean picture is predicted by the median, a noisy one by the mean") {
        std::vector<uint16_t> clean, noisy;
        std::mt19937 random(3);
        for (uint32_t y = 0; y < 200; ++y)
            for (uint32_t x = 0; x < 200; ++x)
                for (int c = 0; c < 3; ++c) {
                    clean.push_back(toHalf(x < 90 ? float(1 + y) * 0.125f : 0.01f * float(x)));
                    noisy.push_back(toHalf(1 + float(random() % 997) / 997));
                }
        CHECK(pack(planesOf(clean, 200, 200, 10)).predictor == Predictor::median);
        CHECK(pack(planesOf(noisy, 200, 200, 10)).predictor == Predictor::mean);
        CHECK(roundTrip(clean, 200, 200, 10) == clean);
        const Planes planes = planesOf(noisy, 200, 200, 10);
        CHECK(double(packedSize(planes)) == doctest::Approx(double(pack(planes).bytes.size())).epsilon(0.03));
    }

    TEST_CASE("maps: ends, middle, beyond the ends and NaN") {
        const std::vector<float> map{-6, 6, 0, -100, infinity, std::numeric_limits<float>::quiet_NaN(), 3};
        const Planes p = planesOf(map, 7, 1, -6, 6, 127);
        const auto code = [&](std::size_t i) { return int(int8_t(p.planes[0][i])); };
        CHECK(code(0) == -127);
        CHECK(code(1) == 127);
        CHECK(code(2) == 0);
        CHECK(code(3) == -127);
        CHECK(code(4) == 127);
        CHECK(code(5) == -128);
        CHECK(code(6) == 64);
    }

    TEST_CASE("text holds no character that means something to HTML") {
        std::string all;
        for (int i = 0; i < 65536; ++i) all += char(i * 2654435761u >> 13);
        const std::string text = asText(all);
        CHECK(text.find_first_of("<&\\ \n\r\t") == std::string::npos);
        CHECK(test::fromText(text, all.size()) == all);
        CHECK(text.size() <= all.size() * 16 / 13 + 2);
        CHECK(asText("").empty());
        for (std::size_t n = 1; n < 20; ++n) CHECK(test::fromText(asText(all.substr(0, n)), n) == all.substr(0, n));
    }
}
