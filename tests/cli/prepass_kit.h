// A pre-pass that costs next to nothing and shows everything: its field is a constant that depends on the seed, it counts how often it was
// solved and loaded, it tells a fact and warns. For the tests of those who solve, keep and bill pre-passes.
#pragma once
#include "materials/bsdf.h"
#include "tools/cli/prepass_solver.h"
#include <atomic>
#include <thread>

namespace fake {

using namespace chiaro;

inline std::atomic<int> solved{0}, loaded{0};
inline constexpr double solveSeconds = 0.03;
inline float valueOf(uint64_t seed) { return 1 + float(seed % 7); }

struct Field final : Prepass {
    explicit Field(double scale_) : scale(float(scale_)) {}
    void solve(const Work& work) override {
        ++solved;
        std::this_thread::sleep_for(std::chrono::duration<double>(solveSeconds));
        value = valueOf(work.seed) * scale;
        work.notes.tell("fake", "a field of its own      keep it with: --prepass fake:scale=1");
        work.notes.warn("the field is not real");
    }
    void addIndirect(const PathClasses& classes, const Hit&, const SurfacePoint&, const Bsdf& bsdf, PathState eye, const Spectrum& weight,
                     Outputs& out) const noexcept override {
        const PathState further = classes.eye(classes.eye(eye, Event::DR), Event::DR); // as if it had been scattered once before
        out.add(classes.reached(further, LightKind::area), weight * bsdf.diffuseAlbedo() * value);
    }
    void save(Writer& w) const override { w.value(value); }
    void load(const Work&, Reader& r) override {
        ++loaded;
        value = r.value<float>();
    }
    float value = 0, scale = 1;
};

inline constexpr OptionSpec specs[] = {{"scale", OptionType::real, "1", 0, 100, "", "of the field"}};
inline std::string field(const Options&) { return "L (D|G|S)+ D"; }
inline std::unique_ptr<Prepass> make(const Options& o) { return std::make_unique<Field>(o.real("scale")); }
inline const PrepassEntry entry{"fake", "a constant", specs, field, make};

inline cli::PrepassSettings settings(const std::filesystem::path& file = {}, const std::string& options = {}) {
    return {PrepassChoice{&entry, Options::parse(specs, options, "fake")}, file};
}
inline cli::SceneRequest scene(const std::string& operand) {
    cli::SceneRequest request;
    request.operand = operand;
    return request;
}
inline float valueIn(const cli::SolvedPrepass& s) { return dynamic_cast<const Field&>(*s.field).value; }

} // namespace fake
