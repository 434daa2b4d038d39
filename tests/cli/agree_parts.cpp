// The parts of chiaro agree that no registered integrator shows yet: the list behind -i, the limit of a method that converges, and the
// verdict on synthetic methods.
#include "core/render/error.h"
#include "materials/closure_table.h"
#include "scenes/builtin.h"
#include "tools/cli/agree_run.h"
#include "tools/cli/agree_verdict.h"
#include "tools/cli/console.h"
#include "tools/cli/integrator_list.h"
#include <cmath>
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::cli;
using judge::Verdict;

namespace {

constexpr uint32_t size = 16, rounds = 32;

double uniformAt(uint64_t i) { // SplitMix64's finaliser (Steele et al., 2014)
    i += 0x9e3779b97f4a7c15ull;
    i = (i ^ (i >> 30)) * 0xbf58476d1ce4e5b9ull;
    i = (i ^ (i >> 27)) * 0x94d049bb133111ebull;
    return double((i ^ (i >> 31)) >> 11) * 0x1p-53;
}

// A picture of mean `level` whose pixels have a relative standard deviation of 10 %.
judge::Picture noisy(double level, uint64_t seed) {
    judge::Picture p{size, size, {}, {}, "synthetic", {}};
    for (uint32_t i = 0; i < size * size * 3; ++i)
        p.rgb.push_back(float(level * (1 + 0.1 * std::sqrt(12.0) * (uniformAt(seed * 1'000'003 + i / 3) - 0.5))));
    return p;
}

// A method whose mean is level(h) at its parameter h: judged as the command judges it.
struct Synthetic {
    Subject subject;
    Trial trial{{}, judge::Replicates(size, size)};
    judge::Replicates reference{size, size};

