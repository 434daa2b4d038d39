#include "tools/bench/bench.h"
#include <array>

namespace chiaro::bench {

std::span<const Suite> suites() {
    static constexpr std::array all = {
        Suite{"rays", "rays of every kind, traced by Embree alone", "@cornell,@cornell-spheres,@caustic", raysSuite},
        Suite{"integrators", "samples and rays of every integrator", "@cornell,@cornell-spheres", integratorsSuite},
        Suite{"photons", "photons traced, sorted and gathered", "@cornell,@caustic", photonsSuite},
        Suite{"radiosity", "every solver over growing numbers of patches", "@cornell", radiositySuite},
    };
    return all;
}

} // namespace chiaro::bench
