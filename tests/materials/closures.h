// The closures that every statistical test of materials runs over: listed once, tested by all.
#pragma once
#include "materials/bsdf.h"

namespace chiaro::test {

struct ClosureCase {
    const char* name;
    BsdfParameters parameters;
};

// A frame that is nobody's axes, so that world and local space differ.
inline const Frame surface = Frame::about(normalize(Vec3{0.3f, -0.5f, 0.7f}));

inline const Spectrum sand{0.8f, 0.5f, 0.2f};
inline const Vec3 brush = surface.toWorld({0.6f, 0.8f, 0}), tilted = surface.toWorld(normalize(Vec3{0.25f, -0.1f, 1}));

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
    {"brushed-0.1-0.3", {.baseColor = sand, .metallic = 1, .roughness = 0.3162278f, .anisotropy = 0.4714045f, .tangent = brush}},
    {"brushed-metal", {.baseColor = Spectrum(1), .metallic = 1, .roughness = 0.3f, .anisotropy = 1, .tangent = brush}},
    {"brushed-coat", {.baseColor = Spectrum(1), .roughness = 0.4f, .anisotropy = 0.7f, .tangent = brush}},
    {"brushed-glass",
     {.baseColor = Spectrum(1), .roughness = 0.35f, .transmission = 1, .thin = false, .anisotropy = 0.6f, .tangent = brush}},
    {"film-mirror", {.baseColor = sand, .metallic = 1, .roughness = 0, .iridescence = 1, .filmThickness = 400}},
    {"film-metal", {.baseColor = sand, .metallic = 1, .roughness = 0.4f, .iridescence = 1, .filmIor = 1.6f, .filmThickness = 550}},
    {"film-smooth", {.baseColor = Spectrum(1), .roughness = 0, .iridescence = 1, .filmIor = 1.8f, .filmThickness = 300}},
    {"film-coat", {.baseColor = Spectrum(1), .roughness = 0.3f, .iridescence = 0.8f, .filmIor = 1.33f, .filmThickness = 380}},
    {"film-glass", {.roughness = 0, .transmission = 1, .thin = false, .iridescence = 1, .filmIor = 1.33f, .filmThickness = 450}},
    {"film-glass-0.4", {.roughness = 0.4f, .transmission = 1, .thin = false, .iridescence = 0.7f, .filmThickness = 450}},
    {"film-pane", {.baseColor = sand, .roughness = 0, .transmission = 1, .iridescence = 1, .filmThickness = 250}},
    {"prism", {.roughness = 0, .ior = 1.6f, .transmission = 1, .thin = false, .dispersion = 4}},
    {"prism-half", {.baseColor = sand, .roughness = 0, .transmission = 0.5f, .thin = false, .dispersion = 1}},
    {"prism-0.3", {.roughness = 0.3f, .ior = 1.6f, .transmission = 1, .thin = false, .dispersion = 4}},
    {"leaf", {.baseColor = sand, .specular = 0, .diffuseTransmission = 0.5f, .diffuseTransmissionColor = {0.3f, 0.9f, 0.1f}}},
    {"leaf-coat", {.baseColor = Spectrum(1), .roughness = 0.4f, .diffuseTransmission = 0.7f}},
    {"leaf-all", {.baseColor = sand, .roughness = 0.3f, .diffuseTransmission = 1, .diffuseTransmissionColor = sand}},
    {"wax", {.baseColor = sand, .roughness = 0, .thin = false, .diffuseTransmission = 0.6f}},
    {"leaf-glass", {.baseColor = sand, .roughness = 0.3f, .transmission = 0.5f, .thin = false, .diffuseTransmission = 0.5f}},
    {"leaf-pane", {.baseColor = sand, .roughness = 0.5f, .transmission = 0.5f, .diffuseTransmission = 0.5f}},
    {"sheen", {.baseColor = sand, .specular = 0, .sheenColor = Spectrum(1), .sheenRoughness = 0.5f}},
    {"sheen-0.1", {.baseColor = Spectrum(1), .roughness = 0.8f, .sheenColor = {1, 0.6f, 0.3f}, .sheenRoughness = 0.1f}},
    {"sheen-metal", {.baseColor = Spectrum(1), .metallic = 1, .roughness = 0.4f, .sheenColor = sand, .sheenRoughness = 1}},
    {"sheen-leaf", {.baseColor = Spectrum(1), .specular = 0, .diffuseTransmission = 0.5f, .sheenColor = sand, .sheenRoughness = 0.3f}},
    {"lacquer", {.baseColor = Spectrum(1), .specular = 0, .clearcoat = 1, .clearcoatRoughness = 0}},
    {"lacquer-0.3", {.baseColor = Spectrum(1), .roughness = 0.6f, .clearcoat = 0.8f, .clearcoatRoughness = 0.3f}},
    {"lacquer-mirror", {.baseColor = Spectrum(1), .metallic = 1, .roughness = 0, .clearcoat = 1, .clearcoatRoughness = 0}},
    {"lacquer-metal", {.baseColor = Spectrum(1), .metallic = 1, .roughness = 0.4f, .clearcoat = 1, .clearcoatRoughness = 0.1f}},
    {"lacquer-glass", {.roughness = 0, .transmission = 1, .thin = false, .clearcoat = 1, .clearcoatRoughness = 0.2f}},
    {"lacquer-glass-0.3", {.roughness = 0.3f, .transmission = 1, .thin = false, .clearcoat = 1, .clearcoatRoughness = 0}},
    {"lacquer-pane", {.roughness = 0, .transmission = 1, .clearcoat = 1, .clearcoatRoughness = 0}},
    {"lacquer-tilted",
     {.baseColor = Spectrum(1), .metallic = 1, .roughness = 0.5f, .clearcoat = 1, .clearcoatRoughness = 0.25f, .clearcoatNormal = tilted}},
    {"lacquer-tilted-smooth",
     {.baseColor = Spectrum(1), .roughness = 0.5f, .clearcoat = 1, .clearcoatRoughness = 0, .clearcoatNormal = tilted}},
    {"lacquer-sheen",
     {.baseColor = Spectrum(1),
      .roughness = 0.7f,
      .clearcoat = 0.7f,
      .clearcoatRoughness = 0.2f,
      .sheenColor = {0.8f, 0.9f, 1},
      .sheenRoughness = 0.4f}},
    {"everything-layered",
     {.baseColor = sand,
      .metallic = 0.3f,
      .roughness = 0.3f,
      .ior = 1.6f,
      .specular = 0.8f,
      .transmission = 0.4f,
      .thin = false,
      .anisotropy = 0.5f,
      .tangent = brush,
      .iridescence = 0.5f,
      .filmThickness = 300,
      .dispersion = 2,
      .diffuseTransmission = 0.3f,
      .diffuseTransmissionColor = {0.2f, 0.8f, 0.4f},
      .clearcoat = 0.5f,
      .clearcoatRoughness = 0.25f,
      .clearcoatNormal = tilted,
      .sheenColor = {0.3f, 0.5f, 0.7f},
      .sheenRoughness = 0.6f}},
};
inline constexpr int closureCount = int(std::size(closures)), plainClosures = 38; // the further lobes are listed behind the plain ones

// Degrees from the normal; above 90: from behind, leaving a solid.
inline constexpr double incidences[] = {0, 30, 60, 85, 89.9, 180, 150, 120, 95, 90.1};
inline constexpr int incidenceCount = int(std::size(incidences));

inline Vec3 direction(double degrees, double turn = 0.4) {
    const double a = degrees * std::numbers::pi / 180;
    return surface.toWorld(cast<float>(Vec3d{std::sin(a) * std::cos(turn), std::sin(a) * std::sin(turn), std::cos(a)}));
}
// The narrowest lobe's alpha; 1e-3: a mirror, which has none.
inline float sharpest(const BsdfParameters& p) {
    const float base = p.roughness * p.roughness, coat = p.clearcoat > 0 ? p.clearcoatRoughness * p.clearcoatRoughness : 0;
    if (coat < 1e-3f) return std::max(base, 1e-3f);
    return base < 1e-3f ? coat : std::min(base, coat);
}
inline Bsdf closure(const ClosureCase& c, const Vec3& wo, Transport t = Transport::radiance) {
    return Bsdf(c.parameters, surface.z, surface.z, wo, t);
}

} // namespace chiaro::test
