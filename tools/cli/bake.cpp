// chiaro bake: light into the scene.
#include "core/scene/texture.h"
#include "io/color.h"
#include "io/replace_file.h"
#include "scenes/builtin.h"
#include "tools/bake/site_field.h"
#include "tools/cli/bake_settings.h"
#include "tools/cli/prepass_solver.h"
#include "tools/cli/report.h"
#include "tools/cli/signals.h"
#include "tools/cli/unseen_paths.h"
#include "tools/cli/version.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace chiaro::cli {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
using bake::MapTexel;
using bake::SiteSum;

std::unique_ptr<Integrator> makeIntegrator(const IntegratorChoice& choice) {
    auto made = choice.entry->make(choice.options);
    if (!dynamic_cast<const CameraIntegrator*>(made.get()))
        throw Error(
            Exit::unsupported,
            fmt::format("-i {}: it makes pictures as a whole and cannot be asked what arrives at one point of a surface; try -i path",
                        choice.entry->name));
    return made;
}

// The file once more, or the description of a built-in scene, to be written into.
GltfDocument openDocument(const BakeSettings& s, LoadedScene& loaded, const std::optional<SceneDesc>& builtin) {
    if (builtin) return GltfDocument::describe(*builtin);
    Diagnostics silent; // the same was said when the scene was read
    return GltfDocument::read(s.render.scene.operand, std::move(loaded.origin), silent);
}

Chosen chooseParts(const Scene& scene, const GltfDocument& document) {
    Chosen c;
    if (scene.parts().empty()) throw Error(Exit::unsupported, "there is nothing to bake: the scene has no triangles");
    for (uint32_t i = 0; i < scene.parts().size(); ++i) {
        const DrawnPart& part = scene.parts()[i];
        const std::string obstacle = document.obstacle(part.node, part.primitive);
        if (obstacle == "skins")
            ++c.skinned;
        else if (!obstacle.empty())
            ++c.morphed;
        else if (const MaterialDesc& m = scene.material(part.material); m.transmission > 0 && m.metallic < 1)
            ++c.transparent;
        else
            c.parts.push_back(i);
    }
    for (const uint32_t p : c.parts) c.animated += document.animated(scene.parts()[p].node);
    if (c.parts.empty())
        throw Error(Exit::unsupported,
                    fmt::format("there is nothing to bake: {} surfaces are transparent, {} hang on skins, {} have morph targets",
                                c.transparent, c.skinned, c.morphed));
    return c;
}

// Refused before it is allocated.
void checkMemory(const BakeSettings& s, const Scene& scene, const bake::Layout& layout) {
    const double texels = double(layout.size) * layout.size, each = sizeof(SiteSum) + sizeof(MapTexel) + 48;
    const double needed = texels * each, limit = double(s.render.scene.memory.beside(scene));
    if (needed <= limit) return;
    throw Error(Exit::resources, fmt::format("a light map of {0}x{0} needs about {1}{2}, {3}. Try --size {4}.", layout.size,
                                             memorySize(needed), besideText(scene, needed), s.render.scene.memory.text(),
                                             std::max(1u, uint32_t(std::sqrt(limit / each) * 0.9))));
}

std::size_t mostVertices(const BakeSettings& s) {
    return std::min<std::size_t>(s.render.scene.memory.bytes / (sizeof(SiteSum) + 400), 500'000'000);
}

