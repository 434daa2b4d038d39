#include "core/scene/wide_textures.h"
#include "core/render/fault.h"
#include "core/render/in_parallel.h"
#include "core/scene/accel.h"
#include "core/scene/ray_cone.h"
#include "core/scene/scene.h"
#include "core/scene/wide_surfaces.h"
#include <cstring>

namespace chiaro {

WideTextures::WideTextures(const Scene& scene, const WideSurfaces& surfaces, const Executor* run) : filtered_(scene.textures().filtered()) {
    ofMaterial_.assign(scene.materials().size(), 0);
    for (uint32_t id = 0; id < scene.materials().size(); ++id)
        if (scene.material(id).baseColorTexture.texture >= 0) addTexture(scene, id);
    std::size_t triangles = 0, records = 0;
    for (const Geometry& g : scene.geometries_) {
        const TextureSlot& slot = scene.material(g.material).baseColorTexture;
        const bool mapped = slot.texture >= 0 && !g.uv[slot.uvSet].empty();
        firsts_.push_back(mapped ? uint32_t(triangles) : none);
        if (mapped) triangles += g.triangles();
        records += g.triangles();
    }
    uvs_.resize(8 * std::max<std::size_t>(triangles, 1));
    float* to = uvs_.data();
    for (std::size_t k = 0; k < scene.geometries_.size(); ++k) {
        if (firsts_[k] == none) continue;
        const Geometry& g = scene.geometries_[k];
        const std::vector<Point2>& uv = g.uv[scene.material(g.material).baseColorTexture.uvSet];
        for (uint32_t i = 0; i < g.triangles(); ++i, to += 8)
            for (int c = 0; c < 3; ++c) to[2 * c] = uv[g.triangle(i)[c]].x, to[2 * c + 1] = uv[g.triangle(i)[c]].y;
    }
    if (!filtered_) return;
    curvatures_.assign(records, 0);
    const std::vector<WideSurfaces::Block> blocks = surfaces.blocks(scene);
    inParallel(run, blocks.size(), [&](uint64_t b) {
        const std::size_t k = blocks[b].geometry;
        if (scene.geometries_[k].normals.empty()) return;
        SurfacePoint at;
        at.geometry = uint32_t(k);
        for (at.triangle = blocks[b].begin; at.triangle < blocks[b].end; ++at.triangle)
            curvatures_[surfaces.firsts()[k] + at.triangle] = scene.curvature(at);
    });
}

void WideTextures::addTexture(const Scene& scene, uint32_t material) {
    const TextureSlot& slot = scene.material(material).baseColorTexture;
    const TextureDesc& desc = scene.textures().textures()[slot.texture];
    const TexelStore& store = scene.textures().images()[desc.image];
    const Transfer transfer = fault(Fault::baseColorNotDecoded) ? Transfer::linear : Transfer::srgb;
    WideTexture t{};
    const auto levels = store.levels(transfer);
    for (std::size_t i = 0; i < levels.size(); ++i) {
        t.width[i] = levels[i].width, t.height[i] = levels[i].height;
        t.across[i] = levels[i].across, t.first[i] = levels[i].first;
    }
    t.last = uint32_t(levels.size() - 1);
    t.data = store.data();
    if (transfer == Transfer::srgb && store.type() == PixelType::u8) t.decoded = decoding8(transfer);
    if (transfer == Transfer::srgb && store.type() == PixelType::u16) t.decoded = decoding16(transfer);
    if (store.type() == PixelType::f16) t.decoded = decodingHalf();
    std::memcpy(t.transform, slot.transform, sizeof t.transform);
    t.tileX = store.tileX(), t.tileY = store.tileY(), t.texelBytes = store.texelBytes();
    t.channels = store.channels();
    t.type = store.type();
    t.wrapS = desc.wrapS, t.wrapT = desc.wrapT;
    t.nearest = desc.filter == TextureFilter::nearest;
    t.alone = store.bytes() >= (std::size_t(1) << 33) || fault(Fault::filterBeforeDecode);
    ofMaterial_[material] = uint32_t(textures_.size());
    textures_.push_back(t);
}

std::size_t WideTextures::bytes() const noexcept {
    return textures_.size() * sizeof(WideTexture) + (ofMaterial_.size() + firsts_.size()) * sizeof(uint32_t) +
           (uvs_.size() + curvatures_.size()) * sizeof(float);
}

} // namespace chiaro
