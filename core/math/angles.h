// Angles of directions, written once for one path and for sixteen lanes (core/math/number.h): the same bits in both.
#pragma once
#include "core/math/vec.h"

namespace chiaro {

// atan2(y, x): the quotient brought within tan(pi/8) by the angle sum, then the minimax polynomial of Cephes (Moshier 1992). Error below
// 3e-7 radians; 0 where both are 0.
template <class T> [[gnu::always_inline]] inline T arcTangent(const T& y, const T& x) noexcept {
    using R = Real<T>;
    const T ax = abs(x), ay = abs(y), high = max(ax, ay), low = min(ax, ay), zero = R(0);
    const auto beyond = low > high * T(R(0.414213562));
    const T numerator = select(beyond, low - high, low), denominator = select(beyond, low + high, high);
    const T t = numerator / select(denominator == zero, T(R(1)), denominator), z = t * t;
    const T p = ((T(R(8.05374449538e-2)) * z - T(R(1.38776856032e-1))) * z + T(R(1.99777106478e-1))) * z - T(R(3.33329491539e-1));
    T angle = (p * z) * t + t;
    angle = select(beyond, angle + T(R(std::numbers::pi / 4)), angle);
    angle = select(ay > ax, T(R(std::numbers::pi / 2)) - angle, angle);
    angle = select(x < zero, T(R(std::numbers::pi)) - angle, angle);
    return copysign(angle, y);
}

} // namespace chiaro
