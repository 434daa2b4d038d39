#include "tools/cli/bake_settings.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

constexpr const char* standardSamples = "256";

// What `chiaro render` would have been given: all that means the same there.
Arguments asRender(const Arguments& from) {
    constexpr std::string_view own[] = {"output", "size", "estimate", "light", "to", "mode", "density", "padding", "uv"};
    const std::span<const Command> all = commands();
    Arguments to;
    to.command = &*std::find_if(all.begin(), all.end(), [](const Command& c) { return c.name == "render"; });
    to.operands = from.operands;
    to.line = from.line;
    for (const OptionRow& o : from.command->options)
        if (from.given(o.name) && std::find(std::begin(own), std::end(own), o.name) == std::end(own)) to.set(o.name, from.all(o.name));
    if (!from.given("spp") && !from.given("time")) to.set("spp", {standardSamples});
    return to;
}

void readOutput(const Arguments& a, BakeSettings& s) {
    std::string name = a.given("output") ? a.text("output") : "{scene}-baked.glb";
    if (name == "-") throw Error(Exit::usage, "-o -: a scene does not go to stdout; give a file name ending in .glb or .gltf");
    const auto expand = [&](std::string_view from, const std::string& to) {
        for (std::size_t at = name.find(from); at != std::string::npos; at = name.find(from, at + to.size()))
            name.replace(at, from.size(), to);
    };
    expand("{scene}", s.render.scene.stem());
    expand("{integrator}", std::string(s.render.integrator.entry->name));
    s.output = name;
    const std::string extension = s.output.extension().string();
    if (extension != ".glb" && extension != ".gltf")
        throw Error(Exit::usage, fmt::format("-o {}: chiaro bake writes .glb and .gltf; give one of these endings", name));
    std::error_code ignored;
    if (!s.render.scene.operand.starts_with('@') && std::filesystem::equivalent(s.output, s.render.scene.operand, ignored))
        throw Error(Exit::usage,
                    fmt::format("-o {}: this is the scene itself; give another name, so that it is there to bake again", name));
    if (extension == ".gltf") s.bin = std::filesystem::path(s.output).replace_extension(".bin");
    if (!s.toVertex) s.exr = std::filesystem::path(s.output).replace_extension(".irradiance.exr");
}

void readEstimate(const Arguments& a, BakeSettings& s) {
    const IntegratorChoice& choice = s.render.integrator;
    const bool light = choice.entry->traits(choice.options).lightTransport;
    s.gather.estimate = light ? bake::Estimate::gather : bake::Estimate::view;
    if (a.given("estimate")) {
        const bool look = parseChoice("estimate", a.text("estimate"), {"gather", "look"}) == 1;
        if (!light && !look)
            throw Error(Exit::usage,
                        fmt::format("--estimate gather: {} is a view, not light, and can only be looked at; use --estimate look",
                                    choice.entry->name));
        if (light && look) s.gather.estimate = bake::Estimate::look;
    }
    const std::size_t which = parseChoice("light", a.text("light"), {"all", "direct", "indirect"});
    if (which > 0 && s.gather.estimate != bake::Estimate::gather)
        throw Error(Exit::usage, fmt::format("--light {}: only --estimate gather knows one from the other", a.text("light")));
    s.gather.direct = which != 2;
    s.gather.indirect = which != 1;
}

} // namespace

void readBakeSettings(const Arguments& a, BakeSettings& s) {
    s.arguments = asRender(a);
    s.render = readSettings(s.arguments);
    s.toVertex = parseChoice("to", a.text("to"), {"lightmap", "vertex"}) == 1;
    s.lit = parseChoice("mode", a.text("mode"), {"lit", "keep"}) == 0;
    s.layout.uv = bake::UvChoice(parseChoice("uv", a.text("uv"), {"auto", "keep", "new"}));
    if (a.given("size")) s.layout.size = uint32_t(parseWhole("size", a.text("size"), 4, s.layout.most));
    if (a.given("density")) s.layout.density = parseReal("density", a.text("density"), 1e-9, 1e9);
    s.layout.padding = uint32_t(parseWhole("padding", a.text("padding"), 1, 64));
    for (const char* option : {"size", "padding", "uv"})
        if (s.toVertex && a.given(option))
            throw Error(Exit::usage, fmt::format("--{} is about light maps; leave it out with --to vertex", option));
    if (a.given("size") && a.given("density"))
        throw Error(Exit::usage, "--size and --density both say how fine the light map is; give one of them");
    readEstimate(a, s);
    readOutput(a, s);
}

} // namespace chiaro::cli
