#include "io/color.h"
#include "io/color_config.h"
#include <OpenColorIO/OpenColorIO.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sstream>

namespace chiaro {
namespace {

namespace OCIO = OCIO_NAMESPACE;

constexpr const char* ownSpace = "lin_rec709"; // what our pixels are, in our own configuration

OCIO::ConstConfigRcPtr builtIn() {
    std::istringstream text(builtInColorConfig);
    return OCIO::Config::CreateFromStream(text);
}

struct Source {
    OCIO::ConstConfigRcPtr config;
    std::string name;
};
Source load(const std::string& path) {
    const char* environment = std::getenv("OCIO");
    const std::string from = !path.empty() ? path : environment ? environment : "";
    try {
        if (from.empty()) return {builtIn(), "built in"};
        Source source{OCIO::Config::CreateFromFile(from.c_str()), from};
        source.config->validate();
        return source;
    } catch (const OCIO::Exception& e) {
        const std::string why = e.what();
        throw Error(Exit::file, fmt::format("{}: cannot be used as an OpenColorIO configuration{}: {}", from,
                                            path.empty() ? " (set by $OCIO)" : "", why.substr(0, why.find('\n'))));
    }
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

struct NamedView {
    std::string display, view;
};
std::vector<NamedView> viewsOf(const OCIO::Config& config) {
    std::vector<NamedView> all;
    for (int d = 0; d < config.getNumDisplays(); ++d) {
        const char* display = config.getDisplay(d);
        for (int v = 0; v < config.getNumViews(display); ++v) all.push_back({display, config.getView(display, v)});
    }
    return all;
}

NamedView chooseView(const OCIO::Config& config, const std::string& wanted) {
    if (wanted.empty()) {
        const char* display = config.getDefaultDisplay();
        return {display, config.getDefaultView(display)};
    }
    std::vector<std::string> names, lowered;
    for (const NamedView& v : viewsOf(config)) {
        if (lower(v.view) == lower(wanted) || lower(v.display + "/" + v.view) == lower(wanted)) return v;
        if (std::find(names.begin(), names.end(), v.view) == names.end()) {
            names.push_back(v.view);
            lowered.push_back(lower(v.view));
        }
    }
    const std::string near = nearest(lower(wanted), lowered);
    const auto at = std::find(lowered.begin(), lowered.end(), near);
    throw Error(Exit::usage,
                fmt::format("no view \"{}\"; have \"{}\"{}", wanted, fmt::join(names, "\", \""),
                            near.empty() ? "" : fmt::format("; did you mean \"{}\"?", names[std::size_t(at - lowered.begin())])));
}

// Our pixels in a foreign configuration: by the usual names of linear Rec.709, else through the interchange role that both sides know.
OCIO::ConstProcessorRcPtr intoConfig(const OCIO::ConstConfigRcPtr& config, std::string& space, std::string& note) {
    for (const char* name :
         {"lin_rec709", "lin_srgb", "Linear Rec.709 (sRGB)", "Utility - Linear - Rec.709", "Utility - Linear - sRGB", "Linear"})
        if (config->getColorSpace(name)) {
            space = name;
            return nullptr;
        }
    space = OCIO::ROLE_SCENE_LINEAR;
    try {
        return OCIO::Config::GetProcessorFromConfigs(builtIn(), ownSpace, config, OCIO::ROLE_SCENE_LINEAR);
    } catch (const OCIO::Exception&) {
        note = "the OpenColorIO configuration does not say what linear Rec.709 is; its scene_linear role is taken for it";
        return nullptr;
    }
}

void run(const OCIO::ConstCPUProcessorRcPtr& processor, std::span<float> rgb) {
    if (!processor) return;
    OCIO::PackedImageDesc image(rgb.data(), long(rgb.size() / 3), 1, 3);
    processor->apply(image);
}

} // namespace

struct DisplayTransform::Processors {
    OCIO::ConstCPUProcessorRcPtr into, display;
};

DisplayTransform::DisplayTransform(const std::string& path, const std::string& wanted) : processors_(std::make_unique<Processors>()) {
    const Source source = load(path);
    source_ = source.name;
    const NamedView chosen = chooseView(*source.config, wanted);
    display_ = chosen.display;
    view_ = chosen.view;
    try {
        std::string space;
        if (const auto into = intoConfig(source.config, space, note_)) processors_->into = into->getDefaultCPUProcessor();
        const auto processor = source.config->getProcessor(space.c_str(), display_.c_str(), view_.c_str(), OCIO::TRANSFORM_DIR_FORWARD);
        processors_->display = processor->getDefaultCPUProcessor();
    } catch (const OCIO::Exception& e) {
        throw Error(Exit::file, fmt::format("{}: view \"{}\" cannot be built: {}", source_, view_, e.what()));
    }
}

DisplayTransform::~DisplayTransform() = default;

bool DisplayTransform::srgb() const noexcept { return display_.find("sRGB") != std::string::npos && view_ != "Raw"; }

void DisplayTransform::apply(std::span<float> rgb, double exposure) const {
    const float scale = float(std::exp2(exposure));
    for (float& v : rgb) v *= scale;
    run(processors_->into, rgb);
    run(processors_->display, rgb);
}

std::vector<uint8_t> DisplayTransform::bytes(std::span<const float> rgb, double exposure) const {
    std::vector<float> encoded(rgb.begin(), rgb.end());
    apply(encoded, exposure);
    std::vector<uint8_t> out(encoded.size());
    std::transform(encoded.begin(), encoded.end(), out.begin(),
                   [](float v) { return uint8_t(v > 0 ? std::min(v, 1.0f) * 255.0f + 0.5f : 0.0f); });
    return out;
}

std::vector<std::string> DisplayTransform::views(const std::string& config) {
    std::vector<std::string> all;
    for (const NamedView& v : viewsOf(*load(config).config)) all.push_back(fmt::format("{} ({})", v.view, v.display));
    return all;
}

double autoExposure(std::span<const float> rgb, std::span<const uint8_t> lamps) {
    std::vector<double> lit, shining;
    for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) {
        const double y = 0.2126 * rgb[i] + 0.7152 * rgb[i + 1] + 0.0722 * rgb[i + 2];
        if (y > 0 && std::isfinite(y)) (!lamps.empty() && lamps[i / 3] ? shining : lit).push_back(y);
    }
    if (shining.size() > lit.size()) lit.insert(lit.end(), shining.begin(), shining.end());
    if (lit.empty()) return 0;
    double logs = 0;
    for (double y : lit) logs += std::log2(y);
    const auto at = lit.begin() + std::ptrdiff_t(double(lit.size() - 1) * 0.995);
    std::nth_element(lit.begin(), at, lit.end());
    const double wanted = std::log2(0.18) - logs / double(lit.size());
    constexpr double slack = 1e-5;                                                // 0.18 as a float is not 0.18
    return std::floor(std::min(wanted, -std::log2(*at)) * 10 + slack) / 10 + 0.0; // + 0.0: no negative zero
}

} // namespace chiaro
