// The textures by which a material varies over a surface, with the transfer function under which each is read: one list for whoever asks
// what a texture is for. Emission and opacity are not in it: they are read at full sharpness, so that light samples and hits agree.
#pragma once
#include "core/scene/desc.h"

namespace chiaro {

template <class F> void forEachSlot(const MaterialDesc& m, F&& f) {
    if (m.unlit) return;
    for (const TextureSlot* s : {&m.baseColorTexture, &m.specularColorTexture, &m.sheenColorTexture, &m.diffuseTransmissionColorTexture,
                                 &m.specularGlossinessTexture})
        f(*s, Transfer::srgb);
    for (const TextureSlot* s :
         {&m.metallicRoughnessTexture, &m.normalTexture, &m.specularTexture, &m.transmissionTexture, &m.clearcoatTexture,
          &m.clearcoatRoughnessTexture, &m.clearcoatNormalTexture, &m.sheenRoughnessTexture, &m.anisotropyTexture, &m.iridescenceTexture,
          &m.iridescenceThicknessTexture, &m.diffuseTransmissionTexture})
        f(*s, Transfer::linear);
}

} // namespace chiaro
