#include "io/gltf_file.h"
#include "io/image_read.h"
#include <fmt/format.h>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

// One mid-grey texel in the place of a picture that is not to be had, or the error that says so.
ImageDesc standIn(Conversion& to, const std::string& place, const std::string& what) {
    if (to.options.missingTexture == MissingTexture::error) to.file.fail(place, what + ". Fix the path or pass --missing-texture grey");
    to.file.warn(fmt::format("{} {}; grey stands in.", place, what));
    return {"missing", 1, 1, 3, PixelType::u8, std::vector<std::byte>(3, std::byte(128))};
}

ImageDesc load(Conversion& to, const std::string& place, const json& image, bool& missing) {
    const GltfFile& file = to.file;
    std::vector<std::byte> held;
    Bytes bytes;
    std::string at = place, name = image.value("name", std::string()), label;
    missing = true;
    if (image.contains("uri")) {
        const std::string& uri = image["uri"].get_ref<const std::string&>();
        at += "/uri";
        if (isDataUri(uri)) {
            auto decoded = decodeDataUri(uri);
            if (!decoded) return standIn(to, at, "is a malformed data: URI");
            held = std::move(*decoded);
            label = "(data)";
        } else {
            const auto path = resolveUri(file, at, uri);
            label = shown(uri);
            if (path.empty()) return standIn(to, at, label + " not found");
            held = readBytes(path);
            if (name.empty()) name = uri;
        }
        bytes = held;
    } else if (image.contains("bufferView")) {
        at += "/bufferView";
        label = name.empty() ? "(embedded)" : shown(name);
        bytes = bufferView(file, image["bufferView"]);
    } else {
        return standIn(to, at, "has neither \"uri\" nor \"bufferView\"");
    }
    try {
        ImageDesc decoded = decodeImage(bytes, label);
        decoded.name = name;
        missing = false;
        return decoded;
    } catch (const Error& e) { // "label: cannot be decoded (why). advice"
        std::string why = std::string(e.what()).substr(printable(label).size() + 2);
        return standIn(to, at, fmt::format("{} {}", label, why.substr(0, why.rfind("). ") + 1)));
    }
}

} // namespace

int convertImage(Conversion& to, int image) {
    int& converted = to.images[size_t(image)];
    if (converted >= 0) return converted;
    bool missing = false;
    ImageDesc desc = load(to, fmt::format("/images/{}", image), list(to.file, "images")[size_t(image)], missing);
    to.imageBytes += desc.pixels.size();
    if (to.imageBytes > maxImageBytes)
        to.file.fail(fmt::format("/images/{}", image),
                     fmt::format("brings the textures above {} bytes. Make them smaller.", maxImageBytes));
    to.scene.images.push_back(std::move(desc));
    converted = int(to.scene.images.size()) - 1;
    if (missing) to.missing.push_back(converted);
    return converted;
}

} // namespace chiaro::gltf
