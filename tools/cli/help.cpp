// chiaro help [COMMAND|TOPIC], and what --help prints: made from the tables.
#include "scenes/builtin.h"
#include "tools/cli/command.h"
#include "tools/cli/version.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

struct Topic {
    std::string_view name, text;
};
constexpr auto topics = std::to_array<Topic>({
    {"units", R"(Units
  Lengths are metres, angles on the command line degrees, times seconds.
  Light is photometric: point and spot lights in candela, directional lights in lux, emissive surfaces and environments in cd/m2 (nit).
  A value of 1.0 in an EXR is 1 cd/m2 a channel, linear Rec.709. Exposure (x 2^EV) is applied to the PNG alone.
  Planar depth (layer Z) is in metres along the viewing axis, inf where nothing is.
  A depth of a path counts scatterings: 0 emission seen directly, 1 direct light, 2 one indirect bounce.
)"},
    {"paths", R"(Light paths
  Written from the light to the eye, in Heckbert's notation (1990):
    L   any light; La area, Ld point, spot or directional, Le environment
    D   diffuse, G glossy (rough), S specular (mirror, smooth glass); suffix R reflected, T transmitted: DR, ST ...
    E   the eye
    .   any event;  ? * + | ( )  as in regular expressions
  Examples
    L D E       direct diffuse light
    L S+ D E    caustics
    L D D+ E    colour bleeding
  `chiaro integrators` says which paths each integrator covers, and which it cannot find.
)"},
    {"prepass", R"(Pre-passes
  --prepass NAME[:key=value,...] solves the diffuse light of a scene before the picture: what reaches a surface after it was scattered once
  or more. It takes the place of the constant ambient light of the integrators that have room for it; direct light and everything specular
  stay theirs (the classical two-pass method: Wallace, Cohen, Greenberg 1987). Lists of integrators give it to those alone.
  --prepass-file FILE keeps the solution: where FILE fits it is loaded, where it is not there it is made. Another camera, size or lens needs
  no other; another scene, time, seed, sampler, instruction set or other options do, and such a file is refused with the reason.
  Without a file `compare` and `agree` solve it for every seed, so that what is random in it is part of the error bars; its seconds are
  billed to every integrator that uses it.
  `chiaro integrators` lists the pre-passes and who takes them.
)"},
    {"noise", R"(Noise
  The line `done` gives two errors of the picture, and --noise P ends a render by the first of them.
  noise  the average standard error of a pixel's luminance (root mean square over 2 x 2 pixels) over the average luminance.
  mean   the 95 % interval of the whole picture's mean luminance, relative, by Student's t.
  Both come from how far every pixel moved when its samples doubled last. A scrambled sequence of samples is better than a random one, by
  how much differs from pixel to pixel; the movements of the last two doublings say it: if they fall by q (in variance, 1/4 to 1/2), then
  q / (1 - q) of the last one's variance is left. Between powers of two the error falls by the square root law. Each pixel gives one degree
  of freedom; where a few pixels hold most of the error the interval is wider (Satterthwaite 1946). Where pixels share light paths or
  photons, blocks of 8 x 8 pixels are looked at in their place.
  --noise P looks at 16, 32, 64 ... samples a pixel, and there finds the number of samples at which the noise is below P percent with 95 %
  confidence, its own uncertainty included: few looks, and never before 16 samples, so that luck at one of them does not end the render.
  With --spp or --time too, the first limit reached ends it; alone it ends at 65536 samples at the latest.
  What no sample has found yet (a caustic through glass, by path) no error can tell; and the error of a biased method is not noise: there
  the line says that the interval is of the noise alone. `chiaro agree` and `chiaro compare` judge by independent pictures.
  The layers error.R, error.G, error.B of an EXR come from the halves of the samples, and err on the safe side.
)"},
    {"exit-codes", R"(Exit codes
  0    done, also when a budget ended the render
  1    warnings, under --strict
  2    a check failed
  3    not supported, or not comparable (a required extension, picture sizes)
  4    a file: missing, unreadable, malformed or unwritable
  5    stopped early by Ctrl-C or SIGTERM; a usable result and a checkpoint were written
  6    memory or disk
  64   usage: unknown command, option or value
  70   internal error
  130  second Ctrl-C; nothing was written
)"},
});

