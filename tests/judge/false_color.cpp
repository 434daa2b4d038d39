// Signed false colour: ends, middle, symmetry, the choice of a scale, and the letters of the legend.
#include "tools/judge/false_color.h"
#include <cmath>
#include <doctest/doctest.h>
#include <limits>

using namespace chiaro::judge;

TEST_SUITE("false color") {
    TEST_CASE("sign and size can be read from the colour") {
        CHECK(signedColor(0) == Rgb8{238, 238, 238});
        CHECK(signedColor(1) == signedColor(7));
        CHECK(signedColor(-1) == signedColor(-7));
        CHECK(signedColor(std::numeric_limits<double>::quiet_NaN()) == notFiniteColor);
        int red = 0, blue = 0;
        for (const double t : {0.1, 0.3, 0.5, 0.7, 0.9}) {
            const Rgb8 a = signedColor(t), b = signedColor(-t);
            CHECK(a[0] > a[2]);
            CHECK(b[2] > b[0]);
            CHECK(a[0] - a[2] > red); // grows with the value
            CHECK(b[2] - b[0] > blue);
            red = a[0] - a[2];
            blue = b[2] - b[0];
        }
    }

    TEST_CASE("a scale with one digit") {
        const float nan = std::numeric_limits<float>::quiet_NaN();
        CHECK(niceScale(std::vector<float>{}) == 1);
        CHECK(niceScale(std::vector<float>{0, 0, nan}) == 1);
        CHECK(niceScale(std::vector<float>{0, -2}) == 2);
        CHECK(niceScale(std::vector<float>{0.1f}) == doctest::Approx(0.1));
        CHECK(niceScale(std::vector<float>{0.3f}) == doctest::Approx(0.5));
        CHECK(niceScale(std::vector<float>{6e5f, nan}) == doctest::Approx(1e6));
        std::vector<float> many(1000, 1.f);
        for (std::size_t i = 0; i < 5; ++i) many[i] = 1000; // fireflies do not decide
        CHECK(niceScale(many) == 1);
        CHECK(niceScale(many, 1) == 1000);
    }

    TEST_CASE("text keeps to its cells") {
        Canvas canvas(20, 9, paperColor);
        drawText(canvas, 1, 1, "1-", inkColor);
        CHECK(textWidth("1-") == 11);
        CHECK(textWidth("") == 0);
        std::size_t ink = 0;
        for (std::size_t i = 0; i < canvas.rgb.size(); i += 3) ink += canvas.rgb[i] == inkColor[0];
        CHECK(ink == 10 + 5); // the strokes of 1, and of the minus
        drawText(canvas, -30, -30, "outside", inkColor, 3);
        drawText(canvas, 15, 5, "\xc3\xa4", inkColor, 4); // cut, and boxes for what is not ASCII
    }

    TEST_CASE("text is counted and shortened by characters, whatever its bytes are") {
        CHECK(characters("K\xc3\xbc"
                         "che") == 5);
        CHECK(characters("\xff\xc3") == 2); // no UTF-8: a box a byte
        CHECK(textWidth("\xe4\xb8\xad") == glyphWidth);
        CHECK(shortened("path", 4) == "path");
        CHECK(shortened("photon", 4) == "pho\u2026");
        CHECK(shortened("\xc3\xbc\xc3\xbc\xc3\xbc", 2) == "\u00fc\u2026");
        CHECK(shortened("photon", 1) == "\u2026");
        CHECK(shortened("photon", 0).empty());
        const auto drawn = [](std::string_view text) {
            Canvas canvas(40, 30, paperColor);
            drawText(canvas, 2, 2, text, inkColor, 3);
            return canvas.rgb;
        };
        CHECK(drawn("\xc3\xa4") == drawn("a")); // without its accent
        CHECK(drawn("\xc3\x97") != drawn("\x01"));
        CHECK(drawn("\x01") == drawn("\xff"));
    }

    TEST_CASE("from scale 2 on letters are smooth, and no wider than their cells") {
        Canvas canvas(3 * (glyphWidth + 2), 3 * (glyphHeight + glyphDescent + 2), paperColor);
        drawText(canvas, 3, 3, "g", inkColor, 3);
        bool between = false;
        for (uint32_t y = 0; y < canvas.height; ++y)
            for (uint32_t x = 0; x < canvas.width; ++x) {
                const uint8_t v = canvas.rgb[3 * (y * canvas.width + x)];
                between |= v != inkColor[0] && v != paperColor[0];
                if (x < 3 || x >= 3 * (glyphWidth + 1) || y < 3 || y >= 3 * (glyphHeight + glyphDescent + 1)) CHECK(v == paperColor[0]);
            }
        CHECK(between);
    }

    TEST_CASE("pictures of a pixel and pictures of thousands have a legend") {
        for (const uint32_t width : {1u, 3000u}) {
            const std::vector<float> values(width, 1.f);
            const Canvas c = falseColor(values, {}, width, 1, 1, {"B brighter", "A brighter", "A - B"});
            CHECK(c.width >= width);
            CHECK(c.height > 30);
            CHECK(c.rgb.size() == std::size_t(c.width) * c.height * 3);
        }
    }
}
