// How much a microfacet layer reflects of the light that arrives from one direction (its directional albedo, single scattering with
// masking), and its mean over the cosine-weighted hemisphere. The base under a coat receives the rest: without these tables a white
// dielectric reflects up to half as much again as it received (glTF 2.0, appendix B, taken literally).
//
// Fresnel is split as F = F0 + (F90 - F0) s(cos), so that colour needs no table: E = F0 (E1 - Es) + F90 Es, with E1 the albedo for F = 1
// and Es that for F = s, the shape of the exact dielectric curve or of Schlick's. Tables are filled on first use from the same templates
// that shade (Gauss quadrature over visible normals), the same numbers on every machine that rounds alike; they are read without a lock.
#pragma once

namespace chiaro {

// Albedo for a Fresnel term of one, and for the shape s.
struct LayerAlbedo {
    float one = 1, shape = 0;
};

struct AlbedoColumns; // materials/albedo_columns.h

// A pair (alpha, ior) resolved to its place in the tables. alpha 0: a mirror, known exactly. ior 0: Schlick's shape.
class AlbedoSlice {
public:
    AlbedoSlice() = default;
    AlbedoSlice(float alpha, float ior) noexcept;
    LayerAlbedo at(float mu) const noexcept; // mu: cosine of the direction, (0, 1]
    LayerAlbedo average() const noexcept;    // 2 times the integral of at(mu) mu
    float one(float mu) const noexcept;      // of at()
    // The part of the tables that at() reads, over the cosine alone; alpha and ior above 0.
    void fill(AlbedoColumns&) const noexcept;

private:
    float alpha_ = 0, ior_ = 1.5f;
    int row_ = 0, slot_ = 1;
    float rowFraction_ = 0, slotFraction_ = 0;
    LayerAlbedo average_;
};

} // namespace chiaro
