// Pyramids of textures and look-ups over a footprint: levels in closed form, odd sizes, every pixel type, ellipses against sums over
// texels.
#include "core/scene/ray_cone.h"
#include "tests/core/texels.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <cstring>
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

template <class T> std::vector<T> noise(std::size_t count, uint64_t seed = 1) {
    stats::Random u(seed);
    std::vector<T> texels(count);
    for (T& t : texels) t = std::is_floating_point_v<T> ? T(u() * 9) : T(u() * (sizeof(T) == 1 ? 256 : 65536));
    return texels;
}
Textures one(ImageDesc i, Wrap s = Wrap::repeat, Wrap t = Wrap::repeat, TextureFilter filter = TextureFilter::linear) {
    std::vector<ImageDesc> images;
    images.push_back(std::move(i));
    return {std::move(images), {{0, s, t, filter}}};
}
double channel(const Vec4& v, int c) { return double(c == 0 ? v.x : c == 1 ? v.y : c == 2 ? v.z : v.w); }
// Mean of a channel over a level.
double mean(const TexelStore& store, std::size_t level, Transfer transfer, int c) {
    const MipLevel& l = store.levels(transfer)[level];
    double sum = 0;
    for (uint32_t y = 0; y < l.height; ++y)
        for (uint32_t x = 0; x < l.width; ++x) sum += channel(store.texel(l, x, y, transfer), c);
    return sum / (double(l.width) * l.height);
}
ImageDesc checker(int size, int square = 1) {
    std::vector<uint8_t> texels;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) texels.push_back((x / square + y / square) % 2 ? 255 : 0);
    return imageOf(size, size, 1, texels);
}
// The mean over a parallelogram about uv with these sides, by texels of the base.
double brute(const Textures& t, Point2 uv, Point2 p, Point2 q, int n = 200) {
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const float a = (float(i) + 0.5f) / float(n) - 0.5f, b = (float(j) + 0.5f) / float(n) - 0.5f;
            sum += double(t.lookup(0, {uv.x + p.x * a + q.x * b, uv.y + p.y * a + q.y * b}, Transfer::linear).x);
        }
    return sum / (double(n) * n);
}

} // namespace

