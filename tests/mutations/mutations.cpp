// Damaged scenes through all that a render does: reading, compiling, an 8 x 8 picture by paths, in lanes or one by one. Each is a picture,
// or one error line that names its file; none crashes, hangs, or takes more than 2 GB. CHIARO_LONG=1: a thousand, of the scenes that the
// project makes and of those in ../shared/scenes; else a few dozen. Built with AddressSanitizer it is the test that hostile files do no
// harm (tools/fuzz.sh).
#include "tests/io/gltf_builder.h"
#include "tests/mutations/mutate.h"
#include "tests/mutations/seeds.h"
#include "tests/scene_kit.h"
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <doctest/doctest.h>
#include <iostream>
#include <sys/resource.h>
#include <unistd.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

std::string contentOf(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

// A picture, or the message of an Error.
std::string outcome(const fs::path& file, const GltfOptions& options, Diagnostics& notes, const std::string& integrator = "path") {
    try {
        SceneDesc desc = readGltf(file, options, notes);
        if (desc.lights.empty()) desc.environment = uniformSky(1);
        const auto scene = Scene::compile(std::move(desc), notes, {}, nullptr, ClosureTable::make);
        const CameraDesc camera = scene->cameras().empty() ? frameScene(*scene, 1) : scene->cameras()[0];
        Settings s;
        s.width = s.height = 8;
        s.spp = 1;
        s.maxDepth = 8;
        (void)rendered(*scene, camera, s, integrator);
        return {};
    } catch (const Error& e) { return std::string("error: ") + e.what(); }
}

// Ten minutes after its making the process ends with the name of the copy that it hangs in.
class Watch {
public:
    explicit Watch(const std::string& copy) {
        std::snprintf(said, sizeof said, "%s hangs\n", copy.c_str());
        std::signal(SIGALRM, [](int) {
            [[maybe_unused]] const auto written = write(STDERR_FILENO, said, strlen(said));
            _exit(1);
        });
        alarm(600);
    }
    ~Watch() { alarm(0); }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

private:
    static inline char said[256];
};

struct Tally {
    int pictures = 0, errors = 0;
    double slowest = 0;
    std::string which;
};

struct Original {
    fs::path folder; // with what lies beside it; empty: nothing does
    std::string name, bytes;
};
// The copy is written where the original's own files are beside it; its name says what it came from, so that a crash can be replayed.
void tryCopy(const Folder& folder, const Original& from, uint64_t seed, Tally& tally) {
    const std::string& name = from.name;
    const std::string origin = (from.folder.filename() / name).string();
    const fs::path file = folder.path / ("mutated-" + std::to_string(seed) + "-" + name);
    std::ofstream(file, std::ios::binary) << mutated(from.bytes, seed);
    if (std::getenv("CHIARO_TRACE")) std::cerr << "seed " << seed << " of " << origin << '\n';
    const Watch watch(origin + ", seed " + std::to_string(seed));
    const auto begin = std::chrono::steady_clock::now();
    Diagnostics notes;
    const GltfOptions options{seed % 2 ? MissingTexture::grey : MissingTexture::error, 0, {0, seed % 3 ? 0 : 0.5f}};
    const std::string said = outcome(file, options, notes, seed / 2 % 2 ? "path" : "path:wide=off");
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (seconds > tally.slowest) {
        tally.slowest = seconds;
        tally.which = origin + ", seed " + std::to_string(seed);
    }
    if (std::getenv("CHIARO_TRACE")) std::cerr << "    " << said << '\n';
    ++(said.empty() ? tally.pictures : tally.errors);
    CAPTURE(file.string());
    CAPTURE(said);
    CHECK((said.empty() || said.find(file.stem().string()) != std::string::npos));
    CHECK(said.find('\n') == std::string::npos);
    fs::remove(file);
}

double peakGigabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) * 1024 / 1e9;
}

std::vector<Original> originals(bool all) {
    std::vector<Original> list;
    for (Seed& s : gltfSeeds()) list.push_back({{}, s.name, std::move(s.bytes)});
    const fs::path shared = "../shared/scenes";
    if (!all || !fs::is_directory(shared)) return list;
    std::vector<fs::path> folders;
    for (const auto& f : fs::directory_iterator(shared))
        if (f.is_directory()) folders.push_back(f.path());
    std::sort(folders.begin(), folders.end());
    for (const fs::path& folder : folders)
        for (const char* name : {"scene.glb", "scene.gltf"})
            if (fs::exists(folder / name)) list.push_back({folder, name, contentOf(folder / name)});
    return list;
}

} // namespace

TEST_SUITE("mutations") {
    TEST_CASE("the originals are whole") {
        const Folder folder("mutations");
        for (const Seed& s : gltfSeeds()) {
            Diagnostics notes;
            CAPTURE(s.name);
            CHECK(outcome(folder.write(s.name, s.bytes), {}, notes) == "");
        }
    }

    TEST_CASE("damaged scenes: a picture, or an error that names the file") {
        const bool all = std::getenv("CHIARO_LONG") != nullptr;
        const int copies = all ? 1000 : 60;
        const std::vector<Original> list = originals(all);
        Tally tally;
        for (std::size_t i = 0; i < list.size(); ++i) {
            const Folder folder("mutations");
            std::error_code ignored;
            if (!list[i].folder.empty())
                for (const auto& beside : fs::directory_iterator(list[i].folder))
                    if (beside.path().filename() != list[i].name)
                        fs::copy(beside.path(), folder.path / beside.path().filename(), fs::copy_options::recursive, ignored);
            for (uint64_t seed = i; seed < uint64_t(copies); seed += list.size()) tryCopy(folder, list[i], seed, tally);
        }
        CHECK(tally.pictures + tally.errors == copies);
        CHECK(tally.pictures > copies / 20);
        CHECK(tally.errors > copies / 4);
        CHECK(peakGigabytes() < 2);
        std::cout << tally.pictures << " pictures, " << tally.errors << " errors, the slowest in " << tally.slowest << " s (" << tally.which
                  << "), peak " << peakGigabytes() << " GB\n";
    }
}
