#include "core/math/half.h"
#include "core/render/in_parallel.h"
#include "io/gltf_file.h"
#include "io/image_read.h"
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

// A picture as the file names it: where its bytes are, or why they are not to be had.
struct Source {
    std::vector<std::byte> held;
    Bytes bytes;
    std::string place, label, name;
    std::string absent; // "tex.png" not found
};

Source sourceOf(const GltfFile& file, size_t number) {
    const json& image = list(file, "images")[number];
    Source s;
    s.place = fmt::format("/images/{}", number);
    s.name = image.value("name", std::string());
    if (image.contains("uri")) {
        const std::string& uri = image["uri"].get_ref<const std::string&>();
        s.place += "/uri";
        if (isDataUri(uri)) {
            auto decoded = decodeDataUri(uri);
            if (!decoded) s.absent = "is a malformed data: URI";
            if (decoded) s.held = std::move(*decoded);
            s.label = "(data)";
        } else {
            const auto path = resolveUri(file, s.place, uri);
            s.label = shown(uri);
            if (path.empty()) s.absent = s.label + " not found";
            if (!path.empty()) s.held = readBytes(path);
            if (s.name.empty()) s.name = uri;
        }
        s.bytes = s.held;
    } else if (image.contains("bufferView")) {
        s.place += "/bufferView";
        s.label = s.name.empty() ? "(embedded)" : shown(s.name);
        s.bytes = bufferView(file, image["bufferView"]);
    } else {
        s.absent = "has neither \"uri\" nor \"bufferView\"";
    }
    return s;
}

// "label: cannot be decoded (why). advice" -> "label cannot be decoded (why)"
std::string reason(const Source& source, const Error& e) {
    const std::string why = std::string(e.what()).substr(printable(source.label).size() + 2);
    return fmt::format("{} {}", source.label, why.substr(0, why.rfind("). ") + 1));
}

struct Decoded {
    std::string absent; // why grey stands in
    std::string place;
    size_t mended = 0;
    GltfInventory::Picture picture = {};
};

// A texel that is no number would make every sample that looks at it none. How many there were.
size_t mendNumbers(ImageDesc& image) {
    const auto mend = [&](auto number, const auto& finite) {
        size_t bad = 0;
        for (size_t at = 0; at < image.pixels.size(); at += sizeof number) {
            std::memcpy(&number, &image.pixels[at], sizeof number);
            if (finite(number)) continue;
            std::memset(&image.pixels[at], 0, sizeof number);
            ++bad;
        }
        return bad;
    };
    if (image.type == PixelType::f32) return mend(0.f, [](float v) { return std::isfinite(v); });
    if (image.type == PixelType::f16) return mend(uint16_t(0), [](uint16_t code) { return std::isfinite(halfToFloat(code)); });
    return 0;
}

Decoded decodeInto(ImageDesc& image, const Conversion& to, size_t number) {
    const Source source = sourceOf(to.file, number);
    std::string absent = source.absent;
    if (absent.empty()) {
        try {
            image = decodeImage(source.bytes, source.label);
            image.name = source.name;
            return {{}, source.place, mendNumbers(image), {pictureFormat(source.bytes), source.bytes.size()}};
        } catch (const Error& e) { absent = reason(source, e); }
    }
    if (to.options.missingTexture == MissingTexture::error)
        to.file.fail(source.place, absent + ". Fix the path or pass --missing-texture grey");
    image = {"missing", 1, 1, 3, PixelType::u8, std::vector<std::byte>(3, std::byte(128))};
    return {absent, source.place};
}

// Bytes once decoded, by what the picture's own header says; 0 where it says nothing: decoding will tell why.
uint64_t sizeOf(const Conversion& to, size_t number) {
    const Source source = sourceOf(to.file, number);
    if (!source.absent.empty()) return 0;
    try {
        return pictureSize(source.bytes, source.label).bytes;
    } catch (const Error&) { return 0; }
}

} // namespace

int convertImage(Conversion& to, int image) {
    int& converted = to.images[size_t(image)];
    if (converted >= 0) return converted;
    to.imagesUsed.push_back(size_t(image));
    return converted = int(to.imagesUsed.size()) - 1;
}

void measureImages(Conversion& to) {
    std::vector<uint64_t> bytes(to.imagesUsed.size());
    inParallel(to.options.run, bytes.size(), [&](uint64_t i) { bytes[i] = sizeOf(to, to.imagesUsed[i]); });
    for (size_t i = 0; i < bytes.size(); ++i) {
        to.sizes.textureBytes += bytes[i];
        if (to.sizes.textureBytes > maxImageBytes)
            to.file.fail(fmt::format("/images/{}", to.imagesUsed[i]),
                         fmt::format("brings the textures above {} bytes. Make them smaller.", maxImageBytes));
    }
}

void decodeImages(Conversion& to) {
    std::vector<Decoded> results(to.imagesUsed.size());
    to.scene.images.resize(results.size());
    inParallel(to.options.run, results.size(), [&](uint64_t i) { results[i] = decodeInto(to.scene.images[i], to, to.imagesUsed[i]); });
    for (const Decoded& d : results) {
        to.pictures.push_back(d.picture);
        if (!d.absent.empty()) to.file.warn(fmt::format("{} {}; grey stands in.", d.place, d.absent));
        if (d.mended) to.file.warn(fmt::format("{} holds {} numbers that are not finite; they became 0.", d.place, d.mended));
    }
    const auto drop = [&](TextureSlot& s) {
        if (s.texture >= 0 && !results[size_t(to.scene.textures[size_t(s.texture)].image)].absent.empty()) s = {};
    };
    for (MaterialDesc& m : to.scene.materials) // a grey stand-in is a colour, but no direction
        for (TextureSlot* s : {&m.normalTexture, &m.clearcoatNormalTexture, &m.anisotropyTexture}) drop(*s);
}

} // namespace chiaro::gltf