// Everything between the scene and the values at its sites.
struct Light {
    std::vector<MapTexel> values; // of sites
    std::vector<uint8_t> shines;
};
Light lightAt(const BakeSettings& s, const LoadedScene& loaded, Integrator& integrator, const bake::Sites& sites, const Executor& run,
              Diagnostics& notes, Console& console, Baked& baked) {
    const Scene& scene = *loaded.scene;
    CameraDesc camera;
    bool automatic = false;
    const View view = makeView(s.render, loaded, camera, automatic); // integrators may ask for one
    bake::GatherSettings how = s.gather;
    const std::optional<PathQuery> rays = bake::raysOf(how.estimate, s.render.paths.maxDepth);
    const bool gathers = how.estimate == bake::Estimate::gather;
    how.direct = how.direct && s.render.paths.maxDepth >= 1;
    how.indirect = how.indirect && rays;
    const PathClasses classes = rays ? PathClasses::make(*rays) : PathClasses(0);
    StopToken stop;
    const StopOnSignal signals(stop);
    ProgressBar progress(s.render.progress, s.render.quiet, s.render.budget.seconds);
    const auto workFor = [&](const PathClasses& c) {
        return Work{scene, c,    view.shutter, s.render.seed, s.render.sampler,
                    run,   stop, progress,     notes,         s.render.scene.memory.beside(scene)};
    };
    PrepassSolver solver(s.render.prepass, s.render.scene);
    const SolvedPrepass solved = solver.solve(workFor(s.render.classes)); // as for a picture: the same solution, the same file
    if (solver.choice() && !solved.field) throw Error(Exit::killed, "stopped during the pre-pass; nothing written");
    tellPrepass(solver, solved, console);
    baked.prepassSeconds = solved.seconds;
    std::optional<bake::SiteField> field;
    if (solved.field) field.emplace(solved.field, classes, s.render.classes, gathers);
    const Job job{workFor(classes), view, field ? &*field : nullptr};
    if (!gathers || how.indirect) integrator.prepare(job);
    console.facts(notes);
    const bake::Gather gather(job, dynamic_cast<const CameraIntegrator&>(integrator), how);
    std::vector<SiteSum> sums(sites.count());
    baked.sites = sums.size();
    baked.result = bake::bake(job, gather, sites, sums, s.render.budget, stop);
    progress.clear();
    if (baked.result.ended == Ended::stopped && baked.result.spp == 0)
        throw Error(Exit::killed, "stopped before the first sample was done; nothing written");
    Light light;
    for (const SiteSum& sum : sums) {
        light.values.push_back(bake::valueOf(sum));
        light.shines.push_back(sum.shines);
    }
    return light;
}

Spectrum shownOf(const BakeSettings& s, const MapTexel& t) { return s.lit ? t.outgoing : t.irradiance * (1 / pi); }

// values: what will be shown at each site, in cd/m2.
void chooseExposure(const BakeSettings& s, std::span<const Spectrum> values, std::span<const uint8_t> shines, Baked& baked) {
    baked.automaticExposure = !s.render.exposure && s.gather.estimate != bake::Estimate::view;
    baked.exposure = s.render.exposure.value_or(0);
    if (!baked.automaticExposure) return;
    std::vector<float> rgb;
    for (const Spectrum& v : values) rgb.insert(rgb.end(), v.c.begin(), v.c.end());
    baked.exposure = autoExposure(rgb, shines);
}

bool seenThrough(const Scene& scene, const Chosen& chosen) {
    return std::any_of(chosen.parts.begin(), chosen.parts.end(),
                       [&](uint32_t p) { return scene.material(scene.parts()[p].material).alphaMode != AlphaMode::opaque; });
}

std::vector<std::byte> encodeMap(const BakeSettings& s, std::span<const MapTexel> map, uint32_t size, bool alpha, double exposure) {
    const float scale = float(std::exp2(exposure));
    const std::size_t channels = alpha ? 4 : 3;
    std::vector<uint8_t> bytes(map.size() * channels);
    const auto rounded = [](float v) { return uint8_t(std::lround(clamp01(v) * 255)); };
    for (std::size_t i = 0; i < map.size(); ++i) {
        const Spectrum v = shownOf(s, map[i]) * scale;
        for (std::size_t c = 0; c < 3; ++c) bytes[i * channels + c] = rounded(linearToSrgb(clamp01(v[c])));
        if (alpha) bytes[i * channels + 3] = rounded(map[i].opacity);
    }
    return pngBytes(size, size, int(channels), PixelType::u8, bytes.data(), "light map");
}

