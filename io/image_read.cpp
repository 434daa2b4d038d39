#include "io/image_read.h"
#include "core/math/half.h"
#include "io/exr_header.h"
#include "io/file_bytes.h"
#include "io/webp_read.h"
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <zlib.h>

namespace chiaro {

void undecodable(const std::string& name, std::string why) {
    if (const size_t line = why.find('\n'); line != why.npos) why.resize(line);
    throw Error(Exit::file,
                printable(fmt::format("{}: cannot be decoded ({}). Mend the picture or save it again.", name, why.substr(0, 200))));
}

namespace {

constexpr uint64_t maxPixels = uint64_t(1) << 28; // 16,384 x 16,384

// OpenImageIO would try every plug-in it knows, video and medicine included; a picture says what it is in its first bytes.
struct Format {
    std::string_view begins;
    const char* plugin;
    const char* name;
};
using namespace std::string_view_literals;
constexpr Format formats[] = {{"\x89PNG"sv, "png", "PNG"},
                              {"\xff\xd8\xff"sv, "jpeg", "JPEG"},
                              {"II*\0"sv, "tiff", "TIFF"},
                              {"MM\0*"sv, "tiff", "TIFF"},
                              {"II+\0"sv, "tiff", "TIFF"},
                              {"MM\0+"sv, "tiff", "TIFF"},
                              {"\x76\x2f\x31\x01"sv, "openexr", "OpenEXR"},
                              {"#?"sv, "hdr", "Radiance HDR"},
                              {"BM"sv, "bmp", "BMP"}};
const Format* formatOf(std::span<const std::byte> bytes) {
    const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<size_t>(bytes.size(), 16));
    for (const Format& f : formats)
        if (head.starts_with(f.begins)) return &f;
    return nullptr;
}

std::string pluginFor(std::span<const std::byte> bytes, const std::string& name) {
    if (const Format* known = formatOf(bytes)) return known->plugin;
    if (name.ends_with(".tga") || name.ends_with(".TGA")) return "targa"; // has no mark of its own
    if (bytes.size() > 4 && std::memcmp(bytes.data(), "\xabKTX", 4) == 0)
        undecodable(name, "KTX2; try: gltf-transform ktxdecompress IN OUT");
    undecodable(name, bytes.empty() ? "it is empty" : "no known picture format");
}

uint32_t bigEndian(std::span<const std::byte> bytes, size_t at) {
    uint32_t v = 0;
    for (size_t i = 0; i < 4; ++i) v = v << 8 | std::to_integer<uint32_t>(bytes[at + i]);
    return v;
}
bool damaged(std::span<const std::byte> bytes, size_t at, uint32_t size) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION // no fuzzer finds a checksum
    return false;
#endif
    return bigEndian(bytes, at + 8 + size) != crc32(0, reinterpret_cast<const Bytef*>(&bytes[at + 4]), size + 4);
}

// libpng reports a truncated or damaged file on stderr, past everybody: walk the chunks first (PNG 3rd edition, 5.3: length, type, data,
// CRC; 5.6: IHDR first, then IDAT, IEND last).
void checkPng(std::span<const std::byte> bytes, const std::string& name) {
    bool header = false, data = false;
    for (size_t at = 8; at < bytes.size() && bytes.size() - at >= 12;) {
        const auto is = [&](const char* type) { return std::memcmp(&bytes[at + 4], type, 4) == 0; };
        const uint32_t size = bigEndian(bytes, at);
        header = header || (at == 8 && is("IHDR"));
        data = data || is("IDAT");
        if (!header || (is("IEND") && !data)) undecodable(name, "the PNG has no pixels");
        if (is("IEND")) return;
        if (size > bytes.size() - at - 12) break;
        if ((is("IHDR") || is("PLTE") || is("IDAT")) && damaged(bytes, at, size))
            undecodable(name, "the PNG is damaged: a checksum is wrong");
        at += 12 + size_t(size);
    }
    undecodable(name, fmt::format("the PNG is truncated after {} bytes", bytes.size()));
}

// Grey, grey + alpha, RGB or RGBA out of whatever the file holds: by name where there are names, else the first ones.
std::vector<int> channelsWanted(const OIIO::ImageSpec& spec) {
    const int r = spec.channelindex("R"), g = spec.channelindex("G"), b = spec.channelindex("B");
    std::vector<int> wanted;
    if (r >= 0 && g >= 0 && b >= 0)
        wanted = {r, g, b};
    else if (spec.nchannels - (spec.alpha_channel >= 0) >= 3)
        wanted = {0, 1, 2};
    else
        wanted = {spec.alpha_channel == 0 && spec.nchannels > 1 ? 1 : 0};
    if (spec.alpha_channel >= 0 && spec.alpha_channel != wanted[0]) wanted.push_back(spec.alpha_channel);
    return wanted;
}

