// Pictures that OpenImageIO does not write, so that they are put together here byte by byte: palettes, few bits, ink, WebP of transparent
// colours.
#include "io/image_read.h"
#include "tests/io/gltf_builder.h"
#include <doctest/doctest.h>
#include <webp/encode.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

std::string big(uint32_t v) { return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; }

// PNG 3rd edition, 5.3 and annex D: length, type, data, CRC-32.
std::string chunk(const std::string& type, const std::string& data) {
    uint32_t crc = 0xffffffff;
    for (const char c : type + data) {
        crc ^= static_cast<unsigned char>(c);
        for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xedb88320 ^ crc >> 1 : crc >> 1;
    }
    return big(uint32_t(data.size())) + type + data + big(~crc);
}
// RFC 1950 and 1951: one stored block.
std::string stored(const std::string& raw) {
    uint32_t a = 1, b = 0;
    for (const char c : raw) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    const auto n = uint16_t(raw.size()), inverse = uint16_t(~n);
    return std::string("\x78\x01\x01", 3) + char(n) + char(n >> 8) + char(inverse) + char(inverse >> 8) + raw + big(b << 16 | a);
}
// rows: each begins with its filter, 0.
std::string pngOf(uint32_t width, uint32_t height, int depth, int kind, const std::string& rows, const std::string& between = {}) {
    const std::string header = big(width) + big(height) + char(depth) + char(kind) + std::string(3, '\0');
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + between + chunk("IDAT", stored(rows)) + chunk("IEND", "");
}

ImageDesc decode(const std::string& bytes) { return decodeImage({reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()}, "test"); }
std::vector<int> values(const ImageDesc& image) {
    std::vector<int> out;
    for (const std::byte b : image.pixels) out.push_back(std::to_integer<int>(b));
    return out;
}

} // namespace