void writeIrradiance(const BakeSettings& s, const LoadedScene& loaded, const Baked& baked, std::span<const MapTexel> map,
                     std::span<const uint8_t> sampled) {
    const uint32_t size = baked.layout.size;
    Picture p{.width = size, .height = size, .window = {0, 0, size, size}, .names = {}, .planes = {}, .metadata = {}};
    const char* names[] = {"R", "G", "B", "outgoing.R", "outgoing.G", "outgoing.B", "sampled"};
    for (const char* name : names) p.add(name);
    for (std::size_t i = 0; i < map.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            p.planes[c][i] = map[i].irradiance[c];
            p.planes[3 + c][i] = map[i].outgoing[c];
        }
        p.planes[6][i] = sampled[i];
    }
    for (auto& [name, value] : bakeRecipe(s, loaded, baked)) p.metadata.emplace_back("chiaro:" + name, value);
    writeExr(s.exr, p);
}

BakedScene bakeLightMap(const BakeSettings& s, const LoadedScene& loaded, const bake::Mirrored& mirrored, Integrator& integrator,
                        const Executor& run, Diagnostics& notes, Console& console, Baked& baked) {
    const Scene& scene = *loaded.scene;
    baked.layout = bake::makeLayout(scene, baked.chosen.parts, s.layout, scene.shutter().open);
    checkMemory(s, *loaded.scene, baked.layout);
    const bake::TexelSites sites(scene, baked.layout);
    baked.layout.overlapping = sites.overlapping();
    baked.sites = sites.count();
    tellBakePlan(s, loaded, baked, console);
    const Light light = lightAt(s, loaded, integrator, sites, run, notes, console, baked);
    const uint32_t size = baked.layout.size;
    std::vector<MapTexel> map(std::size_t(size) * size);
    std::vector<uint8_t> sampled(map.size(), 0), shines;
    std::vector<Spectrum> shown;
    for (std::size_t i = 0; i < light.values.size(); ++i) {
        map[sites.texels()[i]] = light.values[i];
        sampled[sites.texels()[i]] = light.values[i].known;
        if (!light.values[i].known) continue;
        shown.push_back(shownOf(s, light.values[i]));
        shines.push_back(light.shines[i]);
    }
    chooseExposure(s, shown, shines, baked);
    baked.filled = bake::fillUnknown(map, size, s.layout.padding + 1);
    BakedScene out;
    out.mapAlpha = s.lit && seenThrough(scene, baked.chosen);
    out.lightMap = encodeMap(s, map, size, out.mapAlpha, baked.exposure);
    for (const bake::PartLayout& l : baked.layout.parts) {
        BakedPart& part = out.parts.emplace_back(bake::mappedMesh(scene, l, size, mirrored));
        if (s.lit) part.look = BakedLook::lit;
    }
    writeIrradiance(s, loaded, baked, map, sampled);
    baked.files = {s.exr};
    return out;
}

// A vertex that sees the inside of something takes the mean of the others of its surface.
void mendVertices(std::span<MapTexel> values) {
    MapTexel mean{.opacity = 0};
    float n = 0;
    for (const MapTexel& v : values)
        if (v.known) mean.irradiance += v.irradiance, mean.outgoing += v.outgoing, mean.opacity += v.opacity, ++n;
    if (n == 0) return;
    for (MapTexel& v : values)
        if (!v.known) v = {mean.irradiance * (1 / n), mean.outgoing * (1 / n), mean.opacity / n, true};
}

