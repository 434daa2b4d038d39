// Builds the light tables of a compiled scene: emissive triangles with the power of their textures, punctual lights, the environment.
#pragma once
#include "core/scene/accel.h"
#include "core/scene/scene.h"

namespace chiaro {

class Executor;

class LightsBuilder {
public:
    // geometries, materials and textures of the scene must be in place; `lights` is the scene's own, emission look-ups go through it.
    LightsBuilder(const Scene& scene, Lights& lights) : scene_(scene), lights_(lights) { lights_.scene_ = &scene; }
    // The emissive triangles of one geometry under one placement (null: it lies in world space); returns the first light's number.
    uint32_t addMesh(const Geometry&, uint32_t geometry, const Instance*, uint32_t instance);
    // motion: of the scene, Lights::none at rest.
    void addPunctual(const PunctualDesc&, const Vec3d& centre, float sceneRadius, uint32_t motion);
    void setEnvironment(const EnvironmentDesc&, float sceneRadius);
    void finish(const Executor* run = nullptr); // the tables and the tree

private:
    void plantTree(const Executor*);
    double meanEmission(const Lights::Triangle&) const;
    const Scene& scene_;
    Lights& lights_;
};

} // namespace chiaro
