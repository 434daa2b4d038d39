// A checkered plain with balls of mirror, glass and rough gold under one lamp, and a cube that tumbles through the air: what the classical
// algorithms are explained with. Checks alias towards the horizon, reflections go round between the balls, the lamp's shadow is hard or
// soft, the lens blurs what is near and far, the shutter what moves. Figures: scenes/playground.md.
#include "scenes/scenes.h"
#include "scenes/shapes.h"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace chiaro {
namespace {

constexpr double half = 0.17;   // of the cube's edge, metres
constexpr std::size_t cube = 4; // its instance

// Checks of one metre by half a metre of each tone, nearest texel: edges as sharp as they come.
int checks(SceneDesc& s, double side) {
    ImageDesc image;
    image.name = "checks";
    image.width = image.height = 2;
    image.channels = 3;
    for (const uint8_t tone : {232, 72, 72, 232})
        for (int c = 0; c < 3; ++c) image.pixels.push_back(std::byte(tone));
    s.images.push_back(std::move(image));
    TextureDesc texture;
    texture.image = 0;
    texture.filter = TextureFilter::nearest;
    s.textures.push_back(texture);
    MaterialDesc floor = shapes::diffuse("checks", Spectrum{1});
    floor.baseColorTexture.texture = 0;
    floor.baseColorTexture.transform[0][0] = floor.baseColorTexture.transform[1][1] = float(side); // one tile of 2 x 2 checks a metre
    return shapes::add(s, std::move(floor));
}

// One second of flight: it comes from the left, falls freely from its highest point at half a second, and turns once about a slanted axis.
Affine cubeAt(double t) {
    constexpr double g = 9.81, top = 1.5;
    const double x = -0.9 + 1.8 * t, y = top - g / 2 * (t - 0.5) * (t - 0.5), angle = 2 * std::numbers::pi * t;
    const Vec3d axis = normalize(Vec3d{0.3, 0.5, -1});
    const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
    const double a[3] = {axis.x, axis.y, axis.z}, turn[3][3] = {{0, -axis.z, axis.y}, {axis.z, 0, -axis.x}, {-axis.y, axis.x, 0}};
    Affine m = shapes::translation({x, y, -0.15});
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m.m[i][j] = (i == j ? c : 0) + k * a[i] * a[j] + s * turn[i][j]; // Rodrigues 1840
    return m;
}

} // namespace

SceneDesc makePlayground() {
    using namespace shapes;
    SceneDesc s;
    s.name = "@playground";
    constexpr double reach = 30; // of the plain, from the middle
    const int floor = checks(s, 2 * reach);
    const int mirror = add(s, metal("mirror", Spectrum{0.92f}, 0));
    const int clear = add(s, glass("glass", 1.5f));
    const int gold = add(s, metal("gold", Spectrum{1.0f, 0.766f, 0.336f}, 0.3f));
    const int red = add(s, diffuse("red", Spectrum{0.7f, 0.12f, 0.08f}));
    const int light = add(s, lamp("lamp", Spectrum{90}));
    add(s, "plain", quad({-reach, 0, reach}, {reach, 0, reach}, {reach, 0, -reach}, {-reach, 0, -reach}), floor);
    add(s, "mirror ball", sphere(0.5, 5), mirror, translation({-0.62, 0.501, -0.55}));
    add(s, "glass ball", sphere(0.32, 5), clear, translation({0.12, 0.321, 0.55}));
    add(s, "gold ball", sphere(0.38, 5), gold, translation({0.85, 0.381, -0.3}));
    add(s, "cube", box({half, half, half}), red, cubeAt(0));
    add(s, "lamp", quad({-0.3, 0, -0.3}, {0.3, 0, -0.3}, {0.3, 0, 0.3}, {-0.3, 0, 0.3}), light, translation({-1.1, 2.9, 1.2}));
    EnvironmentDesc sky;
    sky.image.name = "sky";
    sky.image.width = sky.image.height = 1;
    sky.image.channels = 3;
    sky.image.type = PixelType::f32;
    const float blue[3] = {0.20f, 0.27f, 0.38f};
    const auto* bytes = reinterpret_cast<const std::byte*>(blue);
    sky.image.pixels.assign(bytes, bytes + sizeof blue);
    s.environment = std::move(sky);
    addCamera(s, "main", 34 * std::numbers::pi / 180, lookAt({0, 0.95, 3.6}, {0, 0.5, 0}));
    return s;
}

void animatePlayground(SceneDesc& s, double frameTime, Interval shutter) {
    InstanceDesc& in = s.instances[cube];
    in.toWorld = cubeAt(frameTime + double(shutter.open));
    in.motion.clear();
    s.shutter = shutter;
    const double open = shutter.open, length = double(shutter.close) - open;
    if (!(length > 0)) return;
    const int steps = int(std::clamp(std::ceil(length * 64), 1.0, 128.0)); // a turn takes a second: 6 degrees a step at most
    for (int i = 0; i <= steps; ++i) in.motion.push_back(cubeAt(frameTime + open + length * i / steps));
}

} // namespace chiaro
