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
    // The emissive triangles of one geometry under one placement (null: it lies in world space); returns the first light's number. motion:
    // of the scene, Lights::none at rest; what deforms has one.
    uint32_t addMesh(const Geometry&, uint32_t geometry, const Instance*, uint32_t instance, uint32_t motion);
    // motion: of the scene, Lights::none at rest.
    void addPunctual(const PunctualDesc&, const Vec3d& centre, float sceneRadius, uint32_t motion);
    void setEnvironment(const EnvironmentDesc&, float sceneRadius);
    void finish(const Executor* run = nullptr); // the tables and the tree

private:
    // Neither of two sides may round to nothing: a lamp on a wide plain under the sky has less than 2^-24 of its power.
    static constexpr double leastShare = 0x1p-10;
    // Lamps among which power alone chooses: then the tree costs more than it wins (docs/lights.md).
    static constexpr std::size_t few = 4;
    void plantTree(const Executor*);
    static std::size_t pieces(const Geometry&);
    std::size_t lamps_ = 0; // connected surfaces, and the punctual lights
    double meanEmission(const Lights::Triangle&) const;
    const Scene& scene_;
    Lights& lights_;
};

} // namespace chiaro