TEST_SUITE("image_kinds") {
    TEST_CASE("PNG with a palette, with and without opacity") {
        const std::string palette = chunk("PLTE", std::string("\xff\0\0\0\xff\0\0\0\xff", 9));
        const ImageDesc plain = decode(pngOf(3, 1, 8, 3, std::string("\0\2\0\1", 4), palette));
        CHECK(plain.channels == 3);
        CHECK(plain.type == PixelType::u8);
        CHECK(values(plain) == std::vector{0, 0, 255, 255, 0, 0, 0, 255, 0});
        const ImageDesc clear = decode(pngOf(2, 1, 8, 3, std::string("\0\1\2", 3), palette + chunk("tRNS", "\xff\x80")));
        CHECK(clear.channels == 4);
        CHECK(values(clear) == std::vector{0, 255, 0, 128, 0, 0, 255, 255});
        const ImageDesc few = decode(pngOf(4, 1, 2, 3, std::string("\0\x18", 2), palette)); // 00 01 10 00
        CHECK(few.channels == 3);
        CHECK(values(few) == std::vector{255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 0, 0});
    }

    TEST_CASE("PNG of one bit, and of sixteen with opacity") {
        const ImageDesc one = decode(pngOf(8, 1, 1, 0, std::string("\0\xa1", 2)));
        CHECK(one.channels == 1);
        CHECK(values(one) == std::vector{255, 0, 255, 0, 0, 0, 0, 255});
        const ImageDesc deep = decode(pngOf(1, 1, 16, 6, std::string("\0\x12\x34\xff\xff\0\1\x80\0", 9)));
        REQUIRE(deep.type == PixelType::u16);
        uint16_t v[4];
        REQUIRE(deep.pixels.size() == sizeof v);
        std::memcpy(v, deep.pixels.data(), sizeof v);
        CHECK(v[0] == 0x1234); // not multiplied by alpha
        CHECK(v[1] == 0xffff);
        CHECK(v[2] == 1);
        CHECK(v[3] == 0x8000);
    }

    TEST_CASE("PNG whose bytes were damaged says so, and libpng says nothing") {
        std::string bytes = pngOf(8, 1, 1, 0, std::string("\0\xa1", 2));
        bytes[bytes.size() - 20] ^= 1; // in the pixels
        try {
            decode(bytes);
            FAIL("was decoded");
        } catch (const Error& e) { CHECK(std::string(e.what()).find("a checksum is wrong") != std::string::npos); }
    }

    TEST_CASE("JPEG in four inks becomes RGB") {
        // 8 x 8 pixels of cyan 0, magenta 204, yellow 102, black 51 of 255, inverted as Adobe stores them.
        const unsigned char inks[] = {
            0xff, 0xd8, 0xff, 0xee, 0x00, 0x0e, 0x41, 0x64, 0x6f, 0x62, 0x65, 0x00, 0x64, 0x00, 0x00, 0x00, 0x00, 0x00, 0xff, 0xdb,
            0x00, 0x43, 0x00, 0x02, 0x01, 0x01, 0x01, 0x01, 0x01, 0x02, 0x01, 0x01, 0x01, 0x02, 0x02, 0x02, 0x02, 0x02, 0x04, 0x03,
            0x02, 0x02, 0x02, 0x02, 0x05, 0x04, 0x04, 0x03, 0x04, 0x06, 0x05, 0x06, 0x06, 0x06, 0x05, 0x06, 0x06, 0x06, 0x07, 0x09,
            0x08, 0x06, 0x07, 0x09, 0x07, 0x06, 0x06, 0x08, 0x0b, 0x08, 0x09, 0x0a, 0x0a, 0x0a, 0x0a, 0x0a, 0x06, 0x08, 0x0b, 0x0c,
            0x0b, 0x0a, 0x0c, 0x09, 0x0a, 0x0a, 0x0a, 0xff, 0xc0, 0x00, 0x14, 0x08, 0x00, 0x08, 0x00, 0x08, 0x04, 0x43, 0x11, 0x00,
            0x4d, 0x11, 0x00, 0x59, 0x11, 0x00, 0x4b, 0x11, 0x00, 0xff, 0xc4, 0x00, 0x15, 0x00, 0x01, 0x01, 0x00, 0x00, 0x00, 0x00,
            0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x09, 0x07, 0xff, 0xc4, 0x00, 0x14, 0x10, 0x01, 0x00, 0x00,
            0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xff, 0xda, 0x00, 0x0e, 0x04, 0x43,
            0x00, 0x4d, 0x00, 0x59, 0x00, 0x4b, 0x00, 0x00, 0x3f, 0x00, 0x7f, 0x06, 0x5a, 0xc8, 0x4c, 0x1f, 0xff, 0xd9};
        const ImageDesc image = decode({reinterpret_cast<const char*>(inks), sizeof inks});
        CHECK(image.width == 8);
        REQUIRE(image.channels == 3);
        const std::vector<int> v = values(image);
        CHECK(std::abs(v[0] - 204) <= 3);
        CHECK(std::abs(v[1] - 41) <= 3);
        CHECK(std::abs(v[2] - 122) <= 3);
    }

    TEST_CASE("WebP keeps its colours where it is transparent") {
        const uint8_t pixels[] = {200, 100, 50, 0, 10, 20, 30, 255};
        WebPConfig config;
        REQUIRE(WebPConfigInit(&config));
        REQUIRE(WebPConfigLosslessPreset(&config, 0));
        config.exact = 1;
        WebPPicture picture;
        REQUIRE(WebPPictureInit(&picture));
        picture.use_argb = 1;
        picture.width = 2;
        picture.height = 1;
        WebPMemoryWriter writer;
        WebPMemoryWriterInit(&writer);
        picture.writer = WebPMemoryWrite;
        picture.custom_ptr = &writer;
        REQUIRE(WebPPictureImportRGBA(&picture, pixels, 8));
        REQUIRE(WebPEncode(&config, &picture));
        const std::string bytes(reinterpret_cast<const char*>(writer.mem), writer.size);
        WebPMemoryWriterClear(&writer);
        WebPPictureFree(&picture);
        const ImageDesc image = decode(bytes);
        CHECK(image.channels == 4);
        CHECK(values(image) == std::vector{200, 100, 50, 0, 10, 20, 30, 255});
        CHECK_THROWS_AS(decode(bytes.substr(0, bytes.size() - 4)), Error);
    }
}
