// chiaro doctor: does this installation work? Libraries, machine, disk, colour, and a render whose answer is known.
#include "core/render/render.h"
#include "integrators/registry.h"
#include "io/color.h"
#include "io/replace_file.h"
#include "materials/closure_table.h"
#include "scenes/builtin.h"
#include "tools/cli/command.h"
#include "tools/cli/console.h"
#include "tools/cli/memory.h"
#include "tools/cli/report.h"
#include "tools/cli/version.h"
#include <OpenColorIO/OpenColorIO.h>
#include <OpenImageIO/imageio.h>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <tbb/version.h>
#include <thread>
#include <unistd.h>

namespace chiaro::cli {
namespace {

struct Check {
    std::string name, answer;
    bool ok = true;
};

// A check that throws has failed, and says why.
Check check(const char* name, const std::function<std::string()>& run) {
    try {
        return {name, run(), true};
    } catch (const std::exception& e) { return {name, e.what(), false}; }
}

std::string libraries() {
    return fmt::format("embree {}, oneTBB {}, OpenImageIO {}, OpenColorIO {}, fmt {}.{}.{}", embreeVersion(), TBB_runtime_version(),
                       OIIO::get_string_attribute("version", std::to_string(OIIO::openimageio_version())), OCIO_NAMESPACE::GetVersion(),
                       FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100);
}

std::string memory() {
    const std::size_t bytes = machineBytes();
    if (bytes == 0) throw Error(Exit::resources, "the system does not say how much there is");
    return memorySize(double(bytes));
}

std::string writing() {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("chiaro-doctor-{}.tmp", getpid());
    checkWritable(file);
    replaceFile(file, std::as_bytes(std::span("chiaro")));
    std::filesystem::remove(file);
    return fmt::format("files can be written to {}", file.parent_path().string());
}

std::string color() {
    const DisplayTransform display;
    float grey[3] = {0.18f, 0.18f, 0.18f};
    display.apply(grey, 0);
    if (!std::isfinite(grey[0])) throw Error(Exit::failed, "the view gives no number");
    return fmt::format("OpenColorIO configuration {}: {} / {}, 0.18 -> {:.4f}", display.source(), display.display(), display.view(),
                       grey[0]);
}

// Inside a closed sphere that glows with 1 and reflects half, radiance is 2 everywhere (scenes/furnace.md).
std::string selfTest() {
    constexpr uint32_t edge = 16, spp = 256;
    const BuiltinScene* furnace = findBuiltin("@furnace");
    if (!furnace) throw Error(Exit::failed, "@furnace is missing");
    Diagnostics notes;
    const auto scene = Scene::compile(furnace->make(), notes, {}, nullptr, ClosureTable::make);
    View view;
    view.camera = Camera(scene->cameras()[0], edge, edge);
    view.width = view.height = edge;
    view.crop = {0, 0, edge, edge};
    const Executor run;
    StopToken stop;
    Progress silent;
    const PathClasses classes;
    const Job job{{*scene, classes, view.shutter, 0, SamplerKind::sobol, run, stop, silent, notes}, view};
    Film film({.width = edge, .height = edge, .crop = view.crop, .layers = {}});
    const IntegratorChoice choice = chooseIntegrator("path");
    const auto integrator = choice.entry->make(choice.options);
    render(job, *integrator, film, {.spp = spp}, stop);
    const double mean = film.meanLuminance().value;
    if (!(std::abs(mean - 2) < 0.02)) throw Error(Exit::failed, fmt::format("@furnace gives {:.4f} where 2 is right", mean));
    return fmt::format("@furnace {}x{}, {} spp: mean {:.4f}, expected 2", edge, edge, spp, mean);
}

} // namespace

int runDoctor(const Arguments& arguments) {
    const std::vector<Check> checks = {
        check("version", [] { return fmt::format("chiaro {} ({}), {}", version, commit, buildType); }),
        check("libraries", libraries),
        check("embree", [] { return "instruction set " + bestIsa(); }),
        check("cores", [] { return std::to_string(std::thread::hardware_concurrency()); }),
        check("memory", memory),
        check("disk", writing),
        check("color", color),
        check("render", selfTest),
    };
    bool ok = true;
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const Check& c : checks) {
        ok &= c.ok;
        all.push_back({{"check", c.name}, {"ok", c.ok}, {"answer", c.answer}});
        if (!arguments.on("json")) fmt::print("{:<4} {:<10} {}\n", c.ok ? "ok" : "FAIL", c.name, c.answer);
    }
    if (arguments.on("json")) fmt::print("{}\n", nlohmann::ordered_json{{"ok", ok}, {"checks", all}}.dump(2));
    return ok ? int(Exit::done) : int(Exit::failed);
}

} // namespace chiaro::cli
