#include "materials/sheen.h"
#include "materials/gauss.h"

namespace chiaro {
namespace {

// Rows even in the roughness, columns in the root of the cosine.
constexpr int rows = 20, columns = 24;
constexpr float margin = 0.002f; // what interpolation may err by: the base gets so much less
const float firstRow = std::sqrt(Charlie::smallestAlpha);

struct Table {
    float cells[rows][columns]; // times the cosine

    Table() {
        const Gauss up(40), turn(40);
        for (int row = 0; row < rows; ++row) {
            const Charlie sheen{sqr(firstRow + (1 - firstRow) * float(row) / (rows - 1))};
            for (int column = 0; column < columns; ++column) {
                const float mu = std::max(sqr(float(column) / (columns - 1)), 1e-4f);
                const Vec3 wo{std::sqrt(1 - mu * mu), 0, mu};
                double sum = 0;
                for (std::size_t i = 0; i < up.x.size(); ++i) {
                    const float z = sqr(up.x[i]), s = std::sqrt(1 - z * z);
                    // cos_o D V cos_i = D / (4 (1 + lambda_o + lambda_i)), with dz = 2 x dx and both halves of the turn.
                    const float common = up.w[i] * 2 * up.x[i] * 2 * pi / (4 * (1 + sheen.lambda(mu) + sheen.lambda(z)));
                    for (std::size_t j = 0; j < turn.x.size(); ++j) {
                        const float phi = pi * turn.x[j];
                        const Vec3 h = normalize(wo + Vec3{s * std::cos(phi), s * std::sin(phi), z});
                        sum += double(common * turn.w[j] * sheen.d(h.z));
                    }
                }
                cells[row][column] = float(sum);
            }
        }
    }
};
const Table& table() noexcept {
    static const Table t;
    return t;
}

} // namespace

SheenSlice::SheenSlice(float alpha) noexcept {
    const float y = clamp01((std::sqrt(alpha) - firstRow) / (1 - firstRow)) * (rows - 1);
    row_ = std::min(int(y), rows - 2);
    fraction_ = y - float(row_);
}

float SheenSlice::at(float mu) const noexcept {
    const float x = std::sqrt(clamp01(mu)) * (columns - 1);
    const int c = std::min(int(x), columns - 2);
    const float f = x - float(c);
    const auto* const a = table().cells[row_];
    const auto* const b = table().cells[row_ + 1];
    const float low = a[c] + (a[c + 1] - a[c]) * f, high = b[c] + (b[c + 1] - b[c]) * f;
    return (low + (high - low) * fraction_) / std::max(mu, 1e-6f) + margin;
}

} // namespace chiaro
