// Integrators against converged references. A reference is what many replicates of the path tracer, restricted to the paths that an
// integrator covers, say of a small picture: the mean and its error, whole and by 8x8 tiles, with where it came from. It is kept in
// tests/references/<scene>.json, one entry a set of paths, and made anew by `sh tools/references.sh` alone. Where a formula is known it is
// the reference. An integrator is compared as soon as the registry lists it; paths without a stored entry are rendered on the spot.
//
// The judgement is that of the judge library (tools/judge/agreement.h). One run of all comparisons calls a sound program wrong once in
// 1,000 at the first stage (Sidak over the comparisons); what is called wrong is rendered again with other seeds and four times the
// replicates, and must be called wrong twice. Seeds are fixed: a red test stays red.
//
// Tiers: quick, 32x32, always; long, CHIARO_LONG=1 sh tools/test.sh -R converged: eight times the replicates, and a 64x64 picture
// against path replicates of its own size; about a quarter of an hour of processor time.
#pragma once
#include "core/render/path_classes.h"
#include "integrators/registry.h"
#include "scenes/builtin.h"
#include "tools/judge/agreement.h"
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace chiaro::test {

struct Stage {
    explicit Stage(std::string_view builtin);
    std::string name;
    std::unique_ptr<const Scene> scene;
    CameraDesc camera;
};
// How a picture is measured. Both sides of a comparison share size and spp: equal designs are safe for skewed samples.
struct Design {
    uint32_t size = 32, spp = 64, replicates = 32;
    uint64_t firstSeed = 0;
    unsigned threads = 1; // 0: all cores; no result depends on it
};
// Paths as an integrator declares them.
struct Paths {
    std::string covers, misses;
    PathClasses classes() const;
    friend bool operator==(const Paths&, const Paths&) = default;
};
judge::Replicates replicatesOf(const Stage&, const IntegratorChoice&, const Paths&, const Design&);

struct Reference {
    Paths paths;
    std::string integrator, version, commit; // which program made it
    uint64_t firstSeed = 0;
    uint32_t spp = 0, replicates = 0; // samples a pixel and replicate
    judge::Evidence evidence;         // pixels: left out
};
struct ReferenceFile {
    std::string scene, camera;
    uint64_t hash = 0; // of the scene it shows
    uint32_t size = 0, tile = 0;
    std::vector<Reference> entries;
    const Reference* find(const Paths&) const;
};
std::filesystem::path referencePath(std::string_view scene);
std::string toJson(const ReferenceFile&);
// Throws std::runtime_error with a message that names the file and the command that makes it anew.
ReferenceFile referenceFromJson(const std::string& text, const std::string& file);
// Of this scene as it is now; throws as above where the stored scene is another one.
ReferenceFile loadReference(const Stage&);
void requireSameScene(const ReferenceFile&, const Stage&);

// Radiance inside @furnace by its geometric series, over the depths that these paths hold.
double furnaceRadiance(const Paths&);
judge::Evidence constantEvidence(double radiance, uint32_t size, uint32_t tile);

// An integrator with its options, and what it says of itself.
struct Entrant {
    explicit Entrant(IntegratorChoice);
    IntegratorChoice choice;
    Traits traits;
    Paths paths;
};
std::vector<Entrant> entrants(); // all of the registry that transport light

// A scene of the table. without: paths left out, where a few of them (a lamp of a pixel's size, a caustic) would hide a bias of all others.
struct Row {
    struct Exception {
        std::string_view integrator;
        double resolution;        // its own: it has more noise on these paths, or covers few of them
        std::string without = {}; // left out beside the row's, where no number of samples that a test may take has met them all
    };
    std::string_view scene;
    std::string without;
    double resolution = 0.01; // relative bias of the mean that must be visible with a power of 99 %
    std::vector<Exception> exceptions = {};
    Design design = {};
    const Exception* exceptionOf(const Entrant&) const; // null: none
    double resolutionOf(const Entrant&) const;
    // An entrant's paths on this row; empty where none is left.
    std::optional<Paths> paths(const Entrant&) const;
};
std::span<const Row> rows();

// Beyond this resolution a comparison is weak: printed as such.
inline constexpr double weakResolution = 0.02;

struct Outcome {
    bool sound = false;         // the last stage's answer
    int stages = 1;             // 2: the first one was red
    judge::Agreement agreement; // of the last stage; of a method judged by its limit, at its own parameter
    std::string verdict;
    double limitWidth = 0; // of a method judged in a limit: half of the 95 % interval of its relative error there
};
// An unbiased method must not be told from the reference. A consistent one (Traits::convergesOver) is judged by its limit, another biased
// one by equivalence: its mean must be shown to lie within 1 %. Where the comparison is known as weak, no mean of so much noise can be
// shown to lie there: the biased method must then not be told from the reference, like an unbiased one.
Outcome compare(const Stage&, const Entrant&, const Paths&, const Design&, bool weak = false);
// All entrants on all rows of a scene.
void compareAll(std::string_view scene);
bool longTier();

} // namespace chiaro::test
