#include "integrators/radiosity/solution.h"
#include "core/render/error.h"
#include <algorithm>

namespace chiaro::radiosity {

double power(std::span<const Light> radiosity, std::span<const float> areas) noexcept {
    double sum = 0;
    for (std::size_t i = 0; i < radiosity.size(); ++i) sum += luminance(radiosity[i]) * double(areas[i]);
    return sum;
}

Solution neumann(const System& system, Bounce bounce, const Limits& limits, const Run& run) {
    const std::size_t n = system.size();
    Solution s;
    s.terms.assign(limits.levels(), Lights3(n, Light(0)));
    Lights3 under(n), arrived(n);
    const double emitted = power(system.emission, system.areas);
    double sent = emitted;
    for (uint32_t k = 0; k < limits.bounces; ++k) {
        if (run.stop.requested()) return s;
        const Lights3& radiosity = k == 0 ? system.emission : under;
        if (k == 0 && emitted == 0)
            std::fill(arrived.begin(), arrived.end(), Light(0));
        else
            bounce(radiosity, arrived);
        Lights3& term = s.terms[std::min<std::size_t>(k, s.terms.size() - 1)];
        for (std::size_t i = 0; i < n; ++i) {
            if (k == 0) arrived[i] += system.received[i];
            term[i] += arrived[i];
            under[i] = widened(system.reflectance[i]) * arrived[i];
        }
        const double left = power(under, system.areas);
        if (k == 0) sent += left;
        s.residuals.push_back(sent > 0 ? left / sent : 0);
        if (!(left > limits.tolerance * sent)) break;
        if (k > 100000 || left > 1e6 * sent)
            throw Error(Exit::failed, "radiosity: the light grows from bounce to bounce; raise rays= for better form factors");
    }
    s.complete = true;
    return s;
}

} // namespace chiaro::radiosity
