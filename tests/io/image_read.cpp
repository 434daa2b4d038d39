// Pictures arrive as stored: depth, channels, alpha, no colour conversion; environments as linear radiance.
#include "io/image_read.h"
#include "tests/io/gltf_builder.h"
#include "tests/io/gltf_pictures.h"
#include <cmath>
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

ImageDesc decode(const std::string& bytes) { return decodeImage({reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()}, "test"); }

template <class T> std::vector<T> values(const ImageDesc& image) {
    std::vector<T> out(image.pixels.size() / sizeof(T));
    std::memcpy(out.data(), image.pixels.data(), image.pixels.size());
    return out;
}

std::string message(const std::string& bytes) {
    try {
        decode(bytes);
    } catch (const Error& e) {
        CHECK(e.code == Exit::file);
        return e.what();
    }
    return "";
}

} // namespace

TEST_SUITE("image_read") {
    TEST_CASE("8 and 16 bits, half and float keep their depth") {
        const ImageDesc a = decode(picture("png", 2, 1, 3, OIIO::TypeDesc::UINT8, {0, 1, 51 / 255.f, 10 / 255.f, 20 / 255.f, 30 / 255.f}));
        CHECK(a.type == PixelType::u8);
        CHECK(a.width == 2);
        CHECK(a.height == 1);
        CHECK(a.channels == 3);
        CHECK(values<uint8_t>(a) == std::vector<uint8_t>{0, 255, 51, 10, 20, 30});
        const ImageDesc b = decode(picture("png", 1, 2, 1, OIIO::TypeDesc::UINT16, {1000 / 65535.f, 1}));
        CHECK(b.type == PixelType::u16);
        CHECK(b.channels == 1);
        CHECK(values<uint16_t>(b) == std::vector<uint16_t>{1000, 65535});
        const ImageDesc c = decode(picture("exr", 1, 1, 3, OIIO::TypeDesc::HALF, {0.25f, -2, 1000}));
        CHECK(c.type == PixelType::f16);
        CHECK(values<uint16_t>(c) == std::vector<uint16_t>{0x3400, 0xc000, 0x63d0});
        const ImageDesc d = decode(picture("exr", 1, 1, 3, OIIO::TypeDesc::FLOAT, {0.1f, 1e-20f, 1e20f}));
        CHECK(values<float>(d) == std::vector<float>{0.1f, 1e-20f, 1e20f});
        const ImageDesc e = decode(picture("tif", 1, 1, 3, OIIO::TypeDesc::FLOAT, {0.1f, 2, 3}));
        CHECK(values<float>(e) == std::vector<float>{0.1f, 2, 3});
        const std::string half = picture("exr", 5, 4, 3, OIIO::TypeDesc::HALF), whole = picture("exr", 5, 4, 3, OIIO::TypeDesc::FLOAT);
        const auto bytes = [](const std::string& s) {
            return pictureSize({reinterpret_cast<const std::byte*>(s.data()), s.size()}, "").bytes;
        };
        CHECK(bytes(half) == 120);
        CHECK(bytes(whole) == 240);
    }

    TEST_CASE("alpha is not multiplied into the colour") {
        OIIO::ImageSpec spec;
        spec["oiio:UnassociatedAlpha"] = 1;
        for (const std::string format : {"png", "tif", "tga"}) {
            CAPTURE(format);
            const std::string bytes =
                picture(format, 1, 1, 4, OIIO::TypeDesc::UINT8, {200 / 255.f, 100 / 255.f, 50 / 255.f, 128 / 255.f}, spec);
            const ImageDesc image = decodeImage({reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()}, "a." + format);
            REQUIRE(image.channels == 4);
            const auto v = values<uint8_t>(image);
            CAPTURE(int(v[0]));
            CHECK(std::abs(v[0] - 200) <= 1);
            CHECK(std::abs(v[1] - 100) <= 1);
            CHECK(v[3] == 128);
        }
        // OpenImageIO's WebP writer divides by alpha in linear light: 100 / 255 at alpha 128 / 255 is stored as 137.
        spec["compression"] = "lossless";
        const ImageDesc webp =
            decode(picture("webp", 1, 1, 4, OIIO::TypeDesc::UINT8, {100 / 255.f, 100 / 255.f, 100 / 255.f, 128 / 255.f}, spec));
        CHECK(std::abs(values<uint8_t>(webp)[0] - 137) <= 2);
        CHECK(values<uint8_t>(webp)[3] == 128);
        const std::string grey = picture("png", 1, 1, 2, OIIO::TypeDesc::UINT8, {100 / 255.f, 51 / 255.f}, spec);
        CHECK(values<uint8_t>(decode(grey)) == std::vector<uint8_t>{100, 51});
    }

    TEST_CASE("more than four channels: RGB and alpha by name; row 0 is the top") {
        OIIO::ImageSpec spec;
        const std::string bytes = picture("exr", 1, 2, 6, OIIO::TypeDesc::FLOAT, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, spec);
        const ImageDesc image = decode(bytes);
        CHECK(image.channels == 4);
        CHECK(values<float>(image) == std::vector<float>{1, 2, 3, 4, 7, 8, 9, 10});
    }

    TEST_CASE("JPEG, BMP, HDR by content, whatever the name") {
        for (const std::string format : {"jpg", "bmp", "hdr", "tga"}) {
            CAPTURE(format);
            const std::string bytes =
                picture(format, 16, 8, 3, format == "hdr" ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8, std::vector<float>(384, 0.5f));
            const std::string name = format == "tga" ? "x.tga" : "wrong.png";
            const ImageDesc image = decodeImage({reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()}, name);
            CHECK(image.width == 16);
            CHECK(image.height == 8);
            CHECK(image.channels == 3);
            if (format == "hdr")
                CHECK(values<float>(image)[0] == doctest::Approx(0.5).epsilon(0.01));
            else
                CHECK(std::abs(values<uint8_t>(image)[0] - 128) <= 1);
        }
    }

    TEST_CASE("errors name the picture") {
        CHECK(message("") == "test: cannot be decoded (it is empty). Mend the picture or save it again.");
        CHECK(message("hello there, no picture").find("no known picture format") != std::string::npos);
        const std::string whole = png(64, 64, 3);
        CHECK(message(whole.substr(0, whole.size() / 2)).find("truncated") != std::string::npos);
        CHECK_THROWS_AS(readImage("/no/such/picture.png"), Error);
    }

    TEST_CASE("environments: linear f32 RGB; bad texels become 0 and are counted") {
        const Folder folder("env");
        Diagnostics notes;
        const std::vector<float> raw = {1, 2, 3, NAN, 5, 6, INFINITY, 8, 9, -1, 11, 12};
        const EnvironmentDesc exr = readEnvironment(folder.write("a.exr", picture("exr", 4, 1, 3, OIIO::TypeDesc::FLOAT, raw)), notes);
        CHECK(exr.image.channels == 3);
        CHECK(exr.image.type == PixelType::f32);
        CHECK(values<float>(exr.image) == std::vector<float>{1, 2, 3, 0, 5, 6, 0, 8, 9, 0, 11, 12});
        CHECK(warns(notes, "3 texels are negative or not finite"));
        const EnvironmentDesc half = readEnvironment(folder.write("h.exr", picture("exr", 4, 1, 3, OIIO::TypeDesc::HALF, raw)), notes);
        CHECK(values<float>(half.image) == values<float>(exr.image));
        const EnvironmentDesc ldr =
            readEnvironment(folder.write("b.png", picture("png", 1, 1, 1, OIIO::TypeDesc::UINT8, {188 / 255.f})), notes);
        const auto v = values<float>(ldr.image);
        REQUIRE(v.size() == 3);
        CHECK(v[0] == doctest::Approx(0.5029).epsilon(0.001));
        CHECK(v[2] == v[0]);
        CHECK(notes.warnings().size() == 2);
        CHECK(exr.scale == 1);
    }
}
