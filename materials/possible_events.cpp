#include "materials/possible_events.h"
#include "materials/lobes.h"

namespace chiaro {
namespace {

// S, G or both, on one side.
LetterSet specular(float roughness, bool textured, Event smooth, Event rough) noexcept {
    const bool isSmooth = sqr(roughness) < Lobes::smallestAlpha;
    return LetterSet((textured || isSmooth ? letter(smooth) : 0) | (isSmooth ? 0 : letter(rough)));
}
LetterSet base(const MaterialDesc& m, Event smooth, Event rough) noexcept {
    if (m.specularGlossiness) // a texture only makes it rougher
        return m.specularGlossinessTexture.texture >= 0 ? LetterSet(letter(rough) | specular(1 - m.glossiness, false, smooth, rough))
                                                        : specular(1 - m.glossiness, false, smooth, rough);
    return specular(m.roughness, m.metallicRoughnessTexture.texture >= 0, smooth, rough);
}
LetterSet layers(const MaterialDesc& m) noexcept {
    LetterSet all = 0;
    if (m.clearcoat > 0) all |= specular(m.clearcoatRoughness, m.clearcoatRoughnessTexture.texture >= 0, Event::SR, Event::GR);
    if (maxComponent(m.sheenColor) > 0) all |= letter(Event::GR);
    return all;
}

} // namespace

LetterSet possibleEvents(const MaterialDesc& m) noexcept {
    if (m.unlit) return 0;
    const LetterSet reflected = base(m, Event::SR, Event::GR);
    if (m.specularGlossiness) return LetterSet(letter(Event::DR) | reflected | layers(m));
    LetterSet all = layers(m);
    if (m.metallic > 0) all |= reflected;
    if (m.metallic >= 1 && m.metallicRoughnessTexture.texture < 0) return all;
    if (m.transmission > 0) all |= reflected | base(m, Event::ST, Event::GT);
    const bool coats = m.specular > 0 || m.iridescence > 0;
    if (m.transmission < 1 || m.transmissionTexture.texture >= 0) {
        const bool through = m.diffuseTransmission > 0, back = m.diffuseTransmission < 1 || m.diffuseTransmissionTexture.texture >= 0;
        all |= LetterSet((back ? letter(Event::DR) : 0) | (through ? letter(Event::DT) : 0)) | (coats ? reflected : LetterSet(0));
    }
    return all;
}

LetterSet possibleLetters(const Scene& scene) noexcept {
    LetterSet all = 0;
    for (const MaterialDesc& m : scene.materials()) all |= possibleEvents(m);
    if (scene.counts().emissiveTriangles > 0) all |= letter(LightKind::area);
    if (scene.counts().punctualLights > 0) all |= letter(LightKind::delta);
    if (scene.lights().hasEnvironment()) all |= letter(LightKind::environment);
    return all;
}

} // namespace chiaro
