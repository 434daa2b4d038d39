// The name of a light by its number, as `chiaro info` calls it: that of a point light, or the material of a lamp.
#pragma once
#include "core/render/path_log.h"
#include "core/scene/scene.h"
#include <string>

namespace chiaro::cli {

std::string materialName(const Scene&, uint32_t id); // "material 3" where it has none

class LightNames {
public:
    explicit LightNames(const Scene&);
    LightKind kind(uint32_t light) const;
    // Of the light of this vertex; from: the vertex that it was reached from. A triangle does not know its material, but a ray to it does.
    std::string name(const PathLog::Vertex&, const PathLog::Vertex* from) const;

private:
    const Scene& scene_;
    std::vector<std::string> meshes_, others_; // others: in the order of their numbers
    uint64_t triangles_ = 0;                   // the first lights
    bool environment_ = false;                 // the last one
};

} // namespace chiaro::cli
