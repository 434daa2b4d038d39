#include "core/scene/scene_bytes.h"
#include <algorithm>

namespace chiaro {

SceneForecast forecast(const SceneSizes& s) noexcept {
    // Bytes of Embree 3.13's hierarchies with the robust flag and the default quality, measured from 36 to 8 million triangles: 68 to 75 a
    // triangle, 132 while it is built; 700 an instance. Of light tables: 96 a triangle of one large lamp, 125 of many small ones.
    constexpr std::size_t hierarchy = 75, building = 140, instance = 800, placement = 250, light = 140, lightBuilding = 200, index = 12;
    constexpr std::size_t sky = 24, skyBuilding = 56; // a texel: radiance and its table; what makes them
    constexpr std::size_t material = 2250;            // its description, in an array that grew by doubling, and the record of its closures
    SceneForecast f;
    f.kept.geometry = s.vertexBytes + s.triangles * index;
    f.kept.hierarchy = s.triangles * hierarchy + s.instances * instance;
    f.kept.placement = s.instances * placement;
    f.kept.lights = s.emissive * light + s.skyTexels * sky;
    f.kept.materials = s.materials * material;
    // Three channels are kept as four, and the levels of the pyramid take a third; the largest picture is there twice while it is laid out.
    f.kept.textures = s.textureBytes / 9 * 16;
    const std::size_t reading = f.kept.geometry + s.textureBytes + s.fileBytes;
    const std::size_t filtering = f.kept.geometry + f.kept.textures + s.textureBytes;
    const std::size_t lighting = f.kept.total() - f.kept.hierarchy + s.emissive * lightBuilding + s.skyTexels * skyBuilding;
    const std::size_t committing = f.kept.total() + s.triangles * (building - hierarchy);
    f.most = std::max({reading, filtering, lighting, committing});
    return f;
}

} // namespace chiaro
