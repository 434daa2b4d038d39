// What a LightTree is made of, for loops over lanes that go down it for many points at once (core/scene/wide_light_tree.h).
#pragma once
#include "core/scene/light_tree.h"

namespace chiaro {

struct LightTreeView {
    const LightTree::Node* nodes = nullptr; // the root first; null: there is no tree
    const LightTree::Member* members = nullptr;
    uint32_t patch = 0, leaf = 0; // children from here on: the first member of a patch, a light
};
LightTreeView viewOf(const LightTree&) noexcept;

} // namespace chiaro
