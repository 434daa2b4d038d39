#include "io/gltf_factors.h"
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::gltf {

using nlohmann::json;

const json& member(const json& object, const char* key) {
    static const json none = json::object();
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
}

namespace {

Wrap wrapMode(int mode) { return mode == 33071 ? Wrap::clamp : mode == 33648 ? Wrap::mirror : Wrap::repeat; }

int convertTexture(Conversion& to, size_t texture) {
    int& converted = to.textures[texture];
    if (converted >= 0) return converted;
    const json& from = list(to.file, "textures")[texture];
    const json& webp = member(member(from, "extensions"), "EXT_texture_webp");
    TextureDesc desc;
    if (webp.contains("source"))
        desc.image = convertImage(to, webp["source"]);
    else if (from.contains("source"))
        desc.image = convertImage(to, from["source"]);
    else if (const json& basis = member(member(from, "extensions"), "KHR_texture_basisu"); basis.contains("source"))
        desc.image = convertImage(to, basis["source"]); // its bytes say how it can be made readable
    else {
        to.file.warn(fmt::format("/textures/{} names no picture that this build can read; the materials do without it.", texture));
        return -1;
    }
    if (from.contains("sampler")) {
        const json& sampler = list(to.file, "samplers")[from["sampler"].get<size_t>()];
        desc.wrapS = wrapMode(sampler.value("wrapS", 10497));
        desc.wrapT = wrapMode(sampler.value("wrapT", 10497));
        if (sampler.value("magFilter", 9729) == 9728) desc.filter = TextureFilter::nearest;
    }
    to.scene.textures.push_back(desc);
    return converted = int(to.scene.textures.size()) - 1;
}

} // namespace

// KHR_texture_transform: scale, then rotation counter-clockwise as seen in the picture (v points down), then offset.
TextureSlot slot(Conversion& to, const json& holder, const char* key) {
    TextureSlot s;
    if (!holder.contains(key)) return s;
    const json& info = holder[key];
    s.texture = convertTexture(to, info["index"]);
    s.uvSet = info.value("texCoord", 0);
    const json& t = member(member(info, "extensions"), "KHR_texture_transform");
    s.uvSet = t.value("texCoord", s.uvSet);
    if (s.uvSet >= uvSets) {
        to.file.warn(fmt::format("uses TEXCOORD_{}; only sets 0 to {} are read, set 0 stands in.", s.uvSet, uvSets - 1));
        s.uvSet = 0;
    }
    const auto offset = t.value("offset", std::array<double, 2>{0, 0}), scale = t.value("scale", std::array<double, 2>{1, 1});
    const double angle = t.value("rotation", 0.0), c = std::cos(angle), sn = std::sin(angle);
    const double m[2][3] = {{c * scale[0], sn * scale[1], offset[0]}, {-sn * scale[0], c * scale[1], offset[1]}};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 3; ++j) s.transform[i][j] = float(m[i][j]);
    return s;
}

} // namespace chiaro::gltf