    template <class F> Synthetic(std::vector<double> h, std::vector<double> powers, F&& level, uint64_t seed = 1) {
        subject.traits.unbiased = false;
        subject.traits.convergesOver = h.size() > 1 ? "radius" : "";
        subject.traits.convergencePowers = powers;
        subject.weights = h.size() > 1 ? limitWeights(h, powers) : std::vector<double>{1};
        subject.levels.resize(h.size(), {nullptr, Options({})});
        if (h.size() > 1) subject.parameter = h;
        for (std::size_t l = 0; l < h.size(); ++l) trial.levels.emplace_back(size, size);
        for (uint32_t r = 0; r < rounds; ++r) {
            judge::Picture limit = noisy(0, 0);
            for (std::size_t l = 0; l < h.size(); ++l) {
                const judge::Picture p = noisy(level(h[l]), 100'000 * seed + 1000 * (l + 1) + r);
                trial.levels[l].replicates.add(p);
                for (std::size_t i = 0; i < p.rgb.size(); ++i) limit.rgb[i] += float(subject.weights[l] * p.rgb[i]);
            }
            trial.limit.add(limit);
            reference.add(noisy(1, 100'000 * seed + r));
        }
    }
    Judgement judged() const { return judgeTrial(subject, trial, reference, {}); }
};

// The path tracer with a fault: every radiance times a factor.
class Faulty final : public CameraIntegrator {
public:
    explicit Faulty(double factor)
        : factor_(float(factor)), path_(chooseIntegrator("path").entry->make(chooseIntegrator("path").options)) {}
    void radiance(const Job& job, PathStart& start, Outputs& out) const noexcept override {
        static_cast<const CameraIntegrator&>(*path_).radiance(job, start, out);
        out.layer[0] *= factor_;
    }

private:
    float factor_;
    std::unique_ptr<Integrator> path_;
};
const IntegratorEntry brightEntry = {"bright",
                                     "5 % too bright",
                                     {},
                                     [](const Options&) { return Traits{}; },
                                     [](const Options&) -> std::unique_ptr<Integrator> { return std::make_unique<Faulty>(1.05); }};
constexpr OptionSpec radiusSpecs[] = {{"radius", OptionType::real, "0.5", 0.001, 10, "", "of the estimate"}};
const IntegratorEntry blurryEntry = {"blurry", "loses a share of radius^2", radiusSpecs,
                                     [](const Options&) {
                                         Traits t;
                                         t.unbiased = false;
                                         t.convergesOver = "radius";
                                         return t;
                                     },
                                     [](const Options& o) -> std::unique_ptr<Integrator> {
                                         return std::make_unique<Faulty>(1 - 0.2 * o.real("radius") * o.real("radius"));
                                     }};

// The whole course on @furnace, 16 x 16 pixels.
struct Course {
    std::vector<Subject> subjects;
    AgreeRun run;
    Course(const IntegratorEntry& entry, bool confirm) : subjects(makeSubjects({{&entry, Options(entry.options)}}, {})) {
        Diagnostics notes;
        const BuiltinScene& builtin = *findBuiltin("@furnace");
        const auto scene = Scene::compile(builtin.make(), notes, {}, nullptr, ClosureTable::make);
        View view;
        view.camera = Camera(scene->cameras()[0], size, size);
        view.width = view.height = size;
        view.crop = {0, 0, size, size};
        const PathClasses all;
        const Executor executor;
        StopToken stop;
        Progress progress;
        const Job job{{*scene, all, view.shutter, 7, SamplerKind::sobol, executor, stop, progress, notes}, view};
        AgreeSettings s;
        s.replicates = 16;
        s.spp = 8;
        s.confirm = confirm;
        run = runStages(s, subjects, job, stop, progress, Console(true));
    }
};

std::string failure(std::string_view list) {
    try {
        chooseIntegrators(list);
    } catch (const Error& e) {
        CHECK(e.code == Exit::usage);
        return e.what();
    }
    return {};
}

} // namespace

TEST_SUITE("agree parts") {

    TEST_CASE("a piece with = belongs to the name before it") {
        using List = std::vector<std::string>;
        CHECK(splitIntegrators("path") == List{"path"});
        CHECK(splitIntegrators("a,b,c") == List{"a", "b", "c"});
        CHECK(splitIntegrators("photon:count=2M,gather=64,path") == List{"photon:count=2M,gather=64", "path"});
        CHECK(splitIntegrators("path,path:nee=off,rr-depth=3") == List{"path", "path:nee=off,rr-depth=3"});
        CHECK(splitIntegrators("path,nee=off") == List{"path:nee=off"});
        CHECK(splitIntegrators("a:x=b:c,y=d:e,f") == List{"a:x=b:c,y=d:e", "f"});
        CHECK(splitIntegrators(" a , b:k=v ") == List{"a", "b:k=v"});
        CHECK_THROWS_AS(splitIntegrators(""), Error);
        CHECK_THROWS_AS(splitIntegrators("a,,b"), Error);
        CHECK_THROWS_AS(splitIntegrators("a,"), Error);
        CHECK_THROWS_AS(splitIntegrators("k=v,a"), Error);
    }

    TEST_CASE("the list is looked up in the registry") {
        const auto chosen = chooseIntegrators("path,path:nee=off,rr-depth=3");
        REQUIRE(chosen.size() == 2);
        CHECK(chosen[1].options.integer("rr-depth") == 3);
        CHECK_FALSE(chosen[1].options.boolean("nee"));
        CHECK(fileName(chosen[1]) == "path-rr-depth-3-nee-off");
        CHECK(failure("path,pth").find("did you mean path?") != std::string::npos);
        CHECK(failure("path:nee=off,path:nee=off").find("named twice") != std::string::npos);
        CHECK(failure("path,path:nee=on").find("named twice") != std::string::npos); // the default, written out
        for (const IntegratorChoice& c : allLightTransport()) CHECK(c.entry->traits(c.options).lightTransport);
    }

    TEST_CASE("equal light paths share a reference, others do not") {
        const auto two = makeSubjects(chooseIntegrators("path,path:mis=off"), {});
        CHECK(two[0].reference == two[1].reference);
        CHECK(referenceCount(two) == 1);
        CHECK(two[0].levels.size() == 1);
        CHECK(two[0].weights == std::vector<double>{1});
    }

    TEST_CASE("weights of the limit reproduce the constant of a polynomial") {
        for (const std::vector<double>& powers : {std::vector<double>{2}, {1, 2}, {-2.0 / 3}}) {
            std::vector<double> h;
            for (std::size_t l = 0; l < powers.size() + 2; ++l) h.push_back(0.4 * std::pow(powers[0] < 0 ? 2 : 0.7071, double(l)));
            const std::vector<double> weights = limitWeights(h, powers);
            double sum = 0;
            for (std::size_t l = 0; l < h.size(); ++l) {
                double y = 3;
                for (const double p : powers) y += 5 * std::pow(h[l], p);
                sum += weights[l] * y;
            }
            CHECK(sum == doctest::Approx(3).epsilon(1e-9));
        }
        // Two levels h and h/2 with power 2 are Richardson's (4 L(h/2) - L(h))/3.
        const std::vector<double> richardson = limitWeights({1, 0.5}, {2});
        CHECK(richardson[0] == doctest::Approx(-1.0 / 3));
        CHECK(richardson[1] == doctest::Approx(4.0 / 3));
    }

    TEST_CASE("a biased method that converges agrees in its limit") {
        const std::vector<double> h{0.1, 0.0707, 0.05};
        for (uint64_t seed = 1; seed <= 10; ++seed) {
            const auto shipped = [](double r) { return 1 - 8 * r * r; }; // 8 % low at 0.1
            const Judgement good = Synthetic(h, {2}, shipped, seed).judged();
            CAPTURE(good.text);
            CHECK(good.verdict == Verdict::agrees);
            REQUIRE(good.limit);
            CHECK(good.limit->bias[0] == doctest::Approx(-0.08).epsilon(0.05));
            CHECK(good.limit->fits);
            CHECK(good.text.find("in the limit of radius") != std::string::npos);
        }
    }

    TEST_CASE("one that converges elsewhere is biased") {
        const std::vector<double> h{0.1, 0.0707, 0.05};
        const Judgement bad = Synthetic(h, {2}, [](double r) { return 0.97 - 8 * r * r; }).judged();
        CAPTURE(bad.text);
        CHECK(bad.verdict == Verdict::biased);
        CHECK(bad.agreement.bias[0].relative == doctest::Approx(-0.03).epsilon(0.2));
    }

    TEST_CASE("one that follows another power does not fit") {
        const std::vector<double> h{0.4, 0.2, 0.1};
        const Judgement bad = Synthetic(h, {2}, [](double r) { return 1 - std::sqrt(r); }).judged();
        CAPTURE(bad.text);
        CHECK(bad.verdict == Verdict::differs);
        REQUIRE(bad.limit);
        CHECK_FALSE(bad.limit->fits);
    }

    TEST_CASE("a biased method without a parameter must lie inside the margin") {
        const Judgement small = Synthetic({1}, {2}, [](double) { return 1.004; }).judged();
        CAPTURE(small.text);
        CHECK(small.verdict == Verdict::agrees); // significant, and harmless
        const Judgement large = Synthetic({1}, {2}, [](double) { return 1.03; }).judged();
        CHECK(large.verdict == Verdict::biased);
    }

    TEST_CASE("a fault is called after a second stage of new seeds and four times the samples") {
        const Course faulty(brightEntry, true);
        REQUIRE(faulty.run.second);
        CHECK(faulty.run.second->spp == 32);
        CHECK(faulty.run.second->trials[0].levels[0].firstSeed != faulty.run.first.trials[0].levels[0].firstSeed);
        const Outcome& o = faulty.run.outcomes[0];
        CHECK(o.first.red());
        CHECK(o.verdict() == Verdict::biased);
        CHECK(o.last().agreement.bias[0].relative == doctest::Approx(0.05).epsilon(0.05));
        CHECK(exitOf(o.verdict()) == Exit::failed);
        const Course hasty(brightEntry, false);
        CHECK_FALSE(hasty.run.second);
        CHECK(hasty.run.outcomes[0].verdict() == Verdict::biased);
    }

    TEST_CASE("an integrator with a convergence parameter is rendered at its levels and judged in the limit") {
        const Course course(blurryEntry, true);
        const Subject& s = course.subjects[0];
        REQUIRE(s.levels.size() == 3);
        CHECK(s.parameter[2] == doctest::Approx(0.25));
        CHECK(s.levels[2].options.real("radius") == doctest::Approx(0.25));
        const Outcome& o = course.run.outcomes[0];
        CAPTURE(o.text());
        CHECK(o.verdict() == Verdict::agrees);
        REQUIRE(o.last().limit);
        CHECK(o.last().limit->bias[0] == doctest::Approx(-0.05).epsilon(0.1));
    }
}