// Copies the wanted channels of the pixels stored into the frame shown: where an EXR stores a part of its frame, the rest is 0.
void place(const OIIO::ImageSpec& spec, const std::vector<int>& wanted, size_t size, const std::vector<std::byte>& from, ImageDesc& image) {
    const size_t n = size_t(spec.nchannels), k = wanted.size();
    image.pixels.assign(size_t(image.width) * size_t(image.height) * k * size, std::byte(0));
    for (int y = 0; y < spec.height; ++y)
        for (int x = 0; x < spec.width; ++x) {
            const int toX = spec.x - spec.full_x + x, toY = spec.y - spec.full_y + y;
            if (toX < 0 || toY < 0 || toX >= image.width || toY >= image.height) continue;
            const std::byte* source = &from[(size_t(y) * size_t(spec.width) + size_t(x)) * n * size];
            std::byte* target = &image.pixels[(size_t(toY) * size_t(image.width) + size_t(toX)) * k * size];
            for (size_t c = 0; c < k; ++c) std::memcpy(target + c * size, source + size_t(wanted[c]) * size, size);
        }
}

bool isWebp(std::span<const std::byte> bytes) {
    return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 && std::memcmp(&bytes[8], "WEBP", 4) == 0;
}

void checkSize(const OIIO::ImageSpec& spec, const std::string& name) {
    const auto tooLarge = [](int width, int height) { return width <= 0 || height <= 0 || uint64_t(width) * uint64_t(height) > maxPixels; };
    if (spec.depth > 1 || spec.deep) undecodable(name, "deep or volumetric pixels");
    if (spec.nchannels < 1 || tooLarge(spec.width, spec.height) || tooLarge(spec.full_width, spec.full_height) ||
        uint64_t(spec.width) * uint64_t(spec.height) * uint64_t(spec.nchannels) > 4 * maxPixels)
        undecodable(name, fmt::format("{} x {} pixels of {} channels; the limit is {} pixels of 4", spec.width, spec.height, spec.nchannels,
                                      maxPixels));
}

float srgbToLinear(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); } // IEC 61966-2-1

// Bytes in memory as OpenImageIO reads them. Its own reader (2.4.7) looks before the beginning when a file says a negative offset.
class Memory : public OIIO::Filesystem::IOMemReader {
public:
    using IOMemReader::IOMemReader;
    size_t pread(void* to, size_t size, int64_t offset) override {
        const size_t all = buffer().size();
        if (offset < 0 || size_t(offset) >= all) return 0;
        size = std::min(size, all - size_t(offset));
        std::memcpy(to, buffer().data() + offset, size);
        return size;
    }
    size_t read(void* to, size_t size) override {
        size = pread(to, size, m_pos);
        m_pos += int64_t(size);
        return size;
    }
};

// A picture whose header was read and found good. The reader holds on to the memory.
struct Opened {
    std::string format;
    Memory memory;
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;

    Opened(std::span<const std::byte> bytes, const std::string& name)
        : format(pluginFor(bytes, name)), memory(const_cast<std::byte*>(bytes.data()), bytes.size()) { // reads only, whatever it says
        if (format == "png") checkPng(bytes, name);
        if (format == "openexr") checkExrHeader(bytes, name);
        input = OIIO::ImageInput::create(format);
        if (!input) undecodable(name, OIIO::geterror());
        OIIO::ImageSpec config;
        config["oiio:UnassociatedAlpha"] = 1;
        if (!input->set_ioproxy(&memory) || !input->open(name, spec, config)) undecodable(name, input->geterror());
        checkSize(spec, name);
        // No format read here packs tighter than deflate's 1032 to 1 by much.
        const uint64_t stored = uint64_t(spec.width) * uint64_t(spec.height) * uint64_t(spec.nchannels),
                       shown = uint64_t(spec.full_width) * uint64_t(spec.full_height) * uint64_t(std::min(spec.nchannels, 4));
        if (std::max(stored, shown) * numberSize() > (uint64_t(1) << 26) + 4096 * uint64_t(bytes.size()))
            undecodable(name, fmt::format("{} x {} pixels, more than its {} bytes can hold", spec.width, spec.height, bytes.size()));
    }
    PixelType type() const {
        const int base = spec.channelformats.empty() ? int(spec.format.basetype) : int(OIIO::TypeDesc::FLOAT);
        return base == OIIO::TypeDesc::UINT8    ? PixelType::u8
               : base == OIIO::TypeDesc::UINT16 ? PixelType::u16
               : base == OIIO::TypeDesc::HALF   ? PixelType::f16
                                                : PixelType::f32;
    }
    OIIO::TypeDesc readAs() const {
        constexpr OIIO::TypeDesc::BASETYPE as[] = {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16, OIIO::TypeDesc::FLOAT,
                                                   OIIO::TypeDesc::HALF}; // in the order of PixelType
        return as[size_t(type())];
    }
    size_t numberSize() const { return readAs().size(); }
};

} // namespace