TEST_SUITE("texture-pyramid") {

    TEST_CASE("a checkerboard of single texels is its mean from the first level on, in linear light") {
        for (const Transfer transfer : {Transfer::linear, Transfer::srgb}) {
            const Textures t = one(checker(64));
            const TexelStore& store = t.images()[0];
            const auto levels = store.levels(transfer);
            REQUIRE(levels.size() == 7);
            for (std::size_t i = 1; i < levels.size(); ++i) {
                CHECK(levels[i].width == 64u >> i);
                for (uint32_t y = 0; y < levels[i].height; ++y)
                    for (uint32_t x = 0; x < levels[i].width; ++x) // the nearest code to .5: 188 or 128
                        CHECK(store.texel(levels[i], x, y, transfer).x ==
                              (transfer == Transfer::srgb ? srgbToLinear(188 / 255.f) : 128 / 255.f));
            }
        }
        const Textures squares = one(checker(64, 8));
        const TexelStore& store = squares.images()[0];
        for (std::size_t level = 0; level <= 3; ++level) // squares of eight texels: black and white down to one texel each
            CHECK(store.texel(store.levels(Transfer::linear)[level], 1, 0, Transfer::linear).x == (level == 3 ? 1.f : 0.f));
        CHECK(store.texel(store.levels(Transfer::linear)[4], 1, 0, Transfer::linear).x == 128 / 255.f);
    }

    TEST_CASE("every level has the picture's mean: even, odd and single rows, every type, alpha apart") {
        const struct {
            int width, height;
        } sizes[] = {{32, 32}, {1, 1}, {1, 13}, {37, 1}, {3, 5}, {31, 17}, {100, 7}, {2, 64}};
        for (const auto& size : sizes)
            for (int channels = 1; channels <= 4; ++channels) {
                CAPTURE(size.width);
                CAPTURE(size.height);
                CAPTURE(channels);
                const std::size_t count = std::size_t(size.width) * size.height * channels;
                const auto check = [&](const Textures& t, double tolerance) {
                    const TexelStore& store = t.images()[0];
                    for (const Transfer transfer : {Transfer::linear, Transfer::srgb})
                        for (int c = 0; c < 4; ++c) {
                            const double whole = mean(store, 0, transfer, c);
                            for (std::size_t level = 1; level < store.levels(transfer).size(); ++level)
                                CHECK(std::fabs(mean(store, level, transfer, c) - whole) <= tolerance * (1 + std::fabs(whole)));
                            const MipLevel& last = store.levels(transfer).back();
                            CHECK(last.width * last.height == 1);
                        }
                };
                check(one(imageOf(size.width, size.height, channels, noise<float>(count))), 2e-6);
                check(one(imageOf(size.width, size.height, channels, noise<uint16_t>(count))), 2e-5);
                // A code of eight bits spans up to .009 of linear light; a level of one texel is rounded once.
                check(one(imageOf(size.width, size.height, channels, noise<uint8_t>(count))), 0.0046);
            }
    }

    TEST_CASE("the texels are those that came, wherever they lie in the store") {
        for (int channels = 1; channels <= 4; ++channels)
            for (const auto& [width, height] : {std::pair{19, 23}, {1, 40}, {64, 2}}) {
                const auto texels = noise<uint16_t>(std::size_t(width) * height * channels, 7);
                const Textures t = one(imageOf(width, height, channels, texels));
                std::vector<std::byte> row;
                int wrong = 0;
                for (int y = 0; y < height; ++y) {
                    t.images()[0].row(uint32_t(y), row);
                    REQUIRE(row.size() == std::size_t(width) * channels * 2);
                    wrong += std::memcmp(row.data(), &texels[std::size_t(y) * width * channels], row.size()) != 0;
                    for (int x = 0; x < width; ++x) {
                        const Vec4 v =
                            t.images()[0].texel(t.images()[0].levels(Transfer::linear)[0], uint32_t(x), uint32_t(y), Transfer::linear);
                        wrong += v.x != float(texels[(std::size_t(y) * width + x) * channels]) / 65535;
                    }
                }
                CHECK(wrong == 0);
            }
    }

    TEST_CASE("pyramids that nobody reads are not made") {
        SceneDesc d;
        const auto texels = noise<uint8_t>(64 * 64 * 3);
        std::vector<int> textures;
        for (int i = 0; i < 5; ++i) textures.push_back(addTexture(d, 64, 64, 3, texels));
        d.textures[4].filter = TextureFilter::nearest;
        MaterialDesc m;
        m.baseColorTexture.texture = textures[0];
        m.normalTexture.texture = textures[1];
        m.emissionTexture.texture = textures[2];
        m.specularColorTexture.texture = textures[4];
        shapes::add(d, m);
        const auto scene = compiled(std::move(d));
        const auto levels = [&](int image, Transfer t) { return scene->textures().images()[image].levels(t).size(); };
        CHECK(levels(0, Transfer::srgb) == 7);
        CHECK(levels(0, Transfer::linear) == 1);
        CHECK(levels(1, Transfer::srgb) == 1);
        CHECK(levels(1, Transfer::linear) == 7);
        for (const int i : {2, 3, 4})
            for (const Transfer t : {Transfer::linear, Transfer::srgb}) CHECK(levels(i, t) == 1);
        CHECK(scene->counts().bytes.textures == scene->textures().bytes());
        CHECK(scene->textures().bytes() == 5 * 64 * 64 * 4 + 2 * 4 * (32 * 32 + 16 * 16 + 8 * 8 + 4 * 4 + 2 * 16)); // tiles of 16 texels
    }

    TEST_CASE("footprints: nothing where they are small, the mean of the picture where they are large") {
        const Textures t = one(imageOf(64, 64, 3, noise<uint8_t>(64 * 64 * 3)));
        stats::Random u(3);
        const double whole = mean(t.images()[0], 0, Transfer::srgb, 1);
        for (int i = 0; i < 200; ++i) {
            const Point2 uv{u() * 4 - 2, u() * 4 - 2};
            CHECK(t.lookup(0, uv, Transfer::srgb, {0.9f / 64, 0}, {0, 0.5f / 64}) == t.lookup(0, uv, Transfer::srgb));
            CHECK(t.lookup(0, uv, Transfer::srgb, {0, 0}, {0, 0}) == t.lookup(0, uv, Transfer::srgb));
            CHECK(double(t.lookup(0, uv, Transfer::srgb, {3, 0.1f}, {-0.2f, 5}).y) == doctest::Approx(whole).epsilon(0.01));
        }
        for (const float bad : {std::nanf(""), infinity, 1e30f, 1e-40f})
            for (const Point2& p : {Point2{bad, 0}, {0, bad}, {bad, bad}}) {
                const Vec4 v = t.lookup(0, {0.3f, 0.4f}, Transfer::linear, p, {0.01f, 0.02f});
                CHECK((v.x >= 0 && v.x <= 1)); // and no endless loop
            }
        const Textures nearest = one(checker(64), Wrap::repeat, Wrap::repeat, TextureFilter::nearest);
        CHECK(nearest.lookup(0, {1.5f / 64, 0.5f / 64}, Transfer::linear, {1, 0}, {0, 1}).x == 1);
    }

    TEST_CASE("an ellipse is the mean over it: long and short, turned and sheared, across every border") {
        // A smooth picture, so that the shape of the filter matters and its corners do not.
        std::vector<float> texels;
        constexpr int size = 256;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                texels.push_back(0.5f + 0.25f * std::sin(2 * pi * 5 * float(x) / size) +
                                 0.25f * std::cos(2 * pi * (3 * float(x) + 7 * float(y)) / size));
        stats::Random u(11);
        for (const Wrap mode : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
            const Textures t = one(imageOf(size, size, 1, texels), mode, mode);
            // Beyond a clamped border a level shows the mean of its last texels, not the last ones of the picture: it stays within.
            const auto inside = [&](float x) { return mode == Wrap::clamp ? 0.25f + 0.5f * x : 2 * x - 0.5f; };
            double squares = 0, unfiltered = 0;
            constexpr int n = 60;
            for (int i = 0; i < n; ++i) {
                const float turn = 2 * pi * u(), length = 0.02f + 0.2f * u(), ratio = 1 + 11 * u(), shear = 0.5f * u();
                const Point2 p{length * std::cos(turn), length * std::sin(turn)};
                const Point2 q{-p.y / ratio + shear * p.x / ratio, p.x / ratio + shear * p.y / ratio}, uv{inside(u()), inside(u())};
                // What an ellipse of these diameters holds, as a box of the same spread: its axes are those of p and q.
                const double expected = brute(t, uv, p, q, 100), found = double(t.lookup(0, uv, Transfer::linear, p, q).x);
                squares += sqr(found - expected);
                unfiltered += sqr(double(t.lookup(0, uv, Transfer::linear).x) - expected);
            }
            INFO("wrap " << int(mode) << ": rms error " << std::sqrt(squares / n) << ", unfiltered " << std::sqrt(unfiltered / n));
            CHECK(std::sqrt(squares / n) < 0.035);
            CHECK(squares < 0.07 * unfiltered);
        }
    }

    TEST_CASE("one bright texel: what all look-ups over a grid find together is its energy, at every width") {
        std::vector<float> texels(64 * 64, 0.f);
        texels[20 * 64 + 33] = 4096;
        const Textures t = one(imageOf(64, 64, 1, texels));
        for (const float width : {0.5f, 1.f, 1.7f, 3.f, 8.f, 20.f, 70.f})
            for (const float ratio : {1.f, 2.5f, 6.f, 30.f}) {
                double sum = 0;
                for (int y = 0; y < 256; ++y)
                    for (int x = 0; x < 256; ++x)
                        sum +=
                            double(t.lookup(0, {(float(x) + 0.5f) / 256, (float(y) + 0.5f) / 256}, Transfer::linear,
                                            {0.6f * width * ratio / 64, 0.8f * width * ratio / 64}, {-0.8f * width / 64, 0.6f * width / 64})
                                       .x);
                CHECK(sum / 65536 == doctest::Approx(1).epsilon(1e-4));
            }
    }
}

