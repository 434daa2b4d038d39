// Look-ups in lanes are those of one path: the sky and textures, bit for bit, in either instruction set.
#include "tests/core/wide_lookup.h"
#include "core/scene/ray_cone.h"
#include "core/scene/wide_surfaces.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <cstring>
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

struct Isa {
    const char* name;
    SkyProgram* sky;
    TextureProgram* texture;
};
std::vector<Isa> isas() {
    std::vector<Isa> all;
    if (__builtin_cpu_supports("avx2")) all.push_back({"avx2", skyAvx2, textureAvx2});
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl"))
        all.push_back({"avx512", skyAvx512, textureAvx512});
    return all;
}

template <class T> std::vector<std::byte> noise(std::size_t count) {
    stats::Random u(9);
    std::vector<std::byte> bytes(count * sizeof(T));
    for (std::size_t i = 0; i < count; ++i) {
        const T t = std::is_floating_point_v<T> ? T(u() * 5) : T(u() * (sizeof(T) == 1 ? 256 : 65536));
        std::memcpy(&bytes[i * sizeof(T)], &t, sizeof t);
    }
    return bytes;
}
// Codes of finite halves out of any.
std::vector<std::byte> halves(std::vector<std::byte> codes) {
    for (std::size_t i = 1; i < codes.size(); i += 2)
        if ((codes[i] & std::byte(0x7c)) == std::byte(0x7c)) codes[i] ^= std::byte(0x40);
    return codes;
}

} // namespace

