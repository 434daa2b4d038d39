#include "materials/possible_events.h"
#include "materials/lobes.h"

namespace chiaro {
namespace {

// S, G or both, on one side.
LetterSet specular(const MaterialDesc& m, Event smooth, Event rough) noexcept {
    const bool textured = m.metallicRoughnessTexture.texture >= 0, isSmooth = sqr(m.roughness) < Lobes::smallestAlpha;
    return LetterSet((textured || isSmooth ? letter(smooth) : 0) | (isSmooth ? 0 : letter(rough)));
}

} // namespace

LetterSet possibleEvents(const MaterialDesc& m) noexcept {
    if (m.unlit) return 0;
    const LetterSet reflected = specular(m, Event::SR, Event::GR);
    LetterSet all = m.metallic > 0 ? reflected : LetterSet(0);
    if (m.metallic >= 1 && m.metallicRoughnessTexture.texture < 0) return all;
    if (m.transmission > 0) all |= reflected | specular(m, Event::ST, Event::GT);
    if (m.transmission < 1 || m.transmissionTexture.texture >= 0) all |= letter(Event::DR) | (m.specular > 0 ? reflected : LetterSet(0));
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
