// Texture look-ups: rows K1, K3 and K4 of the verification table, wrap modes, filters, pixel types.
#include "core/scene/texture.h"
#include "tests/core/texels.h"
#include "tests/scene_kit.h"
#include <cstring>
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

Textures one(ImageDesc i, TextureFilter filter = TextureFilter::nearest, Wrap s = Wrap::repeat, Wrap t = Wrap::repeat) {
    std::vector<ImageDesc> images;
    images.push_back(std::move(i));
    return {std::move(images), {{0, s, t, filter}}};
}
using Bytes = std::vector<uint8_t>;
float red(const Textures& t, float u, float v, Transfer transfer = Transfer::linear) { return t.lookup(0, {u, v}, transfer).x; }

} // namespace

TEST_SUITE("texture") {

    TEST_CASE("K1: sRGB, both ways") {
        const double encode[][2] = {{.001, .01292}, {.0031308, .04045}, {.01, .0998527}, {.18, .4613561}, {.5, .7353570}, {1, 1}, {0, 0}};
        for (const auto& [linear, encoded] : encode) {
            CHECK(double(linearToSrgb(float(linear))) == doctest::Approx(encoded).epsilon(1e-5));
            CHECK(double(srgbToLinear(float(encoded))) == doctest::Approx(linear).epsilon(1e-5));
        }
        const double decode[][2] = {{10, .0030352698},  {11, .0033465358},  {64, .0512694584}, {128, .2158605001},
                                    {188, .5028864580}, {192, .5271151257}, {255, 1},          {0, 0}};
        for (const auto& [byte, linear] : decode) {
            const Textures t = one(imageOf<uint8_t>(1, 1, 3, Bytes(3, uint8_t(byte))));
            CHECK(double(red(t, .5f, .5f, Transfer::srgb)) == doctest::Approx(linear).epsilon(1e-5));
            CHECK(double(red(t, .5f, .5f)) == doctest::Approx(byte / 255).epsilon(1e-6)); // roughness 128: .502
        }
    }

    TEST_CASE("K3: filtered after decoding") {
        const Textures t = one(imageOf<uint8_t>(2, 1, 1, {0, 255}), TextureFilter::linear, Wrap::clamp);
        CHECK(red(t, .5f, .5f, Transfer::srgb) == doctest::Approx(.5));
    }

    TEST_CASE("K4: texel centres, row order") {
        const Textures t = one(imageOf<uint8_t>(2, 1, 1, {0, 255}), TextureFilter::linear);
        CHECK(red(t, .25f, .3f) == 0);
        CHECK(red(t, .75f, .3f) == 1);
        CHECK(red(t, .5f, .9f) == doctest::Approx(.5));
        CHECK(red(t, 0, .9f) == doctest::Approx(.5));
        CHECK(red(t, 1, .1f) == doctest::Approx(.5));
        const Textures rows = one(imageOf<uint8_t>(1, 4, 1, {0, 85, 170, 255}));
        for (int i = 0; i < 4; ++i) CHECK(red(rows, .5f, (float(i) + .5f) / 4) == doctest::Approx(i / 3.0));
    }

    TEST_CASE("wrap modes near, below and far from the picture") {
        const struct {
            Wrap mode;
            float u;
            int texel; // of 0 1 2 3
        } cases[] = {
            {Wrap::repeat, -0.125f, 3},    {Wrap::repeat, 1.125f, 0},   {Wrap::repeat, -7.375f, 2}, {Wrap::repeat, 1000.625f, 2},
            {Wrap::repeat, 70000.375f, 1}, {Wrap::repeat, 1e30f, 0},    {Wrap::mirror, -0.125f, 0}, {Wrap::mirror, 1.125f, 3},
            {Wrap::mirror, 1.875f, 0},     {Wrap::mirror, 2.375f, 1},   {Wrap::mirror, -1.375f, 2}, {Wrap::mirror, 65537.125f, 3},
            {Wrap::mirror, -1e9f, 0},      {Wrap::clamp, -0.125f, 0},   {Wrap::clamp, -1e30f, 0},   {Wrap::clamp, 1.125f, 3},
            {Wrap::clamp, 65536.25f, 3},   {Wrap::clamp, 70000.25f, 3}, {Wrap::clamp, 1e30f, 3},    {Wrap::clamp, 0.625f, 2},
        };
        for (const auto& k : cases) {
            CAPTURE(int(k.mode));
            CAPTURE(k.u);
            const Bytes texels = {0, 85, 170, 255};
            CHECK(red(one(imageOf(4, 1, 1, texels), TextureFilter::nearest, k.mode), k.u, .5f) == doctest::Approx(k.texel / 3.0));
            CHECK(red(one(imageOf(1, 4, 1, texels), TextureFilter::nearest, Wrap::repeat, k.mode), .5f, k.u) ==
                  doctest::Approx(k.texel / 3.0));
        }
        // Between the last texel and what lies beyond the border, half a texel each.
        const Bytes texels = {0, 85, 170, 255};
        CHECK(red(one(imageOf(4, 1, 1, texels), TextureFilter::linear, Wrap::repeat), 1, .5f) == doctest::Approx(.5));
        CHECK(red(one(imageOf(4, 1, 1, texels), TextureFilter::linear, Wrap::mirror), 1, .5f) == doctest::Approx(1));
        CHECK(red(one(imageOf(4, 1, 1, texels), TextureFilter::linear, Wrap::clamp), 0, .5f) == 0);
        CHECK(red(one(imageOf(4, 1, 1, texels), TextureFilter::linear, Wrap::mirror), -0.25f, .5f) == doctest::Approx(0.5 / 3));
    }

    TEST_CASE("nearest takes one texel, linear blends four") {
        const ImageDesc checker = imageOf<uint8_t>(2, 2, 1, {0, 255, 255, 0});
        const Textures nearest = one(checker), linear = one(checker, TextureFilter::linear);
        CHECK(red(nearest, .49f, .49f) == 0);
        CHECK(red(nearest, .51f, .49f) == 1);
        CHECK(red(linear, .5f, .5f) == doctest::Approx(.5));
        CHECK(red(linear, .375f, .25f) == doctest::Approx(.25));
        CHECK(red(linear, .375f, .375f) == doctest::Approx(.25 * .75 * 2));
    }

    TEST_CASE("pixel types and channels") {
        const auto check = [](const Textures& t, Transfer transfer, const Vec4& expected) {
            const Vec4 v = t.lookup(0, {.5f, .5f}, transfer);
            CHECK(v.x == doctest::Approx(expected.x));
            CHECK(v.y == doctest::Approx(expected.y));
            CHECK(v.z == doctest::Approx(expected.z));
            CHECK(v.w == doctest::Approx(expected.w));
        };
        const float s = srgbToLinear(51 / 255.f), a = 0.2f; // 51/255 = 0.2; alpha is linear always
        for (const TextureFilter f : {TextureFilter::nearest, TextureFilter::linear}) {
            check(one(imageOf<uint8_t>(1, 1, 1, {51}), f), Transfer::srgb, {s, s, s, 1});
            check(one(imageOf<uint8_t>(1, 1, 2, {51, 51}), f), Transfer::srgb, {s, s, s, a});
            check(one(imageOf<uint8_t>(1, 1, 3, {51, 0, 255}), f), Transfer::srgb, {s, 0, 1, 1});
            check(one(imageOf<uint8_t>(1, 1, 4, {51, 0, 255, 51}), f), Transfer::srgb, {s, 0, 1, a});
            check(one(imageOf<uint8_t>(1, 1, 4, {51, 0, 255, 51}), f), Transfer::linear, {a, 0, 1, a});
            check(one(imageOf<uint16_t>(1, 1, 1, {13107}), f), Transfer::srgb, {s, s, s, 1});
            check(one(imageOf<uint16_t>(1, 1, 2, {13107, 13107}), f), Transfer::linear, {a, a, a, a});
            check(one(imageOf<uint16_t>(1, 1, 3, {13107, 0, 65535}), f), Transfer::srgb, {s, 0, 1, 1});
            check(one(imageOf<uint16_t>(1, 1, 4, {13107, 0, 65535, 13107}), f), Transfer::srgb, {s, 0, 1, a});
            check(one(imageOf<float>(1, 1, 1, {7.5f}), f), Transfer::srgb, {7.5f, 7.5f, 7.5f, 1}); // floats are linear by nature
            check(one(imageOf<float>(1, 1, 2, {7.5f, .25f}), f), Transfer::srgb, {7.5f, 7.5f, 7.5f, .25f});
            check(one(imageOf<float>(1, 1, 3, {7.5f, -1, 2}), f), Transfer::linear, {7.5f, -1, 2, 1});
            check(one(imageOf<float>(1, 1, 4, {7.5f, -1, 2, .5f}), f), Transfer::linear, {7.5f, -1, 2, .5f});
        }
    }

    TEST_CASE("coordinates that are not finite, and pictures as wide as they come") {
        for (const Wrap mode : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
            for (const TextureFilter f : {TextureFilter::nearest, TextureFilter::linear}) {
                const Textures t = one(imageOf<uint8_t>(65536, 1, 1, Bytes(65536, 255)), f, mode, mode);
                for (const float u : {std::nanf(""), infinity, -infinity, 3e38f, -3e38f, 65535.99f, -65536.5f, 1e-40f})
                    CHECK(t.lookup(0, {u, u}, Transfer::srgb) == Vec4{1, 1, 1, 1});
            }
    }

    TEST_CASE("the slot's transform: rows times (u, v, 1)") {
        const float m[2][3] = {{0, 2, 0.5f}, {-1, 0, 0.25f}};
        const Point2 p = apply(m, {0.125f, 0.75f});
        CHECK(p.x == 2);
        CHECK(p.y == 0.125f);
        SceneDesc desc;
        const uint8_t texels[] = {0, 255};
        TextureSlot slot;
        slot.texture = test::addTexture(desc, 2, 1, 1, texels, {0, Wrap::repeat, Wrap::repeat, TextureFilter::nearest});
        slot.transform[0][2] = 0.5f;
        slot.uvSet = 1;
        const auto scene = test::compiled(std::move(desc));
        SurfacePoint at;
        at.uv[0] = {0.8f, 0};
        at.uv[1] = {0.1f, 0};
        CHECK(scene->sample(slot, at, Transfer::linear).x == 1); // 0.1 + 0.5 in set 1
        CHECK(scene->sample({}, at, Transfer::linear) == Vec4{1, 1, 1, 1});
    }
}
