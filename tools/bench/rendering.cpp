#include "tools/bench/rendering.h"
#include "core/scene/ray_record.h"
#include <fmt/format.h>

namespace chiaro::bench {
namespace {

constexpr uint32_t mostSamples = 16; // of a pixel, as many as make one packet of camera rays

FilmLayout layoutOf(const View& view, bool splats) {
    return {.width = view.width, .height = view.height, .crop = view.crop, .layers = {}, .splats = splats};
}

} // namespace

std::string nameOf(const IntegratorChoice& choice) {
    const std::string options = choice.options.recipe();
    return fmt::format("{}{}{}", choice.entry->name, options.empty() ? "" : ":", options);
}

Rendering::Rendering(const Job& job, const IntegratorChoice& choice)
    : job_(job), integrator_(choice.entry->make(choice.options)),
      film_(std::make_unique<Film>(layoutOf(job.view, choice.entry->traits(choice.options).splats))) {
    const auto begin = Clock::now();
    integrator_->prepare(job);
    prepared_ = secondsSince(begin);
}

double Rendering::pass(double passSeconds) {
    const uint32_t samples = samples_;
    const auto begin = Clock::now();
    integrator_->render(job_, {next_, next_ + samples}, *film_);
    film_->setDone(next_ += samples);
    while (samples_ < mostSamples && secondsSince(begin) * (2 * samples_) / samples <= passSeconds) samples_ *= 2;
    return double(samples) * double(job_.view.crop.area());
}

double Rendering::raysPerSample() {
    RayRecord counting(0);
    counting.start();
    const double samples = pass();
    counting.stop();
    return double(counting.rays()) / samples;
}

} // namespace chiaro::bench
