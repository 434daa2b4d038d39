// The closures that every statistical test of materials runs over: listed once, tested by all.
#pragma once
#include "materials/bsdf.h"

namespace chiaro::test {

struct ClosureCase {
    const char* name;
    BsdfParameters parameters;
};

inline const Spectrum sand{0.8f, 0.5f, 0.2f};

inline const ClosureCase closures[] = {
    {"black", {.baseColor = Spectrum(0), .specular = 0}},
    {"lambert", {.baseColor = sand, .specular = 0}},
    {"mirror-coat", {.baseColor = sand, .roughness = 0}},
    {"mirror-coat-2.4", {.baseColor = Spectrum(1), .roughness = 0, .ior = 2.4f}},
    {"coat-0.04", {.baseColor = sand, .roughness = 0.04f}},
    {"coat-0.2", {.baseColor = Spectrum(1), .roughness = 0.2f}},
    {"coat-0.5", {.baseColor = Spectrum(1), .roughness = 0.5f}},
    {"coat-1", {.baseColor = sand, .roughness = 1}},
    {"coat-0.4-ior-1.2", {.baseColor = sand, .roughness = 0.4f, .ior = 1.2f}},
    {"coat-0.3-ior-2.4", {.baseColor = sand, .roughness = 0.3f, .ior = 2.4f}},
    {"coat-black-base", {.baseColor = Spectrum(0), .roughness = 0.3f}},
    {"coat-coloured", {.baseColor = Spectrum(1), .roughness = 0.35f, .specular = 0.8f, .specularColor = {2, 1, 0.2f}}},
    {"coat-infinite-ior", {.baseColor = sand, .roughness = 0.4f, .ior = 0, .specularColor = {0.9f, 0.3f, 0.04f}}},
    {"metal-mirror", {.baseColor = sand, .metallic = 1, .roughness = 0}},
    {"metal-0.033", {.baseColor = sand, .metallic = 1, .roughness = 0.033f}},
    {"metal-0.1", {.baseColor = sand, .metallic = 1, .roughness = 0.1f}},
    {"metal-0.3", {.baseColor = sand, .metallic = 1, .roughness = 0.3f}},
    {"metal-0.7", {.baseColor = Spectrum(1), .metallic = 1, .roughness = 0.7f}},
    {"metal-1", {.baseColor = Spectrum(1), .metallic = 1, .roughness = 1}},
    {"glass-smooth", {.baseColor = Spectrum(1), .roughness = 0, .transmission = 1, .thin = false}},
    {"glass-0.1", {.baseColor = Spectrum(1), .roughness = 0.1f, .transmission = 1, .thin = false}},
    {"glass-0.4", {.baseColor = sand, .roughness = 0.4f, .transmission = 1, .thin = false}},
    {"glass-1", {.baseColor = Spectrum(1), .roughness = 1, .transmission = 1, .thin = false}},
    {"glass-0.3-ior-1.05", {.baseColor = Spectrum(1), .roughness = 0.3f, .ior = 1.05f, .transmission = 1, .thin = false}},
    {"glass-0.25-ior-2.4", {.baseColor = sand, .roughness = 0.25f, .ior = 2.4f, .transmission = 1, .thin = false}},
    {"glass-coloured-specular", {.roughness = 0.3f, .specular = 0.7f, .specularColor = {1, 0.5f, 2}, .transmission = 1, .thin = false}},
    {"glass-matched", {.baseColor = sand, .roughness = 0.5f, .ior = 1, .transmission = 1, .thin = false}},
    {"glass-infinite-ior", {.baseColor = sand, .roughness = 0.3f, .ior = 0, .transmission = 1, .thin = false}},
    {"pane-smooth", {.baseColor = sand, .roughness = 0, .transmission = 1}},
    {"pane-0.2", {.baseColor = Spectrum(1), .roughness = 0.2f, .transmission = 1}},
    {"pane-0.7", {.baseColor = sand, .roughness = 0.7f, .transmission = 1}},
    {"half-metal", {.baseColor = sand, .metallic = 0.5f, .roughness = 0.5f}},
    {"half-metal-smooth", {.baseColor = sand, .metallic = 0.5f, .roughness = 0}},
    {"half-glass-smooth", {.baseColor = sand, .roughness = 0, .transmission = 0.5f, .thin = false}},
    {"half-glass-0.3", {.baseColor = sand, .roughness = 0.3f, .transmission = 0.5f, .thin = false}},
    {"half-pane-0.3", {.baseColor = sand, .roughness = 0.3f, .transmission = 0.5f}},
    {"metal-in-matched-glass", {.baseColor = sand, .metallic = 0.5f, .roughness = 0.3f, .ior = 1, .transmission = 0.5f, .thin = false}},
    {"everything",
     {.baseColor = sand,
      .metallic = 0.3f,
      .roughness = 0.25f,
      .ior = 1.8f,
      .specular = 0.7f,
      .specularColor = {1, 0.6f, 0.3f},
      .transmission = 0.4f,
      .thin = false}},
};
inline constexpr int closureCount = int(std::size(closures));

// Degrees from the normal; above 90: from behind, leaving a solid.
inline constexpr double incidences[] = {0, 30, 60, 85, 89.9, 180, 150, 120, 95, 90.1};
inline constexpr int incidenceCount = int(std::size(incidences));

// A frame that is nobody's axes, so that world and local space differ.
inline const Frame surface = Frame::about(normalize(Vec3{0.3f, -0.5f, 0.7f}));

inline Vec3 direction(double degrees, double turn = 0.4) {
    const double a = degrees * std::numbers::pi / 180;
    return surface.toWorld(cast<float>(Vec3d{std::sin(a) * std::cos(turn), std::sin(a) * std::sin(turn), std::cos(a)}));
}
inline Bsdf closure(const ClosureCase& c, const Vec3& wo, Transport t = Transport::radiance) {
    return Bsdf(c.parameters, surface.z, surface.z, wo, t);
}

} // namespace chiaro::test
