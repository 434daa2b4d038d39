#include "tools/cli/scene_source.h"
#include <cmath>
#include <cstring>
#include <numbers>

namespace chiaro::cli {
namespace {

struct SoftBox {
    Vec3d axis, right, up; // up, right: the half extents on the plane at distance 1
    double halfWidth, halfHeight, radiance;
};

SoftBox softBox(double azimuthDegrees, double elevationDegrees, double halfWidth, double halfHeight, double radiance) {
    const double a = azimuthDegrees * std::numbers::pi / 180, e = elevationDegrees * std::numbers::pi / 180;
    // Azimuth from +Z (where the viewer stands) towards +X (the viewer's right).
    const Vec3d axis{std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)};
    const Vec3d right = normalize(cross(Vec3d{0, 1, 0}, axis));
    return {axis, right, cross(axis, right), halfWidth, halfHeight, radiance};
}

// 1 inside, 0 outside, a smooth edge of a tenth between.
double box(const SoftBox& b, const Vec3d& d) {
    const double along = dot(d, b.axis);
    if (along <= 0) return 0;
    const auto side = [](double x) {
        const double t = std::fmin(std::fmax((1.05 - std::fabs(x)) / 0.1, 0.0), 1.0);
        return t * t * (3 - 2 * t);
    };
    return side(dot(d, b.right) / along / b.halfWidth) * side(dot(d, b.up) / along / b.halfHeight);
}

} // namespace

EnvironmentDesc studioEnvironment() {
    constexpr int width = 256, height = 128;
    const SoftBox boxes[] = {softBox(-40, 50, 0.45, 0.45, 14), softBox(65, 25, 0.30, 0.50, 4), softBox(180, 40, 0.9, 0.25, 3)};
    std::vector<float> texels;
    texels.reserve(std::size_t(width) * height * 3);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            // u = 0.5 + atan2(z, x) / 2 pi, v = acos(y) / pi
            const double phi = 2 * std::numbers::pi * ((column + 0.5) / width - 0.5), theta = std::numbers::pi * (row + 0.5) / height;
            const Vec3d d{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
            // The room: ceiling 1, walls falling to a floor of 0.25, without a visible horizon.
            const double t = std::fmin(std::fmax((d.y + 0.5) / 1.0, 0.0), 1.0);
            double radiance = 0.25 + 0.55 * t * t * (3 - 2 * t);
            for (const SoftBox& b : boxes) radiance += b.radiance * box(b, d);
            texels.insert(texels.end(), 3, float(radiance));
        }
    EnvironmentDesc environment;
    environment.image = {"studio", width, height, 3, PixelType::f32, std::vector<std::byte>(texels.size() * sizeof(float))};
    std::memcpy(environment.image.pixels.data(), texels.data(), environment.image.pixels.size());
    return environment;
}

EnvironmentDesc whiteEnvironment() {
    static constexpr float white[3] = {1, 1, 1};
    EnvironmentDesc environment;
    environment.image = {"white", 1, 1, 3, PixelType::f32, std::vector<std::byte>(sizeof(white))};
    std::memcpy(environment.image.pixels.data(), white, sizeof(white));
    return environment;
}

} // namespace chiaro::cli
