#include "tools/bake/site_field.h"
#include "core/render/error.h"

namespace chiaro::bake {

SiteField::SiteField(std::shared_ptr<const Prepass> field, const PathClasses& rays, const PathClasses& solved, bool behind)
    : field_(std::move(field)), solved_(solved), standsFor_(rays.states(), 0) {
    std::vector<PathState> found{rays.eye()};
    std::vector<bool> seen(rays.states());
    seen[0] = seen[rays.eye()] = true;
    standsFor_[rays.eye()] = behind ? solved.eye(solved.eye(), Event::DR) : solved.eye();
    for (std::size_t i = 0; i < found.size(); ++i)
        for (int e = 0; e < eventCount; ++e) {
            const PathState next = rays.eye(found[i], Event(e)), meant = solved.eye(standsFor_[found[i]], Event(e));
            if (next == 0) continue;
            if (seen[next] && standsFor_[next] != meant)
                throw Error(Exit::internal, "the light paths of the bake cannot be told apart as its pre-pass tells them");
            if (seen[next]) continue;
            seen[next] = true;
            standsFor_[next] = meant;
            found.push_back(next);
        }
}

void SiteField::addIndirect(const PathClasses&, const Hit& hit, const SurfacePoint& at, const Bsdf& bsdf, PathState eye,
                            const Spectrum& weight, Outputs& out) const noexcept {
    if (const PathState meant = standsFor_[eye]) field_->addIndirect(solved_, hit, at, bsdf, meant, weight, out);
}

} // namespace chiaro::bake
