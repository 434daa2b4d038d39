#include "io/picture.h"
#include "io/file_bytes.h"
#include "io/replace_file.h"
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <functional>

namespace chiaro {
namespace {

void setAttributes(OIIO::ImageSpec& spec, const Metadata& metadata) {
    for (const auto& [name, value] : metadata) {
        if (const auto* text = std::get_if<std::string>(&value)) spec.attribute(name, *text);
        if (const auto* number = std::get_if<int>(&value)) spec.attribute(name, *number);
        if (const auto* real = std::get_if<double>(&value)) spec.attribute(name, OIIO::TypeDesc::DOUBLE, real);
    }
    spec.attribute("DateTime", ""); // else OpenImageIO adds the time of writing, and equal pictures differ
}

std::vector<unsigned char> encoded(const std::string& name, const char* format, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                                   const void* pixels) {
    const auto out = OIIO::ImageOutput::create(format);
    OIIO::Filesystem::IOVecOutput memory;
    const auto failed = [&] {
        return Error(Exit::internal,
                     fmt::format("cannot encode {} ({})", name, out ? out->geterror() : "no writer for " + std::string(format)));
    };
    if (!out || !out->set_ioproxy(&memory)) throw failed();
    if (!out->open(fmt::format("memory.{}", format), spec) || !out->write_image(type, pixels) || !out->close()) throw failed();
    return memory.buffer();
}

// Encoded in memory, then written by replaceFile, which knows why a disk refuses.
void encode(const std::filesystem::path& file, const char* format, const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const void* pixels) {
    const std::vector<unsigned char> bytes = encoded(file.string(), format, spec, type, pixels);
    replaceFile(file, std::as_bytes(std::span(bytes)));
}

void addColor(Picture& picture, const char* const (&names)[3], std::span<const Spectrum> values) {
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<float>& plane = picture.add(names[c]);
        for (std::size_t i = 0; i < values.size(); ++i) plane[i] = values[i][c];
    }
}

template <class F> std::vector<Spectrum> perPixel(const Rect& window, F&& value) {
    std::vector<Spectrum> all;
    all.reserve(window.area());
    for (uint32_t y = window.y0; y < window.y1; ++y)
        for (uint32_t x = window.x0; x < window.x1; ++x) all.push_back(value(Pixel{x, y}));
    return all;
}

// Three planes of which a pixel gives the values together.
void addThree(Picture& picture, std::array<const char*, 3> names, const std::function<std::array<float, 3>(Pixel)>& values) {
    for (const char* name : names) picture.add(name);
    const auto planes = picture.planes.end() - 3;
    const Rect& window = picture.window;
    std::size_t i = 0;
    for (uint32_t y = window.y0; y < window.y1; ++y)
        for (uint32_t x = window.x0; x < window.x1; ++x, ++i) {
            const std::array<float, 3> three = values({x, y});
            for (int k = 0; k < 3; ++k) planes[k][i] = three[std::size_t(k)];
        }
}

void addCosts(Picture& picture, const Film& film) {
    addThree(picture, {"cost.time", "cost.rays", "cost.depth"}, [&](Pixel p) -> std::array<float, 3> {
        const Cost c = film.cost(p);
        return {c.microseconds, c.rays, c.depth};
    });
}

void addGathered(Picture& picture, const Film& film) {
    addThree(picture, {"photons.density", "photons.radius", "photons.count"}, [&](Pixel p) -> std::array<float, 3> {
        const Gathered g = film.gathered(p);
        return {g.density, g.radius, g.count};
    });
}

Metadata readAttributes(const OIIO::ImageSpec& spec) {
    Metadata all;
    for (const OIIO::ParamValue& p : spec.extra_attribs) {
        const std::string name = p.name().string();
        if (p.type() == OIIO::TypeDesc::INT)
            all.emplace_back(name, p.get_int());
        else if (p.type() == OIIO::TypeDesc::DOUBLE || p.type() == OIIO::TypeDesc::FLOAT)
            all.emplace_back(name, p.type() == OIIO::TypeDesc::DOUBLE ? p.get<double>() : double(p.get_float()));
        else
            all.emplace_back(name, p.get_string());
    }
    return all;
}

} // namespace

std::vector<float>& Picture::add(std::string name) {
    names.push_back(std::move(name));
    return planes.emplace_back(window.area());
}

const std::vector<float>* Picture::find(std::string_view name) const {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? nullptr : &planes[std::size_t(at - names.begin())];
}

const MetadataValue* Picture::attribute(std::string_view name) const {
    const auto at = std::find_if(metadata.begin(), metadata.end(), [&](const auto& a) { return a.first == name; });
    return at == metadata.end() ? nullptr : &at->second;
}

