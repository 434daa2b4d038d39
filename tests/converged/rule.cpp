// The comparison itself, tried on integrators whose answer is known: the path tracer with something wrong, made here.
#include "tests/converged/comparison.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr OptionSpec specs[] = {{"h", OptionType::real, "0.4", 1e-3, 1, "", "size of the bias: h squared"}};

// The path tracer, times a factor, in the columns from `from` on.
class Scaled final : public CameraIntegrator {
public:
    Scaled(float factor, float from) : factor_(factor), from_(from) {
        const IntegratorChoice path = chooseIntegrator("path");
        path_ = path.entry->make(path.options);
    }
    void radiance(const Job& job, PathStart& start, Outputs& out) const noexcept override {
        const float x = (float(start.pixel.x) + 0.5f) / float(job.view.width);
        static_cast<const CameraIntegrator&>(*path_).radiance(job, start, out);
        for (Spectrum& layer : out.layer) layer *= x < from_ ? 2 - factor_ : factor_;
    }

private:
    std::unique_ptr<Integrator> path_;
    float factor_, from_;
};
template <bool unbiased, bool consistent = false> Traits claims(const Options&) {
    Traits t;
    t.unbiased = unbiased;
    if (consistent) t.convergesOver = "h";
    return t;
}
float bias(const Options& o) { return float(1 + o.real("h") * o.real("h")); }
template <class F> Entrant made(const IntegratorEntry& entry, F set) {
    IntegratorChoice choice{&entry, Options(entry.options)};
    set(choice.options);
    return Entrant(choice);
}
Outcome compared(const Stage& stage, const Entrant& e, const Design& d) { return compare(stage, e, e.paths, d); }
const auto asIs = [](Options&) {};

const IntegratorEntry brighter = {"brighter", "", specs, claims<true>,
                                  [](const Options& o) -> std::unique_ptr<Integrator> { return std::make_unique<Scaled>(bias(o), 0.f); }};
const IntegratorEntry tilted = {"tilted", "", specs, claims<true>,
                                [](const Options&) -> std::unique_ptr<Integrator> { return std::make_unique<Scaled>(1.1f, 0.5f); }};
const IntegratorEntry biased = {"biased", "", specs, claims<false>, brighter.make};
const IntegratorEntry consistent = {"consistent", "", specs, claims<false, true>, brighter.make};
const IntegratorEntry stubborn = {"stubborn", "", specs, claims<false, true>,
                                  [](const Options&) -> std::unique_ptr<Integrator> { return std::make_unique<Scaled>(1.02f, 0.f); }};

} // namespace

TEST_SUITE("rule") {
    TEST_CASE("what is wrong is called wrong twice, what is right passes") {
        const Stage furnace("@furnace");
        const Design d{16, 16, 16, 0, 1};
        CHECK(compared(furnace, Entrant(chooseIntegrator("path")), d).stages == 1);
        const auto factor = [](const char* h) { return [h](Options& o) { o.set("h", h, "test"); }; };
        const Outcome one = compared(furnace, made(brighter, factor("0.1")), d); // 1 %
        CHECK_FALSE(one.sound);
        CHECK(one.stages == 2);
        CHECK(one.agreement.verdict == judge::Verdict::biased);
        CHECK(one.agreement.bias[0].relative == doctest::Approx(0.01).epsilon(0.05));
        const Outcome halves = compared(furnace, made(tilted, asIs), d); // the means agree
        CHECK_FALSE(halves.sound);
        CHECK(halves.agreement.tiles.significant());
    }

    TEST_CASE("a biased method passes within the margin, a consistent one by its limit") {
        const Stage furnace("@furnace");
        const Design d{16, 16, 16, 0, 1};
        const auto factor = [](const char* h) { return [h](Options& o) { o.set("h", h, "test"); }; };
        CHECK(compared(furnace, made(biased, factor("0.05")), d).sound);       // 0.25 %
        CHECK_FALSE(compared(furnace, made(biased, factor("0.15")), d).sound); // 2.25 %
        CHECK(compared(furnace, made(consistent, asIs), d).sound);             // 16 % at h, none at 0
        CHECK_FALSE(compared(furnace, made(stubborn, asIs), d).sound);         // 2 %, whatever h
    }
} // TEST_SUITE
