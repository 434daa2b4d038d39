// The links of hierarchical radiosity: which nodes of a tree exchange light as wholes, and their form factors (solve_links.h says by what
// rule). Both ways between two nodes are judged by the same rays; where the one is good enough it is done, and the other goes on alone.
#pragma once
#include "integrators/radiosity/form_factors.h"
#include "integrators/radiosity/hierarchy.h"

namespace chiaro::radiosity {

struct Link {
    uint32_t to = 0, from = 0;
    float factor = 0; // from the receiver's side: F of `to` towards `from`
};

class Linker {
public:
    Linker(const Work&, const FormFactors&, const Hierarchy&);
    // All links for radiosities and irradiances of patches like these; empty answer: stopped. What a link may get wrong is a share of what
    // arrives where it ends, but never more than that of a patch in the mean light: a dim room beside a bright place has an error of its
    // own. Throws Error(Exit::resources) where they need more than the memory limit.
    std::vector<Link> link(std::span<const Light> radiosity, std::span<const double> arrives, const System& system, double linkError);
    std::size_t bytes() const noexcept { return places_.size() * sizeof(Places); }

private:
    static constexpr int points = 4, pairs = points * points; // of a node, and between two
    enum : uint8_t { toFirst = 1, toSecond = 2, bothWays = 3 };
    struct Pair {
        uint32_t first, second;
        uint8_t ways;
    };
    struct Exchange {
        float range = 0;  // of F between points of the receiver
        float across = 0; // of F towards the parts of the sender, times their number
        float factor = 0; // F
    };
    struct Between;
    // Places on a node: one of a few sets, made once.
    struct Places {
        float x[points], y[points], z[points], nx[points], ny[points], nz[points], open[points];
    };
    Places placesOn(uint32_t node, uint32_t variant) const noexcept;
    std::pair<const Places&, const Places&> placesOf(const Pair&) const noexcept;
    void compareLight(std::span<const double> arrives, const System&);
    void refine(Pair, std::vector<Link>&, std::vector<Pair>& open) const;
    std::vector<Link> refineAll() const;
    Between between(const Pair&) const noexcept;
    void shoot(const Pair&, Between&) const noexcept;
    bool tooMuch(const Pair&, float ofFirst, float ofSecond) const noexcept;
    bool surelyTooMuch(const Pair&) const noexcept;
    bool surelyTooMuch(const Pair&, const Between&) const noexcept;
    Exchange exchange(uint32_t to, uint32_t from, const Between&, bool second) const noexcept;
    bool fine(uint32_t to, uint32_t from, const Exchange&) const noexcept;

    const Work& work_;
    const FormFactors& factors_;
    const Hierarchy& tree_;
    std::vector<Places> places_;                 // of the nodes
    std::vector<double> brightness_, deviation_; // of the nodes
    std::vector<double> dim_;                    // what arrives at them, of the mean, at most 1
    double allowed_ = 0;
};

} // namespace chiaro::radiosity
