// A fingerprint of everything that decides a picture of a scene: pre-pass files and parts of a picture must not be mixed between scenes.
#pragma once
#include "core/scene/accel.h"
#include "core/scene/scene.h"

namespace chiaro {

// desc: what is left of the description after compilation moved its meshes, materials and pictures: punctual lights, environment.
uint64_t sceneHash(const Scene&, std::span<const Geometry>, std::span<const Instance>, const SceneDesc& desc);

} // namespace chiaro