TEST_SUITE("ray-cones") {

    TEST_CASE("the section of a cone: a circle head on, 1 / cos long where it leans, whatever the triangle") {
        stats::Random u(5);
        for (int i = 0; i < 300; ++i) {
            const auto any = [&] { return Vec3{u() - 0.5f, u() - 0.5f, u() - 0.5f}; };
            const Vec3 e1 = any() * 3, e2 = any(), d = i % 5 ? normalize(any()) : normalize(cross(e1, e2));
            const Vec3 n = normalize(cross(e1, e2));
            const float cosine = std::fabs(dot(n, d));
            if (cosine < 0.05f || length(cross(e1, e2)) < 0.01f) continue;
            const ConeSectionT<float> s = coneSection(e1, e2, d, 0.02f);
            const Vec3 major = e1 * s.major.x + e2 * s.major.y, minor = e1 * s.minor.x + e2 * s.minor.y;
            CHECK(length(major) == doctest::Approx(0.02 / double(cosine)).epsilon(2e-3));
            CHECK(length(minor) == doctest::Approx(0.02).epsilon(2e-3));
            CHECK(std::fabs(dot(major, minor)) < 1e-5f);
            if (cosine < 0.999f) CHECK(std::fabs(dot(minor, d)) < 1e-4f); // the short one lies across
        }
        const ConeSectionT<float> flat = coneSection<float>({1, 0, 0}, {2, 0, 0}, {0, 0, 1}, 0.1f); // no area: no section
        CHECK(flat.major.x == 0);
    }

    TEST_CASE("curvature of a ball is one over its radius, inside as outside, and under an instance") {
        SceneDesc d;
        const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.5f)));
        shapes::add(d, "ball", shapes::sphere(0.5, 4), grey, shapes::translation({-3, 0, 0}));
        shapes::add(d, "bowl", shapes::insideOut(shapes::sphere(0.5, 4)), grey, shapes::translation({3, 0, 0}));
        const Affine places[] = {shapes::translation({0, 0, 0}) * scaling(3, 3, 3),
                                 shapes::translation({0, 9, 0}) * scaling(-0.2, 0.2, 0.2)};
        addInstances(d, shapes::sphere(0.5, 4), grey, places);
        shapes::add(d, "plate", square(0.5), grey, shapes::translation({0, -5, 0}));
        const auto scene = compiled(std::move(d));
        const struct {
            Vec3d from, towards;
            double expected;
        } rows[] = {{{-3, 0.1, 5}, {0, 0, -1}, 2},
                    {{3, 0.1, 0}, {0.2, 0.1, -1}, -2},
                    {{0, 0.1, 5}, {0, 0, -1}, 2 / 3.0},
                    {{0, 9, 5}, {0, 0, -1}, 10},
                    {{0.1, -5, 5}, {0, 0, -1}, 0}};
        for (const auto& row : rows) {
            const Ray ray = rayFrom(local(*scene, row.from), cast<float>(row.towards));
            const Hit hit = scene->intersect(ray);
            REQUIRE(bool(hit));
            CHECK(double(scene->curvature(scene->point(hit, ray))) == doctest::Approx(row.expected).epsilon(0.01));
        }
    }

    TEST_CASE("mirrors and lenses turn the cone as paraxial optics say") {
        CHECK(mirroredSpread(0.01f, 0.f) == 0.01f);
        // A concave mirror of radius r brings parallel light together after r / 2.
        const float width = 0.01f, radius = 2;
        const Footprint focused{width, mirroredSpread(0.f, -width / radius)};
        CHECK(focused.at(radius / 2).width == doctest::Approx(0).epsilon(1e-6));
        CHECK(focused.at(radius).width == doctest::Approx(width));
        CHECK(focused.at(radius).spread > 0); // it opens again
        // Parallel light enters a glass ball: the focus lies at n r / (n - 1) behind the front.
        const float n = 1.5f;
        CHECK(Footprint{width, refractedSpread(0.f, width / radius, n)}.at(n * radius / (n - 1)).width == doctest::Approx(0).epsilon(1e-5));
        CHECK(refractedSpread(0.03f, 0.f, n) == doctest::Approx(0.02)); // a plane interface divides the angle
        CHECK(lobeSpread(1 / pi) == doctest::Approx(0.25));
        CHECK(lobeSpread(0.f) == widestLobe);
        CHECK(lobeSpread(1e6f) < 2e-4f);
    }
}
