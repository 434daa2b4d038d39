// Sky: the environment, radiance from every direction, as a latitude-longitude picture that is looked up by direction and chosen from by
// an alias table over its texels. Radiance and density of a texel lie in 16 bytes together, so that who finds the sky by chance has both
// in one load; a cell of the table takes 8. cd/m2; densities pdfW per steradian.
//
// Rows are sampled uniformly in the cosine: no sine in the density, nothing special at the poles. With a linear filter the table holds the
// mean of what the look-up shows over a texel, so that no direction that shines is left without density.
#pragma once
#include "core/math/vec.h"
#include "core/scene/desc.h"
#include "core/scene/sky_math.h"
#include <cstdint>
#include <optional>
#include <vector>

namespace chiaro {

class Sky {
public:
    explicit Sky(const EnvironmentDesc&);

    // Radiance, and in w the density with which sample() chooses the direction.
    Vec4 at(const Vec3& direction) const noexcept;
    struct Sample {
        Vec3 wi;
        Spectrum radiance;
        float pdfW = 0; // of the texel that was drawn
    };
    // uCell chooses the texel, u.x stays or goes to the alias and, stretched again, places the direction along the row, u.y across it.
    std::optional<Sample> sample(double uCell, Point2 u) const noexcept;
    double irradiance() const noexcept { return sum_; } // luminance over the sphere of directions, lux
    bool black() const noexcept { return sum_ == 0; }   // nothing can be chosen
    std::size_t bytes() const noexcept;

    // The tables as they are, for look-ups in lanes (core/scene/wide_sky.h).
    const SkyFrame& frame() const noexcept { return frame_; }
    TextureFilter filter() const noexcept { return filter_; }
    const float* texels() const noexcept { return &texels_[0].x; }    // four numbers each
    const float* cells() const noexcept { return &cells_[0].keep; }   // two each, the second a whole number; four can be read anywhere
    const float* rowCosines() const noexcept { return rows_.data(); } // of the upper edge of each row; one more than rows
    uint32_t count() const noexcept { return frame_.width * frame_.height; }

private:
    struct Cell {
        float keep = 1; // probability of staying
        uint32_t alias = 0;
    };
    Vec4 look(const SkyPlace<float>&) const noexcept;
    SkyFrame frame_;
    TextureFilter filter_ = TextureFilter::linear;
    std::vector<Vec4> texels_;
    std::vector<Cell> cells_; // one more than texels
    std::vector<float> rows_;
    double sum_ = 0;
};

} // namespace chiaro
