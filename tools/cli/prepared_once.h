// An integrator that is prepared once, however often the driver is called for it, and knows how long that took.
#pragma once
#include "core/render/integrator.h"
#include <chrono>
#include <memory>

namespace chiaro::cli {

class PreparedOnce : public Integrator {
public:
    explicit PreparedOnce(std::unique_ptr<Integrator> inner) : inner_(std::move(inner)) {}
    void prepare(const Job& job) override {
        if (prepared_) return;
        const auto begin = std::chrono::steady_clock::now();
        inner_->prepare(job);
        seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        prepared_ = true;
    }
    void render(const Job& job, const Pass& pass, Film& film) override { inner_->render(job, pass, film); }
    void save(Writer& to) const override { inner_->save(to); }
    void load(const Job& job, Reader& from) override { inner_->load(job, from); }
    double seconds() const noexcept { return seconds_; }
    const Integrator& inner() const noexcept { return *inner_; }

private:
    std::unique_ptr<Integrator> inner_;
    bool prepared_ = false;
    double seconds_ = 0;
};

} // namespace chiaro::cli