TEST_SUITE("wide-lookup") {

    TEST_CASE("the sky: every direction and every sample of every map") {
        for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {64, 32}, {1000, 10}, {7, 501}})
            for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::linear}) {
                EnvironmentDesc e = environment(
                    width, height,
                    [](int x, int y) {
                        const auto v = float((x * 7919 + y * 104729) % 97);
                        return Spectrum(v * v, 1 + v, x == 2 ? 5000.f : 0.f);
                    },
                    filter);
                e.rotate = 0.7f;
                const Sky sky(e);
                for (const Isa& isa : isas()) {
                    CAPTURE(width);
                    CAPTURE(isa.name);
                    stats::Random u(3);
                    int looks = 0, samples = 0;
                    double off = 0;
                    for (int round = 0; round < 300; ++round) {
                        LookupLanes l;
                        for (uint32_t k = 0; k < 16; ++k) {
                            Vec3 d = normalize(Vec3{u() - 0.5f, u() - 0.5f, u() - 0.5f});
                            if (round == 0 && k < 6)
                                d = {k == 0 ? 1.f : k == 1 ? -1.f : 0, k == 2 ? 1.f : k == 3 ? -1.f : 0, k == 4 ? 1.f : k == 5 ? -1.f : 0};
                            l.dx[k] = d.x, l.dy[k] = d.y, l.dz[k] = d.z, l.ux[k] = u(), l.uy[k] = u();
                            l.pick[k] = uint32_t(u.next() >> 32);
                        }
                        isa.sky(sky, l);
                        for (uint32_t k = 0; k < 16; ++k) {
                            const Vec4 v = sky.at({l.dx[k], l.dy[k], l.dz[k]});
                            looks += v.x != l.r[k] || v.y != l.g[k] || v.z != l.b[k] || v.w != l.pdfW[k];
                            const auto s = sky.sample(double(l.pick[k]) * 0x1p-32, {l.ux[k], l.uy[k]});
                            REQUIRE(bool(s));
                            // Sine and cosine are rounded differently; the texel that was drawn is the same.
                            samples += s->pdfW != l.samplePdf[k];
                            off = std::max(off, double(length(s->wi - Vec3{l.sampleX[k], l.sampleY[k], l.sampleZ[k]})));
                            for (const auto& [a, b] :
                                 {std::pair{s->radiance[0], l.sampleR[k]}, {s->radiance[1], l.sampleG[k]}, {s->radiance[2], l.sampleB[k]}})
                                samples += !(std::fabs(a - b) <= 1e-5f * (1 + std::fabs(a)));
                        }
                    }
                    CHECK(looks == 0);
                    CHECK(samples == 0);
                    CHECK(off < 1e-6);
                }
            }
    }

    TEST_CASE("samples in lanes follow the density that a look-up names") {
        constexpr int width = 40, height = 20, n = 320'000;
        const Sky sky(environment(
            width, height, [](int x, int y) { return Spectrum(x == 31 && y == 4 ? 300.f : float((x * 31 + y * 17) % 13)); },
            TextureFilter::linear));
        for (const Isa& isa : isas()) {
            CAPTURE(isa.name);
            stats::Random u(21);
            std::vector<double> observed(width * height), expected(observed.size());
            for (int i = 0; i < n / 16; ++i) {
                LookupLanes l{};
                for (uint32_t k = 0; k < 16; ++k) l.ux[k] = u(), l.uy[k] = u(), l.pick[k] = uint32_t(u.next() >> 32), l.dy[k] = 1;
                isa.sky(sky, l);
                for (uint32_t k = 0; k < 16; ++k) {
                    const int x = int((0.5 + std::atan2(double(l.sampleZ[k]), double(l.sampleX[k])) / (2 * std::numbers::pi)) * width),
                              y = int(std::acos(std::clamp(double(l.sampleY[k]), -1.0, 1.0)) / std::numbers::pi * height);
                    ++observed[std::size_t(std::min(y, height - 1)) * width + std::min(x, width - 1)];
                }
            }
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const double phi = ((x + 0.5) / width - 0.5) * 2 * std::numbers::pi, theta = (y + 0.5) / height * std::numbers::pi;
                    const double solid = 2 * std::numbers::pi / width *
                                         (std::cos(std::numbers::pi * y / height) - std::cos(std::numbers::pi * (y + 1) / height));
                    expected[std::size_t(y) * width + x] = n * solid *
                                                           double(sky.at({float(std::sin(theta) * std::cos(phi)), float(std::cos(theta)),
                                                                          float(std::sin(theta) * std::sin(phi))})
                                                                      .w);
                }
            CHECK(stats::chiSquare(observed, expected).p > stats::sidak(2));
        }
    }

    TEST_CASE("textures: every pixel type, channels, wrap mode, filter and footprint") {
        for (const PixelType type : {PixelType::u8, PixelType::u16, PixelType::f16, PixelType::f32})
            for (int channels = 1; channels <= 4; ++channels)
                for (const auto& [width, height] : {std::pair{32, 32}, {13, 50}, {1, 9}})
                    for (const Wrap mode : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
                        for (const TextureFilter filter : {TextureFilter::linear, TextureFilter::nearest}) {
                            SceneDesc d;
                            const std::size_t count = std::size_t(width) * height * channels;
                            ImageDesc image;
                            image.width = width, image.height = height, image.channels = channels, image.type = type;
                            image.pixels = type == PixelType::u8    ? noise<uint8_t>(count)
                                           : type == PixelType::u16 ? noise<uint16_t>(count)
                                           : type == PixelType::f16 ? halves(noise<uint16_t>(count))
                                                                    : noise<float>(count);
                            d.images.push_back(std::move(image));
                            d.textures.push_back({0, mode, mode, filter});
                            MaterialDesc m;
                            m.baseColorTexture.texture = 0;
                            m.baseColorTexture.transform[0][1] = 0.25f, m.baseColorTexture.transform[1][2] = -0.5f;
                            const TextureSlot slot = m.baseColorTexture;
                            shapes::add(d, "square", square(1), shapes::add(d, m));
                            const auto scene = compiled(std::move(d));
                            const WideTextures wide(*scene, WideSurfaces(*scene));
                            CHECK(wide.filtered() == (filter == TextureFilter::linear));
                            const UvEdges<float> edges({0, 0}, {1, 0}, {0, 1});
                            for (const Isa& isa : isas()) {
                                stats::Random u(5);
                                int wrong = 0;
                                for (int round = 0; round < 12; ++round) {
                                    LookupLanes l{};
                                    const uint32_t lanes = round ? 0xffffu : 0x5a01u;
                                    const float size = round % 4 == 0 ? 0 : std::ldexp(1.f, round % 4 - 5);
                                    for (uint32_t k = 0; k < 16; ++k) {
                                        l.u[k] = u() * 8 - 4, l.v[k] = u() * 8 - 4;
                                        if (round == 3) l.u[k] = k == 3 ? std::nanf("") : k == 4 ? infinity : k == 5 ? -3e38f : l.u[k];
                                        l.majorX[k] = size * u(), l.majorY[k] = size * u();
                                        l.minorX[k] = 0.4f * size * u(), l.minorY[k] = -0.4f * size * u();
                                    }
                                    isa.texture(wide.of(0), size > 0, lanes, l);
                                    for (uint32_t k = 0; k < 16; ++k) {
                                        if (!(lanes >> k & 1)) continue;
                                        const Point2 uv = apply(slot.transform, {l.u[k], l.v[k]});
                                        const Vec4 v =
                                            size > 0 ? scene->textures().lookup(0, uv, Transfer::srgb,
                                                                                edges.step({l.majorX[k], l.majorY[k]}, slot.transform),
                                                                                edges.step({l.minorX[k], l.minorY[k]}, slot.transform))
                                                     : scene->textures().lookup(0, uv, Transfer::srgb);
                                        wrong += v.x != l.r[k] || v.y != l.g[k] || v.z != l.b[k];
                                    }
                                }
                                INFO(isa.name << ", type " << int(type) << ", " << channels << " channels, " << width << " x " << height
                                              << ", wrap " << int(mode) << ", filter " << int(filter));
                                CHECK(wrong == 0);
                            }
                        }
    }
}
