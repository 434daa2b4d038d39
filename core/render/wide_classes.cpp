#include "core/render/wide_classes.h"

namespace chiaro {
namespace {

bool depthAlone(const PathClasses& classes) noexcept {
    if (!classes.layerNames().empty()) return false;
    PathState state = classes.eye();
    for (uint32_t depth = 0; depth <= unlimitedDepth; ++depth) {
        if (classes.sorts(state)) return false;
        for (int kind = 0; kind < lightKindCount; ++kind)
            if (classes.reached(state, LightKind(kind)) != otherLayer) return false;
        if (!classes.continues(state)) return depth == classes.maxDepth();
        const PathState next = classes.eye(state, Event::DR);
        for (int event = 0; event < eventCount; ++event)
            if (classes.eye(state, Event(event)) != next) return false;
        if (next == 0) return false;
        if (next == state) return classes.maxDepth() >= unlimitedDepth;
        state = next;
    }
    return false;
}

bool connects(const PathClasses& classes, PathState state) noexcept {
    for (const Event event : {Event::DR, Event::DT, Event::GR, Event::GT})
        for (int kind = 0; kind < lightKindCount; ++kind)
            if (classes.reached(classes.eye(state, event), LightKind(kind)) != 0) return true;
    return false;
}

} // namespace

WideClasses::WideClasses(const PathClasses& classes) : rows_(classes.states()), onlyDepth_(depthAlone(classes)) {
    for (std::size_t s = 0; s < rows_.size(); ++s) {
        const auto state = PathState(s);
        WideClass& row = rows_[s];
        for (int event = 0; event < eventCount; ++event) row.next[event] = classes.eye(state, Event(event));
        row.reached = 0;
        for (int kind = 0; kind < lightKindCount; ++kind) row.reached |= uint32_t(classes.reached(state, LightKind(kind))) << (8 * kind);
        if (classes.continues(state)) row.reached |= WideClass::continues;
        if (classes.sorts(state)) row.reached |= WideClass::sorts;
        if (connects(classes, state)) row.reached |= WideClass::connects;
        sorts_ = sorts_ || classes.sorts(state);
    }
}

} // namespace chiaro
