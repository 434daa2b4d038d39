// The albedo tables (materials/albedo_tables.h) of one fixed (alpha, ior), as a table over the cosine alone: what loops over lanes read,
// where one load brings all that a lane needs. The same numbers as AlbedoSlice::at() but for rounding. Not for a mirror (alpha 0), whose
// albedo needs no table, nor for Schlick's shape.
#pragma once
#include "materials/fresnel.h"

namespace chiaro {

struct AlbedoColumns {
    static constexpr int count = 40;
    // The tables err by up to 0.0015 either way. Pushed up by a part of that, they let the base lose light rather than win it.
    static constexpr float margin = 0.0005f;
    // What varies with mu near grazing does so on the scale of alpha, over a few of them.
    static constexpr float scale = 4;
    float cells[count][2] = {}; // E1; 1 - Es / E1 over guess()

    // Where a cosine lies among the columns, [0, 1].
    template <class T> static T place(T mu, T alpha) noexcept {
        const T a = T(scale) * alpha;
        return sqrt(mu * (T(1.f) + a) / (mu + a));
    }
    // 1 - Es / E1 is stored over this guess, which has nearly its form: the quotient varies little.
    template <class T> static T guess(T mu, T alpha, T ior) noexcept {
        return max(T(1.f) - dielectricShape(min(T(1.f), sqrt(mu * mu + T(2.f) * alpha * alpha)), ior), T(1e-6f));
    }
};

} // namespace chiaro