std::string wrapped(std::string_view text, std::size_t indent, std::size_t width) {
    std::string out, line;
    while (!text.empty()) {
        const std::size_t end = text.find(' ');
        const std::string_view word = text.substr(0, end);
        if (!line.empty() && indent + line.size() + 1 + word.size() > width) {
            out += line + "\n" + std::string(indent, ' ');
            line.clear();
        }
        if (!line.empty()) line += ' ';
        line += word;
        text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    }
    return out + line;
}

std::string optionHelp(const OptionRow& o) {
    std::string left = o.letter ? fmt::format("  -{}, --{}", o.letter, o.name) : fmt::format("      --{}", o.name);
    if (!o.metavar.empty()) left += fmt::format(" {}", o.metavar);
    std::string help(o.help);
    if (!o.standard.empty()) help += fmt::format(" (default {})", o.standard);
    constexpr std::size_t column = 36, width = 110;
    if (left.size() + 2 > column)
        left += "\n" + std::string(column, ' ');
    else
        left.resize(column, ' ');
    return left + wrapped(help, column, width) + "\n";
}

std::string sceneTopic() {
    std::string text = "\nScenes\n  SCENE is file.gltf, file.glb or a scene inside the program:\n";
    for (const BuiltinScene& s : builtinScenes()) text += fmt::format("    {:<18} {}\n", s.name, s.summary);
    return text + "  A scene without a camera is framed automatically, one without light is lit by a neutral studio; both are announced.\n"
                  "  `chiaro info SCENE` tells what is in it and what Chiaro will use, approximate or ignore.\n";
}

} // namespace

std::string overview() {
    std::string text = fmt::format("chiaro {}: physically based light transport for glTF scenes\n\n", version);
    for (const Command& c : commands()) text += fmt::format("  chiaro {:<30} {}\n", fmt::format("{} {}", c.name, c.operands), c.summary);
    text += fmt::format("  chiaro {:<30} {}\n\n", "--version", "the version alone");
    return text + "A SCENE is file.gltf, file.glb or a built-in one (chiaro scenes). To begin:  chiaro render @cornell\n";
}

std::string commandHelp(const Command& command) {
    std::string text =
        fmt::format("chiaro {} {}{}\n  {}\n", command.name, command.operands, command.options.empty() ? "" : " [options]", command.summary);
    std::vector<std::string_view> groups;
    for (const OptionRow& o : command.options)
        if (std::find(groups.begin(), groups.end(), o.group) == groups.end()) groups.push_back(o.group);
    for (std::string_view group : groups) {
        text += fmt::format("\n{}\n", group);
        for (const OptionRow& o : command.options)
            if (o.group == group) text += optionHelp(o);
    }
    return command.notes ? text + command.notes() : text;
}

int runHelp(const Arguments& arguments) {
    if (arguments.operands.empty()) {
        fmt::print("{}", overview());
        return 0;
    }
    const std::string& name = arguments.operands[0];
    std::vector<std::string> names;
    for (const Command& c : commands()) {
        if (c.name == name) {
            fmt::print("{}{}", commandHelp(c), name == "scenes" ? sceneTopic() : ""); // a topic of the same name
            return 0;
        }
        names.emplace_back(c.name);
    }
    for (const Topic& t : topics) {
        if (t.name == name) {
            fmt::print("{}", t.text);
            return 0;
        }
        names.emplace_back(t.name);
    }
    const std::string near = nearest(name, names);
    throw Error(Exit::usage, fmt::format("no help on \"{}\"{}; topics: units, paths, prepass, noise, exit-codes, scenes", name,
                                         near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

} // namespace chiaro::cli
