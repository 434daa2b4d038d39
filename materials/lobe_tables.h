// Tables for what only some materials ask: the albedo of brushed surfaces, the energy that rough glass loses to single scattering, and the
// albedo under a Fresnel curve of any form. Like the albedo tables (materials/albedo_tables.h) they are filled by quadrature over visible
// normals on first use, from the templates that shade, and read without a lock.
#pragma once
#include "core/math/vec.h"

namespace chiaro {

// Directional albedo of a brushed surface for a Fresnel term of one: alpha across the brush, towards 1 along it by the square of strength.
class BrushedSlice {
public:
    BrushedSlice() = default;
    BrushedSlice(float alpha, float strength) noexcept;
    static float along(float alpha, float strength) noexcept { return alpha + (1 - alpha) * strength * strength; }
    float at(const Vec3& w) const noexcept; // x along the brush
    float average() const noexcept { return average_; }

private:
    int row_ = 0, depth_ = 0;
    float rowFraction_ = 0, depthFraction_ = 0, average_ = 1;
};

// What light seen from a direction loses in rough solid glass of no colour: 1 - R - T. Linear in the Fresnel term, so that F0 and F90 may
// have colours.
class GlassLoss {
public:
    GlassLoss() = default;
    GlassLoss(float alpha, float ior) noexcept;
    Spectrum at(float mu, bool outside, const Spectrum& f0, float f90) const noexcept;
    Spectrum average(bool outside, const Spectrum& f0, float f90) const noexcept; // over the cosine-weighted hemisphere

private:
    int row_ = 0, slot_ = 0;
    float rowFraction_ = 0, slotFraction_ = 0;
};

// Directional albedo under a Fresnel curve that is given at a few cosines and runs straight between them.
class CurveAlbedo {
public:
    static constexpr int nodes = 8;
    static float cosine(int node) noexcept { return float(node) / (nodes - 1); }
    using Curve = Spectrum[nodes];

    CurveAlbedo() = default;
    explicit CurveAlbedo(float alpha) noexcept; // above 0
    Spectrum at(float mu, const Curve&) const noexcept;
    Spectrum average(const Curve&) const noexcept;
    // The mean of the curve itself.
    static Spectrum mean(const Curve&) noexcept;

private:
    float alpha_ = 1;
    int row_ = 0;
    float fraction_ = 0;
};

} // namespace chiaro
