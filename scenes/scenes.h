// The functions behind the list of built-in scenes, one a file. Internal to this folder: everybody else uses scenes/builtin.h.
#pragma once
#include "core/scene/desc.h"

namespace chiaro {

SceneDesc makeCornell();
SceneDesc makeCornellSpheres();
SceneDesc makeVeachMis();
SceneDesc makeCaustic();
SceneDesc makeFurnace();
SceneDesc makePlayground();
SceneDesc makeGallery();
void animatePlayground(SceneDesc&, double frameTime, Interval shutter);

// The measured room without its blocks: walls, lamp and camera; the index of its white material comes back in `white`.
SceneDesc cornellRoom(int& white);

} // namespace chiaro
