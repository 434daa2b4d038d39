// Emission, aimed: which of the numbers that a particle begins with send it where it is wanted. The space of those numbers, (0, 1)^6 for
// the choice of the light, the point on it and the direction, is cut in halves again and again where that tells good from bad (a k-d tree);
// each half is then entered as often as its light is worth. The numbers are bent, none is added, so that they stay as well spread as they
// were, and any kind of light is aimed alike: the directions of a point, the place of a beam, both of a lamp. Jensen's projection maps
// (2001, section 5.3.1) are the case of a grid of directions; learning in the space of random numbers is that of Guo et al., Primary Sample
// Space Path Guiding, EGSR 2018. Unbiased: every half keeps a chance, and the flux is divided by how much more often it is entered.
#pragma once
#include "integrators/light_walk.h"
#include <array>
#include <vector>

namespace chiaro {

class EmissionGuide {
public:
    static constexpr int dimensions = 6;
    struct Sample { // of the pilot: numbers, and what the particle did with them
        std::array<float, dimensions> u;
        float worth = 0; // flux that became photons; 0: none
    };
    // Null where nothing is gained: less than a quarter of the variance.
    static std::shared_ptr<const EmissionGuide> learn(std::vector<Sample>);
    static std::array<float, dimensions> numbers(const Departure&) noexcept;

    // Bends the numbers and returns what the flux is to be multiplied by.
    float aim(Departure&) const noexcept;
    double gain() const noexcept { return gain_; } // how many more of the particles become photons
    std::size_t cells() const noexcept { return (nodes_.size() + 1) / 2; }

private:
    struct Node {
        float split = 0.5f; // of the whole interval
        float lower = 0.5f; // probability of the half below it
        uint32_t child = 0; // the half below; the other one follows it; 0: a leaf
        uint8_t dimension = 0;
    };
    struct Learner;
    std::vector<Node> nodes_;
    double gain_ = 1;
};

} // namespace chiaro
