#include "core/scene/motion.h"
#include <algorithm>

namespace chiaro {
namespace {

using Key = Motion::Key;

// Where the cosine of half the turn between two keys is above this, Embree interpolates the quaternions linearly and makes them unit again;
// below, it evaluates the great arc with approximate functions.
constexpr double nearlyAligned = 0.9995;
constexpr double finestHalfTurn = 0.028; // radians; cosine 0.99961, beyond doubt on the side of the linear formula
// Embree's rotations against ours, measured over all its instruction sets: at most 5 and 40 times 2^-24 in an entry.
constexpr float slackLinear = 16 * 0x1p-24f, slackArc = 128 * 0x1p-24f;

// From a rotation matrix with columns x, y, z (Shepperd 1978): divides by the largest component.
void quaternion(const Vec3d& x, const Vec3d& y, const Vec3d& z, double (&q)[4]) noexcept {
    const double four[4] = {1 + x.x + y.y + z.z, 1 + x.x - y.y - z.z, 1 - x.x + y.y - z.z, 1 - x.x - y.y + z.z};
    const auto largest = std::max_element(four, four + 4) - four;
    const double l = std::sqrt(four[largest]) / 2, s = 1 / (4 * l);
    const double wx = (y.z - z.y) * s, wy = (z.x - x.z) * s, wz = (x.y - y.x) * s;
    const double xy = (x.y + y.x) * s, xz = (z.x + x.z) * s, yz = (y.z + z.y) * s;
    const double all[4][4] = {{l, wx, wy, wz}, {wx, l, xy, xz}, {wy, xy, l, yz}, {wz, xz, yz, l}};
    std::copy(all[largest], all[largest] + 4, q);
}

// M = T R S by Gram-Schmidt on the columns: R has determinant +1, the sign of M's is that of the last diagonal entry of S.
Key decompose(const Affine& m) noexcept {
    const auto column = [&m](int j) { return Vec3d{m.m[0][j], m.m[1][j], m.m[2][j]}; };
    Key k;
    k.translation = column(3);
    const Vec3d a = column(0), b = column(1), c = column(2);
    k.stretch[0][0] = length(a);
    const Vec3d x = a * (1 / k.stretch[0][0]);
    k.stretch[0][1] = dot(x, b);
    const Vec3d rest = b - x * k.stretch[0][1];
    k.stretch[1][1] = length(rest);
    const Vec3d y = normalize(rest - x * dot(x, rest)); // twice: nearly parallel columns lose digits
    const Vec3d z = cross(x, y);
    k.stretch[0][2] = dot(x, c);
    k.stretch[1][2] = dot(y, c);
    k.stretch[2][2] = dot(z, c);
    quaternion(x, y, z, k.rotation);
    return k;
}

double cosineBetween(const Key& a, const Key& b) noexcept {
    double sum = 0;
    for (int i = 0; i < 4; ++i) sum += a.rotation[i] * b.rotation[i];
    return sum;
}

// f of the way from a to b, whose quaternions lie in one hemisphere.
enum class Turn { arc, asTraced };
Key between(const Key& a, const Key& b, double f, Turn how) noexcept {
    Key k;
    k.translation = a.translation * (1 - f) + b.translation * f;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j) k.stretch[i][j] = a.stretch[i][j] * (1 - f) + b.stretch[i][j] * f;
    const double cosine = std::min(cosineBetween(a, b), 1.0), angle = std::acos(cosine);
    double u = 1 - f, v = f;
    if (cosine <= nearlyAligned || (how == Turn::arc && angle > 1e-6)) {
        u = std::sin((1 - f) * angle) / std::sin(angle);
        v = std::sin(f * angle) / std::sin(angle);
    }
    double squares = 0;
    for (int i = 0; i < 4; ++i) squares += sqr(k.rotation[i] = u * a.rotation[i] + v * b.rotation[i]);
    for (double& q : k.rotation) q /= std::sqrt(squares);
    return k;
}

// Key 0 and the ends of so many equal segments.
std::vector<Key> resampled(const std::vector<Key>& keys, std::size_t segments) {
    std::vector<Key> all;
    for (std::size_t i = 0; i <= segments; ++i) {
        const double place = double(i) * double(keys.size() - 1) / double(segments);
        const std::size_t first = std::min(std::size_t(place), keys.size() - 2);
        all.push_back(between(keys[first], keys[first + 1], place - double(first), Turn::arc));
    }
    return all;
}

Affine matrixBetween(const Affine& a, const Affine& b, double f) noexcept {
    Affine m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) m.m[i][j] = a.m[i][j] * (1 - f) + b.m[i][j] * f;
    return m;
}

Affine map(const Key& a, const Key& b, double f, Turn how) noexcept {
    if (fault(Fault::motionByMatrix)) return matrixBetween(Motion::compose(a), Motion::compose(b), f);
    return Motion::compose(between(a, b, f, how));
}

} // namespace

Affine Motion::compose(const Key& k) noexcept {
    const auto [w, x, y, z] = k.rotation;
    const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    const double t[3] = {k.translation.x, k.translation.y, k.translation.z};
    Affine m;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) m.m[i][j] = r[i][0] * k.stretch[0][j] + r[i][1] * k.stretch[1][j] + r[i][2] * k.stretch[2][j];
        m.m[i][3] = t[i];
    }
    return m;
}

Motion::Motion(std::span<const Affine> maps, Interval over) : over_(over), clock_(over), slack_(slackLinear) {
    double widest = 0; // half of the largest turn
    for (const Affine& m : maps) {
        Key k = decompose(m);
        if (!keys_.empty()) {
            if (cosineBetween(keys_.back(), k) < 0) // the short way round
                for (double& q : k.rotation) q = -q;
            widest = std::max(widest, std::acos(std::min(cosineBetween(keys_.back(), k), 1.0)));
        }
        keys_.push_back(k);
    }
    if (fault(Fault::motionByMatrix)) return;
    const std::size_t segments = keys_.size() - 1, most = mostKeys - 1;
    const auto wanted = std::size_t(std::max(1.0, std::ceil(widest / finestHalfTurn)));
    const std::size_t parts = std::clamp(wanted, std::size_t(1), std::max(most / segments, std::size_t(1)));
    if (wanted > parts || segments > most) slack_ = slackArc;
    if (segments > most || parts > 1) keys_ = resampled(keys_, std::min(segments * parts, most));
}

Affine Motion::exact(double time) const noexcept {
    if (keys_.empty()) return {};
    const double length = double(over_.close) - double(over_.open);
    const double share = fault(Fault::shutterStuck) ? 0 : std::clamp((time - double(over_.open)) / length, 0.0, 1.0);
    const double place = share * double(keys_.size() - 1);
    const std::size_t first = std::min(std::size_t(place), keys_.size() - 2);
    return map(keys_[first], keys_[first + 1], place - double(first), Turn::arc);
}

AffineT<float> Motion::at(float time) const noexcept {
    if (keys_.empty()) return {};
    const float place = clock_.share(time) * float(keys_.size() - 1);
    const std::size_t first = std::min(std::size_t(place), keys_.size() - 2);
    const Affine m = map(keys_[first], keys_[first + 1], double(place - float(first)), Turn::asTraced);
    AffineT<float> r;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) r.m[i][j] = float(m.m[i][j]);
    return r;
}

} // namespace chiaro
