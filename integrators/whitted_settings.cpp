#include "integrators/whitted_settings.h"
#include "core/math/pixel_pattern.h"
#include <cmath>
#include <fmt/format.h>

namespace chiaro {
namespace {

constexpr OptionSpec table[] = {
    {"area", OptionType::choice, "centre", 0, 0, "centre|sample",
     "area lights: one light at the centre with a hard shadow, or one random sample of all lights at each hit (soft shadows)"},
    {"shadows", OptionType::choice, "filtered", 0, 0, "filtered|opaque|none",
     "what transparent surfaces do to light that comes straight through them: filter and colour it, or stop it; none: no shadows"},
    {"ambient", OptionType::real, "0", 0, 1e9, "", "radiance of a constant ambient light, times the diffuse albedo (layer \"other\")"},
    {"ambient-r", OptionType::real, "1", 0, 1e9, "", "its red, times ambient"},
    {"ambient-g", OptionType::real, "1", 0, 1e9, "", "its green"},
    {"ambient-b", OptionType::real, "1", 0, 1e9, "", "its blue"},
    {"fresnel", OptionType::choice, "exact", 0, 0, "exact|schlick", "reflectance of smooth dielectrics"},
    {"glossy", OptionType::choice, "direct", 0, 0, "direct|mirror",
     "rough lobes: direct light alone, or also one ray as if they were smooth"},
    {"transparency", OptionType::choice, "refractive", 0, 0, "refractive|filtered|interpolated|specular-added",
     "refraction, or straight on: added to the surface's own shade, blended with it, or blended with all but its highlights"},
    attenuationOption,
    c1Option,
    c2Option,
    c3Option,
    {"ray-falloff", OptionType::boolean, "off", 0, 0, "",
     "multiply by min(1, 1/d) along every ray, as some old texts do; radiance does not fade in truth"},
    {"min-weight", OptionType::real, "1e-5", 0, 1, "", "adaptive tree depth: a ray whose share of the pixel is smaller is not cast"},
    {"max-nodes", OptionType::integer, "4096", 1, 1e6, "", "most rays of one tree, shadow rays apart"},
    {"aa", OptionType::choice, "filter", 0, 0, "filter|centre|grid|jitter|poisson|adaptive",
     "anti-aliasing: samples from the pixel filter, or on a pattern (--aa MODE:N sets aa-samples too)"},
    {"aa-samples", OptionType::integer, "16", 1, 4096, "", "positions of the pattern; of grid and jitter a square number"},
    {"aa-contrast", OptionType::real, "0.1", 0, 1, "",
     "aa=adaptive: (max - min)/(max + min) beside a pixel that makes it take all samples"},
};

template <class E> E choice(const Options& o, std::string_view key) {
    for (const OptionSpec& s : table) {
        if (s.name != key) continue;
        std::string_view rest = s.choices;
        for (int i = 0; !rest.empty(); ++i) {
            const std::size_t end = rest.find('|');
            if (rest.substr(0, end) == o.text(key)) return E(i);
            rest = end == rest.npos ? std::string_view() : rest.substr(end + 1);
        }
    }
    throw Error(Exit::internal, fmt::format("whitted: {}={} is not described", key, o.text(key)));
}

} // namespace

std::span<const OptionSpec> WhittedSettings::specs() { return table; }

WhittedSettings::WhittedSettings(const Options& o)
    : area(choice<Area>(o, "area")), shadows(choice<Shadows>(o, "shadows")), fresnel(choice<Fresnel>(o, "fresnel")),
      glossy(choice<Glossy>(o, "glossy")), transparency(choice<Transparency>(o, "transparency")),
      ambient(Spectrum(float(o.real("ambient-r")), float(o.real("ambient-g")), float(o.real("ambient-b"))) * float(o.real("ambient"))),
      attenuation(Attenuation::from(o)), rayFalloff(o.boolean("ray-falloff")), minWeight(float(o.real("min-weight"))),
      maxNodes(uint32_t(o.integer("max-nodes"))), antiAliasing(choice<AntiAliasing>(o, "aa")), samples(uint32_t(o.integer("aa-samples"))),
      contrast(float(o.real("aa-contrast"))) {
    if (antiAliasing == AntiAliasing::filter || antiAliasing == AntiAliasing::centre) samples = 1;
    if (antiAliasing != AntiAliasing::grid && antiAliasing != AntiAliasing::jitter) return;
    const auto side = uint32_t(std::lround(std::sqrt(double(samples))));
    if (side * side != samples)
        throw Error(Exit::usage, fmt::format("whitted: aa={} needs a square number of aa-samples, not {}; give {} or {}", o.text("aa"),
                                             samples, side * side, (side + 1) * (side + 1)));
}

// Every variant bends some class of light paths; only those that it leaves alone are covered.
Traits WhittedSettings::traits() const {
    Traits t;
    const bool sampled = area == Area::sample, fades = attenuation.physical && shadows != Shadows::none;
    const bool refractive = transparency == Transparency::refractive;
    t.mergeable = antiAliasing != AntiAliasing::adaptive;
    const bool own = refractive && fresnel == Fresnel::exact; // mirrors and refraction are the materials' own
    t.field = own ? "S* E" : "E";
    t.deterministic = !sampled && (antiAliasing == AntiAliasing::filter || antiAliasing == AntiAliasing::centre ||
                                   antiAliasing == AntiAliasing::grid || antiAliasing == AntiAliasing::adaptive);
    if (antiAliasing == AntiAliasing::filter) t.deterministic = false; // the filter's positions are random
    t.unbiased = sampled && shadows == Shadows::opaque && fades && own && glossy == Glossy::direct && black(ambient) && !rayFalloff;
    // Shown otherwise than light goes: an area light as a point, bent or unshaded light, mirrors in place of rough lobes.
    t.approximates = std::string(sampled ? "L" : "(La|Ld)") + " (D|G) " + (glossy == Glossy::mirror ? "(S|G)* E" : "S* E");
    if (glossy == Glossy::mirror || !own || rayFalloff)
        t.approximates += glossy == Glossy::mirror ? " | (La|Le) (S|G)* E" : " | (La|Le) S* E";
    if (rayFalloff) {
        t.covers = "Le E"; // nothing else has no distance
        return t;
    }
    const std::string mirrors = own ? " S* E" : " E";
    // Classic lamps are no light of this world, nor is light without shadows.
    const std::string lit = shadows == Shadows::none ? ""
                            : sampled                ? (attenuation.physical ? "L" : "(La|Le)")
                            : attenuation.physical   ? "Ld"
                                                     : "";
    const std::string lobes = refractive ? " (D|G)" : transparency == Transparency::filtered ? "" : " D";
    t.covers = "(La|Le)" + mirrors;
    if (!lit.empty() && !lobes.empty()) t.covers = lit + lobes + mirrors + " | " + t.covers;
    return t;
}

} // namespace chiaro
