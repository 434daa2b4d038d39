// Look-ups of sixteen lanes at a time, for tests: one function for each instruction set, made from one template (wide_lookup_run.h).
#pragma once
#include "core/scene/light_tree_view.h"
#include "core/scene/scene.h"
#include "core/scene/sky.h"
#include "core/scene/wide_textures.h"

namespace chiaro::test {

struct alignas(64) LookupLanes {
    static constexpr uint32_t size = 16;
    // Asked: directions and random numbers for the sky, texture coordinates and the diameters of an ellipse on the triangle.
    float dx[size], dy[size], dz[size], ux[size], uy[size];
    uint32_t pick[size];
    float u[size], v[size], majorX[size], majorY[size], minorX[size], minorY[size];
    // Answered.
    float r[size], g[size], b[size], pdfW[size];
    float sampleX[size], sampleY[size], sampleZ[size], sampleR[size], sampleG[size], sampleB[size], samplePdf[size];
};
using SkyProgram = void(const Sky&, LookupLanes&);
// footprint: false, at the sharpness of the picture. The triangle's texture coordinates are (0, 0), (1, 0), (0, 1).
using TextureProgram = void(const WideTexture&, bool footprint, uint32_t lanes, LookupLanes&);
// Points, the normals of their surfaces, 32 random bits; the lights that a tree chooses, and with which probabilities.
struct alignas(64) TreeLanes {
    static constexpr uint32_t size = 16;
    float px[size], py[size], pz[size], nx[size], ny[size], nz[size];
    uint32_t pick[size], light[size];
    float pmf[size];
};
using TreeProgram = void(const LightTreeView&, uint32_t lanes, TreeLanes&);
TreeProgram treeAvx2, treeAvx512;
SkyProgram skyAvx2, skyAvx512;
TextureProgram textureAvx2, textureAvx512;

} // namespace chiaro::test