std::string pictureFormat(std::span<const std::byte> bytes) {
    if (isWebp(bytes)) return "WebP";
    const Format* known = formatOf(bytes);
    return known ? known->name : "";
}

namespace {

// The plug-ins throw what they meet in a damaged file.
template <class Read> auto guarded(const std::string& name, Read&& read) {
    try {
        return read();
    } catch (const Error&) { throw; } catch (const std::exception& e) {
        undecodable(name, e.what());
    }
}

PictureSize sizeOf(std::span<const std::byte> bytes, const std::string& name) {
    const Opened from(bytes, name);
    PictureSize size{from.spec.full_width, from.spec.full_height, int(channelsWanted(from.spec).size())};
    size.bytes = uint64_t(size.width) * uint64_t(size.height) * uint64_t(size.channels) * from.numberSize();
    return size;
}

ImageDesc decode(std::span<const std::byte> bytes, const std::string& name) {
    Opened from(bytes, name);
    const OIIO::ImageSpec& spec = from.spec;
    ImageDesc image;
    image.name = name;
    image.width = spec.full_width;
    image.height = spec.full_height;
    image.type = from.type();
    const size_t size = from.numberSize();
    std::vector<std::byte> pixels(size_t(spec.width) * size_t(spec.height) * size_t(spec.nchannels) * size);
    if (!from.input->read_image(0, 0, 0, spec.nchannels, from.readAs(), pixels.data())) undecodable(name, from.input->geterror());
    const std::vector<int> wanted = channelsWanted(spec);
    image.channels = int(wanted.size());
    bool whole = image.channels == spec.nchannels && spec.x == spec.full_x && spec.y == spec.full_y && spec.width == spec.full_width &&
                 spec.height == spec.full_height;
    for (size_t c = 0; c < wanted.size(); ++c) whole = whole && wanted[c] == int(c);
    if (whole)
        image.pixels = std::move(pixels);
    else
        place(spec, wanted, size, pixels, image);
    return image;
}

} // namespace

PictureSize pictureSize(std::span<const std::byte> bytes, const std::string& name) {
    return guarded(name, [&] { return isWebp(bytes) ? webpSize(bytes, name) : sizeOf(bytes, name); });
}
PictureSize pictureSize(const std::filesystem::path& file) { return pictureSize(readBytes(file), file.string()); }

ImageDesc decodeImage(std::span<const std::byte> bytes, const std::string& name) {
    return guarded(name, [&] { return isWebp(bytes) ? decodeWebp(bytes, name) : decode(bytes, name); });
}

ImageDesc readImage(const std::filesystem::path& file) { return decodeImage(readBytes(file), file.string()); }

EnvironmentDesc readEnvironment(const std::filesystem::path& file, Diagnostics& notes) {
    const ImageDesc from = readImage(file);
    EnvironmentDesc out;
    out.image = {from.name, from.width, from.height, 3, PixelType::f32, {}};
    const size_t texels = size_t(from.width) * size_t(from.height), n = size_t(from.channels);
    out.image.pixels.resize(texels * 3 * sizeof(float));
    const auto value = [&](size_t i) {
        if (from.type == PixelType::u8) return srgbToLinear(float(std::to_integer<uint8_t>(from.pixels[i])) / 255);
        if (from.type != PixelType::f32) {
            uint16_t v;
            std::memcpy(&v, &from.pixels[2 * i], 2);
            return from.type == PixelType::f16 ? halfToFloat(v) : srgbToLinear(float(v) / 65535);
        }
        float v;
        std::memcpy(&v, &from.pixels[4 * i], 4);
        return v;
    };
    size_t bad = 0;
    for (size_t i = 0; i < texels; ++i) {
        float rgb[3];
        bool sound = true;
        for (size_t c = 0; c < 3; ++c) {
            rgb[c] = value(i * n + (n >= 3 ? c : 0));
            sound = sound && std::isfinite(rgb[c]) && rgb[c] >= 0;
        }
        for (size_t c = 0; c < 3 && !sound; ++c)
            if (!std::isfinite(rgb[c]) || rgb[c] < 0) rgb[c] = 0;
        bad += !sound;
        std::memcpy(&out.image.pixels[i * sizeof rgb], rgb, sizeof rgb);
    }
    if (bad) notes.warn(fmt::format("{}: {} texels are negative or not finite; those channels became 0.", file.string(), bad));
    return out;
}

} // namespace chiaro
