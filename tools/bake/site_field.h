// SiteField: the field of a pre-pass as the rays of a baker see it. A pre-pass is solved for pictures: its path classes count from the eye.
// A baker's rays begin at a site that is itself the last scattering (D) before the eye, and have classes of their own. Instead of a
// solution of its own, the baker translates: every state of its rays' automaton stands for one of the solution's, the one that the same
// events reach behind that scattering. One solution then serves pictures and bakes alike, in memory and in a file.
#pragma once
#include "core/render/prepass.h"
#include <memory>
#include <vector>

namespace chiaro::bake {

class SiteField final : public Prepass {
public:
    // rays: the classes of the baker's rays; solved: those of the field, which lives as long. behind: the site is a scattering of its own;
    // else the rays look at it as an eye does. Error(Exit::internal) where a state would stand for two.
    SiteField(std::shared_ptr<const Prepass> field, const PathClasses& rays, const PathClasses& solved, bool behind);
    void addIndirect(const PathClasses&, const Hit&, const SurfacePoint&, const Bsdf&, PathState eye, const Spectrum& weight,
                     Outputs&) const noexcept override;
    void solve(const Work&) override {} // it is
    void save(Writer& to) const override { field_->save(to); }
    void load(const Work&, Reader&) override {}

private:
    std::shared_ptr<const Prepass> field_;
    const PathClasses& solved_;
    std::vector<PathState> standsFor_; // one a state of the rays
};

} // namespace chiaro::bake
