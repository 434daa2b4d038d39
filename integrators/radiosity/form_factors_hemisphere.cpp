// A row by rays: points of the patch and directions by the cosine, sixteen at a time from the first number to the hit.
#include "integrators/radiosity/form_factors_sum.h"
#include "integrators/radiosity/patch_places.h"

namespace chiaro::radiosity {

void FormFactors::hemisphereRow(uint32_t i, uint32_t rays, uint32_t salt, std::vector<Factor>& row) const {
    constexpr uint32_t width = RayPacket::size;
    row.clear();
    RowSum<uint32_t>& sums = RowSum<uint32_t>::ofThread(patches_.size());
    const Sampler sampler(work_.seed, work_.sampler, Stream::prepass, hashCombine(i, 0x4e315u + salt), 0);
    const PatchRays source(patches_[i], sampler, patches_.time());
    const uint32_t batches = std::max(1u, (rays + width - 1) / width);
    RayPacket packet;
    std::array<Hit, width> hits;
    uint32_t closed = 0; // rays from where the patch is not open
    for (uint32_t b = 0; b < batches; ++b) {
        source.fill(b * width, packet);
        work_.scene.intersect(packet, hits, false);
        for (uint32_t k = 0; k < width; ++k) {
            if (!hits[k]) continue;
            const uint32_t j = patches_.seen(hits[k], {packet.dx[k], packet.dy[k], packet.dz[k]});
            if (j == ~0u)
                closed += patches_.unlit(hits[k]);
            else if (j != i)
                sums.add(j, 1);
        }
    }
    sums.drain(1.0 / std::max(1u, batches * width - closed), row);
}

} // namespace chiaro::radiosity
