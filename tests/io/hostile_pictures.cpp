// Pictures that fuzzing found to do harm, made again here: each is an Error, in no time and without memory.
#include "io/image_read.h"
#include "tests/io/gltf_builder.h"
#include "tests/io/gltf_pictures.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

std::string message(const std::string& bytes) {
    try {
        decodeImage({reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()}, "test");
    } catch (const Error& e) { return e.what(); }
    return {};
}
std::string exr(const char* compression) {
    OIIO::ImageSpec spec;
    spec["compression"] = compression;
    return picture("exr", 5, 4, 3, OIIO::TypeDesc::HALF, {}, spec);
}
// Where the value of an attribute begins: behind its name, its type and its size.
size_t valueOf(const std::string& file, const std::string& name, const std::string& type) {
    const std::string begin = name + '\0' + type + '\0';
    const size_t at = file.find(begin);
    REQUIRE(at != std::string::npos);
    return at + begin.size() + 4;
}

} // namespace

TEST_SUITE("hostile_pictures") {
    TEST_CASE("an OpenEXR of a few hundred bytes that says it has millions of lines") {
        const std::string whole = exr("zips");
        CHECK(message(whole).empty());
        for (const char* window : {"dataWindow", "displayWindow"}) {
            std::string bad = whole;
            bad.replace(valueOf(bad, window, "box2i") + 12, 4, u32(100'000'000)); // 5 x 100,000,001
            CHECK_MESSAGE(message(bad).find("the limit is") != std::string::npos, message(bad));
            bad = whole;
            bad.replace(valueOf(bad, window, "box2i") + 12, 4, u32(20'000'000));
            CHECK_MESSAGE(message(bad).find("more than its") != std::string::npos, message(bad));
            bad.replace(valueOf(bad, window, "box2i") + 12, 4, u32(0x80000000));
            CHECK_MESSAGE(message(bad).find("the limit is") != std::string::npos, message(bad));
        }
    }

    TEST_CASE("an OpenEXR whose blocks lie before its beginning") {
        for (const char* compression : {"none", "zips", "piz", "dwaa"}) {
            std::string bad = exr(compression);
            // The table of blocks begins behind the header, with the place where the table ends.
            size_t table = bad.size();
            for (size_t at = 8; at + 8 <= bad.size() && table == bad.size(); ++at) {
                uint64_t first = 0;
                std::memcpy(&first, &bad[at], 8);
                if (first == at + 8 || first == at + 32) table = at;
            }
            REQUIRE(table < bad.size());
            for (const unsigned char last : {0xff, 0x80, 0x7f}) {
                std::string moved = bad;
                moved.replace(table, 8, std::string(7, '\xf0') + char(last));
                message(moved); // a reader may find the lines without their table
            }
        }
    }

    TEST_CASE("an OpenEXR that ends inside its header, at every byte") {
        const std::string whole = exr("zip");
        for (size_t n = 5; n < 300; ++n) CHECK_FALSE(message(whole.substr(0, n)).empty());
    }
}
