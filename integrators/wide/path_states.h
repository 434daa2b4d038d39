// What the states of sixteen paths say: rows of WideClasses in registers. For files compiled for one instruction set
// (core/math/wide_lanes.h).
#pragma once
#include "core/math/wide_lanes.h"
#include "core/render/wide_classes.h"

namespace chiaro::CHIARO_ISA {

struct WideStates {
    Int diffuse, glossy, specular; // the next states: reflected in the lower half, transmitted in the upper one
    Int bits;                      // WideClass::reached

    CHIARO_LANE void load(const WideClass* rows, Int state, Mask m) noexcept {
        alignas(64) uint32_t at[laneCount];
        select(m, state << 2, Int(0u)).store(at);
        Float row[4];
        loadFour(reinterpret_cast<const float*>(rows), at, row[0], row[1], row[2], row[3]);
        diffuse = floatAsBits(row[0]), glossy = floatAsBits(row[1]), specular = floatAsBits(row[2]), bits = floatAsBits(row[3]);
    }
    CHIARO_LANE Mask are(uint32_t bit) const noexcept { return (bits & Int(bit)) != Int(0u); }
    CHIARO_LANE static Int reflected(Int next) noexcept { return next & Int(0xffffu); }
    CHIARO_LANE static Int transmitted(Int next) noexcept { return next >> 16; }

    // The kinds of lights as places of their layers in WideClass::reached.
    static constexpr uint32_t area = 8 * uint32_t(LightKind::area), delta = 8 * uint32_t(LightKind::delta),
                              environment = 8 * uint32_t(LightKind::environment);
    CHIARO_LANE Int layer(Int kind) const noexcept { return (bits >> kind) & Int(0xffu); }
    CHIARO_LANE static Int layer(const WideClass* rows, Int state, Int kind, Mask m) noexcept {
        return (gather(&rows->reached, state << 2, m) >> kind) & Int(0xffu);
    }
};

} // namespace chiaro::CHIARO_ISA
