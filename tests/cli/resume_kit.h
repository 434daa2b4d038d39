// Interrupted renders for tests: every integrator with little work, pictures compared to the last bit.
#pragma once
#include "io/checkpoint.h"
#include "scenes/builtin.h"
#include "tests/cli/program.h"
#include "tests/scene_kit.h"
#include <algorithm>
#include <cstring>
#include <sstream>
#include <thread>

namespace chiaro::resume {

inline bool samePixels(const Picture& a, const Picture& b, bool times = false) {
    if (a.names != b.names || !(a.window == b.window)) return false;
    for (std::size_t c = 0; c < a.planes.size(); ++c) {
        if (!times && a.names[c] == "cost.time") continue;
        if (a.planes[c].size() != b.planes[c].size() ||
            std::memcmp(a.planes[c].data(), b.planes[c].data(), a.planes[c].size() * sizeof(float)) != 0)
            return false;
    }
    return true;
}
inline bool samePixels(const program::Folder& folder, const std::string& a, const std::string& b) {
    return samePixels(readPicture(folder / a), readPicture(folder / b));
}

// Every attribute but those that tell of time (facts may) and of the command.
inline bool sameRecipe(const Picture& a, const Picture& b) {
    const auto rest = [](const Picture& p) {
        Metadata m = p.metadata;
        std::erase_if(m, [](const auto& entry) {
            return entry.first == "chiaro:seconds" || entry.first == "chiaro:command" || entry.first.starts_with("chiaro:fact.");
        });
        return m;
    };
    return rest(a) == rest(b);
}

// The registry's integrators, with few photons and coarse patches.
inline std::string small(std::string_view name) {
    if (name == "photon") return "photon:count=3k,caustic-count=1k,gather=0";
    if (name == "sppm") return "sppm:count=2k,caustic-count=500";
    if (name == "radiosity") return "radiosity:patches=60,rays=16,light-rays=4";
    return std::string(name);
}
// With mirrors and glass, but for those that would cut every sphere into patches.
inline const Scene& sceneFor(const std::string& integrator) {
    static const auto plain = test::compiled(findBuiltin("@cornell")->make());
    static const auto spheres = test::compiled(findBuiltin("@cornell-spheres")->make());
    return integrator.starts_with("radiosity") ? *plain : *spheres;
}

inline std::string bytesOf(const Film& film) {
    std::ostringstream out;
    Writer writer(out);
    film.save(writer);
    return out.str();
}

// One run of a render; asks for a stop after so many microseconds (negative: never).
class Run {
public:
    Run(const Scene& scene, const std::string& integrator, unsigned threads)
        : choice_(chooseIntegrator(integrator)), bench_(scene, scene.cameras()[0], settings(threads)) {
        integrator_ = choice_.entry->make(choice_.options);
    }
    std::unique_ptr<Film> begin(uint32_t at = 0) const {
        FilmLayout layout = bench_.layout();
        layout.splats = choice_.entry->traits(choice_.options).splats;
        return std::make_unique<Film>(layout, at);
    }
    RenderResult render(Film& film, uint32_t end, int microseconds = -1, const std::string* state = nullptr) {
        std::thread stopper;
        Loaded loaded(*integrator_, state);
        if (microseconds >= 0)
            stopper = std::thread([&] {
                std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
                bench_.stop.request();
            });
        const RenderResult result = chiaro::render(bench_.job, loaded, film, {end, infinity}, bench_.stop);
        if (stopper.joinable()) stopper.join();
        return result;
    }
    std::string state() const { return stateOf(*integrator_); }

private:
    // Prepares, then takes over what was kept.
    class Loaded : public Integrator {
    public:
        Loaded(Integrator& inner, const std::string* state) : inner_(inner), state_(state) {}
        void prepare(const Job& job) override {
            inner_.prepare(job);
            if (state_) loadState("test", *state_, job, inner_);
        }
        void render(const Job& job, const Pass& pass, Film& film) override { inner_.render(job, pass, film); }

    private:
        Integrator& inner_;
        const std::string* state_;
    };
    static test::Settings settings(unsigned threads) {
        test::Settings s{.width = 40, .height = 24};
        s.threads = threads;
        return s;
    }
    IntegratorChoice choice_;
    test::Bench bench_;
    std::unique_ptr<Integrator> integrator_;
};

// To a file and back, as the program does it.
inline std::unique_ptr<Film> throughFile(const program::Folder& folder, const Film& film, std::string& state) {
    Checkpoint c;
    c.key = {{"scene", "@test"}};
    c.depth.resize(film.layout().crop.area());
    c.lamp.resize(film.layout().crop.area());
    writeCheckpoint(folder / "a.chk", c, film, state);
    Checkpoint back = readCheckpoint(folder / "a.chk");
    state = back.state;
    return std::move(back.film);
}

} // namespace chiaro::resume
