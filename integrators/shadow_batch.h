// ShadowBatch: shadow rays that wait for each other. Those of one point share their origin and cost about half when they are traced sixteen
// at a time (Wald et al., Interactive Rendering with Coherent Ray Tracing, 2001). Each carries what it brings if it arrives; a ray that
// could bring nothing is not added at all. Answers come in the order in which the rays were added.
#pragma once
#include "core/scene/scene.h"
#include "integrators/fixed_vector.h"

namespace chiaro {

template <class Payload> class ShadowBatch {
public:
    static constexpr std::size_t width = 16; // of the widest packet

    explicit ShadowBatch(const Scene& scene) noexcept : scene_(scene) {}
    void add(const Ray& ray, const Payload& payload) noexcept {
        rays_.add(ray);
        payloads_.add(payload);
    }
    bool full() const noexcept { return rays_.full(); }
    // Calls answer(payload, arrived) for each ray; then it is empty again.
    template <class F> void trace(F&& answer) noexcept {
        uint8_t blocked[width];
        const std::size_t n = rays_.size();
        if (n == 1) blocked[0] = scene_.occluded(rays_[0]);
        if (n > 1) scene_.occluded({rays_.data(), n}, {blocked, n});
        for (std::size_t i = 0; i < n; ++i) answer(payloads_[i], !blocked[i]);
        rays_.clear();
        payloads_.clear();
    }

private:
    const Scene& scene_;
    FixedVector<Ray, width> rays_;
    FixedVector<Payload, width> payloads_;
};

} // namespace chiaro