BakedScene bakeVertices(const BakeSettings& s, const LoadedScene& loaded, const bake::Mirrored& mirrored, Integrator& integrator,
                        const Executor& run, Diagnostics& notes, Console& console, Baked& baked) {
    const Scene& scene = *loaded.scene;
    bake::VertexMesh mesh = bake::vertexMesh(scene, baked.chosen.parts, s.layout.density > 0 ? 1 / s.layout.density : 0,
                                             scene.shutter().open, mirrored, mostVertices(s));
    const bake::VertexSites sites(scene, std::move(mesh.begin), mesh.corners);
    baked.vertices = sites.count();
    for (const BakedPart& part : mesh.parts) baked.triangles += part.indices.size() / 3;
    tellBakePlan(s, loaded, baked, console);
    Light light = lightAt(s, loaded, integrator, sites, run, notes, console, baked);
    // A surface without a picture shows what leaves it; one with a picture is tinted, and keeps all of its detail.
    const auto tinted = [&](std::size_t part) {
        const MaterialDesc& m = scene.material(scene.parts()[baked.chosen.parts[part]].material);
        return m.baseColorTexture.texture >= 0 && black(m.emission) && !m.unlit;
    };
    std::vector<Spectrum> shown(light.values.size());
    for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
        mendVertices(std::span(light.values).subspan(mesh.first[p], mesh.first[p + 1] - mesh.first[p]));
        for (uint32_t i = mesh.first[p]; i < mesh.first[p + 1]; ++i)
            shown[i] = tinted(p) ? light.values[i].irradiance * (1 / pi) : light.values[i].outgoing;
    }
    chooseExposure(s, shown, light.shines, baked);
    const float scale = float(std::exp2(baked.exposure));
    BakedScene out;
    for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
        BakedPart& part = out.parts.emplace_back(std::move(mesh.parts[p]));
        if (s.lit) part.look = tinted(p) ? BakedLook::tinted : BakedLook::shining;
        for (uint32_t i = mesh.first[p]; i < mesh.first[p + 1]; ++i) {
            part.irradiance.push_back(light.values[i].irradiance);
            if (!s.lit) continue;
            Spectrum v = shown[i] * scale;
            float alpha = light.values[i].opacity;
            if (tinted(p)) {
                const Hit at = sites.hit(i, 0, {0, 0}); // a point beside the vertex
                const Vec4 own = scene.attributes(at).color;
                v *= Spectrum(own.x, own.y, own.z);
                alpha = own.w;
            }
            part.colors.push_back({clamp01(v[0]), clamp01(v[1]), clamp01(v[2]), clamp01(alpha)});
        }
    }
    return out;
}

} // namespace

int runBake(const Arguments& arguments) {
    BakeSettings s;
    readBakeSettings(arguments, s);
    const RenderSettings& r = s.render;
    const auto integrator = makeIntegrator(r.integrator);
    Console console(r.quiet);
    Diagnostics notes;
    for (const std::filesystem::path& file : {s.output, s.bin, s.exr})
        if (!file.empty()) checkWritable(file);
    PrepassSolver(r.prepass, r.scene).checkFile();
    const Executor run(r.threads);
    tellHeader(r, run, console);

    std::optional<SceneDesc> builtin;
    bake::Mirrored mirrored;
    LoadedScene loaded = loadScene(r.scene, notes, run, [&](const SceneDesc& desc) {
        mirrored = bake::mirroredInstances(desc);
        if (r.scene.operand.starts_with('@')) builtin = desc;
    });
    GltfDocument document = openDocument(s, loaded, builtin);
    Baked baked;
    baked.chosen = chooseParts(*loaded.scene, document);
    if (s.gather.estimate != bake::Estimate::view)
        if (const auto unseen = unseenPaths(*loaded.scene, r.integrator, r.paths, r.prepass.get())) notes.warn(*unseen);
    console.warnings(notes);
    BakedScene out = (s.toVertex ? bakeVertices : bakeLightMap)(s, loaded, mirrored, *integrator, run, notes, console, baked);
    out.generator = fmt::format("chiaro {}", version);
    out.notes = bakeRecipe(s, loaded, baked);
    document.apply(out);
    document.write(s.output);
    if (!s.bin.empty()) baked.files.insert(baked.files.begin(), s.bin);
    baked.files.insert(baked.files.begin(), s.output);
    warnOfBake(s, loaded, baked, notes);
    console.warnings(notes);
    tellBaked(s, baked, console);
    const int code = baked.result.ended == Ended::stopped    ? int(Exit::stopped)
                     : r.strict && !notes.warnings().empty() ? int(Exit::warning)
                                                             : int(Exit::done);
    if (r.json) printBakeSummary(s, baked, notes, code);
    return code;
}

} // namespace chiaro::cli
