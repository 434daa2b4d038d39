// Refraction by colour (KHR_materials_dispersion): n falls with the wavelength as Cauchy's two terms say, from the index n_d at the yellow
// line of helium (587.6 nm) and Abbe's number V = (n_d - 1) / (n_F - n_C), dispersion = 20 / V:
//     n = n_d + (n_d - 1) / V x,   x = 523655 nm^2 / lambda^2 - 1.5168,   not below 1.
// A channel of RGB is a band of light, not a line: a hat over x, half a unit to either side of its middle. The middles are half a unit
// apart, at 630, 536 and 475 nm, so that red and blue differ by the 0.05 (n_d - 1) dispersion of the extension's rule for three channels,
// and between two middles the bands add up to one: white light fans out evenly from 799 to 431 nm.
#pragma once
#include "core/math/vec.h"

namespace chiaro {

struct Dispersion {
    static constexpr float middle[3] = {-0.1974f, 0.3026f, 0.8026f};
    static float place(float nm) noexcept { return 523655.f / (nm * nm) - 1.5168f; }
    static float wavelength(float place) noexcept { return std::sqrt(523655.f / (place + 1.5168f)); }
    static float ior(float ior, float dispersion, float place) noexcept {
        return std::max(ior + (ior - 1) * (dispersion / 20) * place, 1.f);
    }
    // At the middle of each channel.
    static Spectrum iors(float n, float dispersion) noexcept {
        return {ior(n, dispersion, middle[0]), ior(n, dispersion, middle[1]), ior(n, dispersion, middle[2])};
    }
    // A place within the band of a channel, with the density of its hat (inverse of the distribution function).
    static float draw(std::size_t channel, float u) noexcept {
        return middle[channel] + 0.5f * (u < 0.5f ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u));
    }
};

} // namespace chiaro
