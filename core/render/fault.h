// Planted faults: single bugs of the kind that renderers really have, switched on at run time to prove that the tests find them (mutation
// testing; DeMillo, Lipton, Sayward 1978). They exist only in the copy of the libraries that the test program chiaro_tests_planted is
// linked with: everywhere else fault() is the constant false and the compiler drops what it guards. tests/planted/ says for each fault
// what it breaks and which check must find it.
#pragma once
#include <cstdint>

namespace chiaro {

enum class Fault : uint8_t {
    none,
    // lights
    lightPdfNotConverted,
    receiverCosineMissing,
    lampCosineMissing,
    lampTwoSided,
    lightChoiceForgotten,
    lightPowerBias,
    spotHalfAngle,
    candelaAsLumen,
    emissiveStrengthIgnored,
    skySineMissing,
    skyHalfTexel,
    skyQuarterTurn,
    // transport
    offsetAbsolute,
    shadowRayShort,
    emissionTwice,
    deltaWeighted,
    misOtherMeasure,
    rouletteUnweighted,
    depthOffByOne,
    bounceDropped,
    // materials
    diffuseBias,
    glossyBias,
    etaSquaredMissing,
    etaRatioWhenLeaving,
    totalReflectionMissing,
    absorptionPerBounce,
    alphaIsRoughness,
    visiblePdfByNormals,
    coatAdded,
    // surfaces and textures
    baseColorNotDecoded,
    filterBeforeDecode,
    normalGreenFlipped,
    normalsByMatrix,
    backNormalKept,
    alphaCutoffOpen,
    blendTwice,
    // film and samples
    pixelCorner,
    seedsShared,
    sumsInFloat,
    // lens and importance
    lensNotUniform,
    focusAlongRay,
    importanceCosine,
    emittedFluxBias,
    adjointMissing,
    // motion
    shutterStuck,
    motionByMatrix,
    // ray trees
    branchUnweighted,
    lampShadowsItself,
    shadowUntinted,
    splitUnweighted,
    occlusionUniform,
    // photons
    photonPowerBias,
    photonDensityBias,
    photonDirectTwice,
    photonRadiusFixed,
    photonCausticTwice,
    // radiosity
    formFactorTransposed,
    formFactorHorizon,
    unshotForgotten,
    pullWithoutArea,
    radiosityDirectTwice,
    reflectanceOfOtherSide,
    count
};

#ifdef CHIARO_PLANT_FAULTS
inline Fault plantedFault = Fault::none; // set between renderings only
inline bool fault(Fault f) noexcept { return plantedFault == f; }
#else
constexpr bool fault(Fault) noexcept { return false; }
#endif

} // namespace chiaro