Picture pictureOf(const Film& film, std::span<const float> depth, FirstHitLayers firstHit) {
    const FilmLayout& layout = film.layout();
    Picture picture{.width = layout.width, .height = layout.height, .window = layout.crop, .names = {}, .planes = {}, .metadata = {}};
    const Rect& window = layout.crop;
    addColor(picture, {"R", "G", "B"}, perPixel(window, [&](Pixel p) { return film.mean(p); }));
    if (firstHit.albedo)
        addColor(picture, {"albedo.R", "albedo.G", "albedo.B"}, perPixel(window, [&](Pixel p) { return film.aov(p, Aov::albedo); }));
    if (firstHit.normal)
        addColor(picture, {"normal.X", "normal.Y", "normal.Z"}, perPixel(window, [&](Pixel p) { return film.aov(p, Aov::normal); }));
    if (!depth.empty()) picture.add("Z").assign(depth.begin(), depth.end());
    addColor(picture, {"error.R", "error.G", "error.B"}, film.standardError());
    std::vector<float>& samples = picture.add("samples");
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = float(film.count({window.x0 + uint32_t(i % window.width()), window.y0 + uint32_t(i / window.width())}));
    if (layout.costs) addCosts(picture, film);
    if (layout.photons) addGathered(picture, film);
    for (std::size_t l = 0; l < layout.layers.size(); ++l) {
        const std::string &name = layout.layers[l], r = name + ".R", g = name + ".G", b = name + ".B";
        addColor(picture, {r.c_str(), g.c_str(), b.c_str()}, perPixel(window, [&](Pixel p) { return film.mean(p, int(l)); }));
    }
    return picture;
}

void writeExr(const std::filesystem::path& file, const Picture& picture) {
    const int channels = int(picture.planes.size());
    OIIO::ImageSpec spec(int(picture.window.width()), int(picture.window.height()), channels, OIIO::TypeDesc::FLOAT);
    spec.channelnames = picture.names;
    spec.x = int(picture.window.x0);
    spec.y = int(picture.window.y0);
    spec.full_width = int(picture.width);
    spec.full_height = int(picture.height);
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "lin_rec709");
    // ITU-R BT.709-6 primaries and D65.
    static constexpr float chromaticities[8] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), chromaticities);
    spec.attribute("chiaro:colorspace", "lin_rec709"); // OpenImageIO renames its own on reading
    setAttributes(spec, picture.metadata);

    std::vector<float> interleaved(picture.window.area() * std::size_t(channels));
    for (std::size_t c = 0; c < picture.planes.size(); ++c)
        for (std::size_t i = 0; i < picture.planes[c].size(); ++i) interleaved[i * std::size_t(channels) + c] = picture.planes[c][i];
    encode(file, "exr", spec, OIIO::TypeDesc::FLOAT, interleaved.data());
}

void writePng(const std::filesystem::path& file, uint32_t width, uint32_t height, std::span<const uint8_t> rgb, const Metadata& metadata,
              bool srgb) {
    OIIO::ImageSpec spec(int(width), int(height), 3, OIIO::TypeDesc::UINT8);
    if (srgb) spec.attribute("oiio:ColorSpace", "sRGB");
    Metadata text; // a PNG keeps text alone
    for (const auto& [name, value] : metadata)
        text.emplace_back(name, std::visit([](const auto& v) { return fmt::format("{}", v); }, value));
    setAttributes(spec, text);
    encode(file, "png", spec, OIIO::TypeDesc::UINT8, rgb.data());
}

std::vector<std::byte> pngBytes(uint32_t width, uint32_t height, int channels, PixelType type, const void* pixels,
                                const std::string& name) {
    const OIIO::TypeDesc stored = type == PixelType::u8 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16;
    OIIO::ImageSpec spec(int(width), int(height), channels, stored);
    spec.attribute("oiio:UnassociatedAlpha", 1); // colours are not multiplied by alpha
    setAttributes(spec, {});
    const std::vector<unsigned char> bytes = encoded(name, "png", spec,
                                                     type == PixelType::f32   ? OIIO::TypeDesc(OIIO::TypeDesc::FLOAT)
                                                     : type == PixelType::f16 ? OIIO::TypeDesc(OIIO::TypeDesc::HALF)
                                                                              : stored,
                                                     pixels);
    const auto* begin = reinterpret_cast<const std::byte*>(bytes.data());
    return {begin, begin + bytes.size()};
}

Picture readPicture(const std::filesystem::path& file) {
    const auto in = OIIO::ImageInput::open(file.string());
    if (!in) {
        std::error_code ignored;
        const bool there = std::filesystem::exists(file, ignored);
        const std::string why = OIIO::geterror();
        throw Error(Exit::file, there ? fmt::format("{}: not a readable picture ({})", file.string(), why)
                                      : fmt::format("{}: no such file{}", file.string(), similarNames(file)));
    }
    const OIIO::ImageSpec spec = in->spec();
    if (spec.depth > 1 || spec.deep)
        throw Error(Exit::unsupported, fmt::format("{}: deep or volumetric pictures are not read", file.string()));
    const auto unsignedOr0 = [](int v) { return uint32_t(std::max(v, 0)); };
    const uint32_t x = unsignedOr0(spec.x - spec.full_x), y = unsignedOr0(spec.y - spec.full_y);
    const uint32_t right = x + uint32_t(spec.width), bottom = y + uint32_t(spec.height);
    Picture picture{.width = std::max(uint32_t(spec.full_width), right),
                    .height = std::max(uint32_t(spec.full_height), bottom),
                    .window = {x, y, right, bottom},
                    .names = {},
                    .planes = {},
                    .metadata = readAttributes(spec),
                    .integer = !spec.format.is_floating_point()};
    const std::size_t channels = std::size_t(spec.nchannels);
    std::vector<float> interleaved(picture.window.area() * channels);
    if (!in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, interleaved.data()))
        throw Error(Exit::file, fmt::format("{}: damaged picture ({})", file.string(), in->geterror()));
    for (std::size_t c = 0; c < channels; ++c) {
        std::vector<float>& plane = picture.add(spec.channelnames[c]);
        for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = interleaved[i * channels + c];
    }
    return picture;
}

} // namespace chiaro
