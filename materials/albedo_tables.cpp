#include "materials/albedo_tables.h"
#include "core/math/lanes.h"
#include "materials/albedo_columns.h"
#include "materials/fresnel.h"
#include "materials/gauss.h"
#include "materials/microfacet.h"

namespace chiaro {
namespace {

// Rows in alpha (even in its fourth root), columns in mu, then slots: E1, one ratio for each node of the index, one for Schlick's shape.
// The index axis is even in sqrt((n - 1) / (n + 1)) with n = 1.5 on its sixth node.
constexpr int rows = 32, columns = AlbedoColumns::count, iors = 12, slots = iors + 2, schlickSlot = iors + 1, smoothNodes = 64;
constexpr float smallestAlpha = 1e-3f;
const float firstRoot = std::sqrt(std::sqrt(smallestAlpha)), iorStep = std::sqrt(0.2f) / 6;

float alphaOfRow(int row) noexcept { return sqr(sqr(firstRoot + (1 - firstRoot) * float(row) / (rows - 1))); }
float iorRoot(float ior) noexcept { return std::sqrt((ior - 1) / (ior + 1)); }
float iorOfRoot(float root) noexcept { return (1 + root * root) / (1 - root * root); }
float iorOfSlot(int slot) noexcept { return slot == schlickSlot ? 0 : iorOfRoot(iorStep * float(slot)); }

constexpr float scale = AlbedoColumns::scale;
float columnOf(float mu, float alpha) noexcept { return AlbedoColumns::place(mu, alpha); }
float muOfColumn(float x, float alpha) noexcept { return x >= 1 ? 1 : x * x * scale * alpha / (1 + scale * alpha - x * x); }

template <class T> T shape(T cosTheta, float ior) noexcept { return ior == 0 ? schlickShape(cosTheta) : dielectricShape(cosTheta, T(ior)); }
// 1 - Es / E1 is stored over this guess, which has nearly its form: the quotient varies little.
float guess(float mu, float alpha, float ior) noexcept {
    return std::max(1 - shape(std::min(1.f, std::sqrt(mu * mu + 2 * alpha * alpha)), ior), 1e-6f);
}

struct Tables {
    float cells[rows][columns][slots];
    float averages[rows][slots];   // E1; Es over that of the mirror
    float smooth[smoothNodes + 1]; // average of the shape, by iorRoot
    float smoothSchlick = 0;

    Tables() {
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < columns; ++column) fillCell(row, column);
        const Gauss mu(96);
        for (int i = 0; i <= smoothNodes; ++i) smooth[i] = i == 0 ? 0 : smoothAverage(mu, iorOfRoot(0.95f * float(i) / smoothNodes));
        smoothSchlick = smoothAverage(mu, 0);
        for (int row = 0; row < rows; ++row) fillAverages(row, mu);
    }

    // E = integral of F G2 / G1 over the visible normals, two half turns alike.
    void fillCell(int row, int column) {
        constexpr int width = 8;
        using V = Lanes<width>;
        static const Gauss turn(12), cap(24);
        const float alpha = alphaOfRow(row), mu = std::max(muOfColumn(float(column) / (columns - 1), alpha), 1e-6f);
        const Ggx<V> ggx{V(alpha), V(alpha)};
        const Vec3T<V> wo{V(std::sqrt(1 - mu * mu)), V(0), V(mu)};
        V sums[slots];
        for (V& s : sums) s = 0;
        for (std::size_t a = 0; a < turn.x.size(); ++a)
            for (std::size_t b = 0; b < cap.x.size(); b += width) {
                const Vec2T<V> u{V(turn.x[a] / 2), V(&cap.x[b], std::experimental::element_aligned)};
                const Vec3T<V> h = ggx.sampleVisible(wo, u);
                Vec3T<V> wi = reflect(wo, h);
                const auto lost = wi.z <= V(0);
                wi.z = max(wi.z, V(1e-9f));
                const V kept = select(lost, V(0), ggx.g2(wo, wi) / ggx.g1(wo));
                const V w = kept * V(turn.w[a]) * V(&cap.w[b], std::experimental::element_aligned), c = dot(wo, h);
                sums[0] += w;
                for (int slot = 1; slot < schlickSlot; ++slot) sums[slot] += w * fresnelDielectric(c, V(iorOfSlot(slot)));
                sums[schlickSlot] += w * schlickShape(c);
            }
        float* const cell = cells[row][column];
        cell[0] = std::experimental::reduce(sums[0]);
        for (int slot = 1; slot < slots; ++slot) {
            const float ior = iorOfSlot(slot), f0 = ior == 0 ? 0 : fresnelNormal(ior);
            const float mean = (std::experimental::reduce(sums[slot]) / cell[0] - f0) / (1 - f0);
            cell[slot] = (1 - mean) / guess(mu, alpha, ior);
        }
    }

    static float smoothAverage(const Gauss& mu, float ior) {
        double sum = 0;
        for (std::size_t i = 0; i < mu.x.size(); ++i) sum += 4.0 * mu.w[i] * cube(mu.x[i]) * shape(sqr(mu.x[i]), ior); // mu = x^2
        return float(sum);
    }
    static double cube(double x) noexcept { return x * x * x; }

