// What a scene takes in memory, by part: counted for one that is compiled, foretold for one of which only the headers of its file were
// read, so that what does not fit is refused before it is begun.
#pragma once
#include <cstddef>
#include <cstdint>

namespace chiaro {

struct SceneBytes {
    std::size_t geometry = 0;  // vertices and indices of the triangles that are stored
    std::size_t hierarchy = 0; // Embree's, of meshes and of instances
    std::size_t placement = 0; // instances, motions, what is drawn where
    std::size_t lights = 0;    // tables of emissive triangles, punctual lights and the environment
    std::size_t materials = 0; // as they are described, and what their closures share
    std::size_t textures = 0;  // decoded
    std::size_t total() const noexcept { return geometry + hierarchy + placement + lights + materials + textures; }
};

// What the headers tell.
struct SceneSizes {
    uint64_t vertexBytes = 0; // of all attributes, as they are kept
    uint64_t triangles = 0;   // stored: once a mesh, however often it is drawn
    uint64_t emissive = 0;    // emissive triangles that are drawn
    uint64_t instances = 0;
    uint64_t materials = 0;
    std::size_t textureBytes = 0;
    uint64_t skyTexels = 0;    // of the environment
    std::size_t fileBytes = 0; // held while the rest is read
};
struct SceneForecast {
    SceneBytes kept;
    std::size_t most = 0; // at the worst moment of loading
};
// An estimate from above, about a tenth more than what scenes were measured to take.
SceneForecast forecast(const SceneSizes&) noexcept;

} // namespace chiaro
