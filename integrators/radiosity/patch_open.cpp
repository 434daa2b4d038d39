#include "integrators/radiosity/patch_open.h"
#include "integrators/radiosity/patch_places.h"
#include <array>

namespace chiaro::radiosity {
namespace {

constexpr uint32_t first = 32, more = 1024; // rays of a patch, and of one that is open in part

Open openOf(const Work& work, const Patches& patches, uint32_t i) {
    const Patch& p = patches[i];
    const PatchRays source(p, Sampler(0, SamplerKind::sobol, Stream::prepass, hashCombine(0x09e2u, i), 0), patches.time());
    RayPacket rays;
    std::array<Hit, RayPacket::size> hits;
    uint32_t done = 0, closed = 0;
    Vec3d sum; // of the open points, from the centre
    for (uint32_t wanted = first; done < wanted; done += RayPacket::size) {
        source.fill(done, rays);
        work.scene.intersect(rays, hits, false);
        for (std::size_t k = 0; k < hits.size(); ++k) {
            if (patches.unlit(hits[k]) && patches.seen(hits[k], {rays.dx[k], rays.dy[k], rays.dz[k]}) == ~0u)
                ++closed;
            else
                sum = sum + cast<double>(Vec3{rays.ox[k], rays.oy[k], rays.oz[k]} - p.centre);
        }
        if (closed > 0) wanted = more;
    }
    if (closed == 0 || closed == done) return {closed == 0 ? 1 : 0.5f / float(done), p.centre};
    return {float(done - closed) / float(done), p.centre + cast<float>(sum * (1.0 / (done - closed)))};
}

} // namespace

std::vector<Open> openParts(const Work& work, const Patches& patches) {
    std::vector<Open> parts(patches.size());
    for (uint32_t i = 0; i < patches.size(); ++i) parts[i].centre = patches[i].centre;
    if (work.scene.lights().count() == 0) return parts;
    work.run.chunks(
        patches.size(), [&](uint64_t i) { parts[i] = openOf(work, patches, uint32_t(i)); }, &work.stop);
    return parts;
}

} // namespace chiaro::radiosity