    void fillAverages(int row, const Gauss& mu) {
        const float alpha = alphaOfRow(row);
        for (int slot = 0; slot < slots; ++slot) averages[row][slot] = 0;
        for (std::size_t i = 0; i < mu.x.size(); ++i) {
            const float m = sqr(mu.x[i]), weight = float(4 * mu.w[i] * cube(mu.x[i]));
            const float x = columnOf(m, alpha) * (columns - 1);
            const int c = std::min(int(x), columns - 2);
            const float f = x - float(c);
            for (int slot = 0; slot < slots; ++slot) {
                const float v = cells[row][c][slot] * (1 - f) + cells[row][c + 1][slot] * f;
                const float one = cells[row][c][0] * (1 - f) + cells[row][c + 1][0] * f;
                averages[row][slot] += weight * (slot == 0 ? v : one * (1 - v * guess(m, alpha, iorOfSlot(slot))));
            }
        }
        for (int slot = 1; slot < slots; ++slot) averages[row][slot] /= smoothAt(iorOfSlot(slot));
    }

    float smoothAt(float ior) const noexcept {
        if (ior == 0) return smoothSchlick;
        const float x = std::min(iorRoot(ior) / 0.95f, 1.f) * smoothNodes;
        const int i = std::min(int(x), smoothNodes - 1);
        return smooth[i] + (smooth[i + 1] - smooth[i]) * (x - float(i));
    }
};

const Tables& tables() noexcept {
    static const Tables t;
    return t;
}

float lerp(float a, float b, float f) noexcept { return a + (b - a) * f; }

constexpr float margin = AlbedoColumns::margin;
LayerAlbedo raised(const LayerAlbedo& a) noexcept { return {std::min(a.one + margin, 1.f), std::min(a.shape + margin, 1.f)}; }

} // namespace

AlbedoSlice::AlbedoSlice(float alpha, float ior) noexcept : alpha_(alpha), ior_(ior) {
    const Tables& t = tables();
    const float smooth = t.smoothAt(ior);
    average_ = {1, smooth};
    if (alpha == 0) return;
    const float y = clamp01((std::sqrt(std::sqrt(alpha)) - firstRoot) / (1 - firstRoot)) * (rows - 1);
    row_ = std::min(int(y), rows - 2);
    rowFraction_ = y - float(row_);
    const float z = ior == 0 ? float(schlickSlot) : std::clamp(iorRoot(ior) / iorStep, 1.f, float(iors));
    slot_ = ior == 0 ? schlickSlot - 1 : std::min(int(z), iors - 1);
    slotFraction_ = z - float(slot_);
    const auto* const a = t.averages[row_];
    const auto* const b = t.averages[row_ + 1];
    average_.one = lerp(a[0], b[0], rowFraction_);
    average_.shape = smooth * lerp(lerp(a[slot_], a[slot_ + 1], slotFraction_), lerp(b[slot_], b[slot_ + 1], slotFraction_), rowFraction_);
    average_ = raised(average_);
}

LayerAlbedo AlbedoSlice::at(float mu) const noexcept {
    if (alpha_ == 0) return {1, shape(mu, ior_)};
    const float x = std::min(columnOf(mu, alpha_), 1.f) * (columns - 1);
    const int c = std::min(int(x), columns - 2);
    const float f = x - float(c);
    const auto* const a = tables().cells[row_][c];
    const auto* const b = tables().cells[row_ + 1][c];
    const auto ratio = [&](const float* p) { return lerp(p[slot_], p[slot_ + 1], slotFraction_); };
    const float one = lerp(lerp(a[0], a[slots], f), lerp(b[0], b[slots], f), rowFraction_);
    const float q = lerp(lerp(ratio(a), ratio(a + slots), f), lerp(ratio(b), ratio(b + slots), f), rowFraction_);
    return raised({one, one * std::min(1.f, 1 - q * guess(mu, alpha_, ior_))});
}

float AlbedoSlice::one(float mu) const noexcept {
    if (alpha_ == 0) return 1;
    const float x = std::min(columnOf(mu, alpha_), 1.f) * (columns - 1);
    const int c = std::min(int(x), columns - 2);
    const float f = x - float(c);
    const auto* const a = tables().cells[row_][c];
    const auto* const b = tables().cells[row_ + 1][c];
    return std::min(lerp(lerp(a[0], a[slots], f), lerp(b[0], b[slots], f), rowFraction_) + margin, 1.f);
}

LayerAlbedo AlbedoSlice::average() const noexcept { return average_; }

void AlbedoSlice::fill(AlbedoColumns& to) const noexcept {
    for (int c = 0; c < columns; ++c) {
        const auto* const a = tables().cells[row_][c];
        const auto* const b = tables().cells[row_ + 1][c];
        const auto ratio = [&](const float* p) { return lerp(p[slot_], p[slot_ + 1], slotFraction_); };
        to.cells[c][0] = lerp(a[0], b[0], rowFraction_);
        to.cells[c][1] = lerp(ratio(a), ratio(b), rowFraction_);
    }
}

} // namespace chiaro
