#include "io/gltf_compressed.h"
#include <fmt/format.h>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

Bytes loadBuffer(GltfFile& file, const json& buffer, size_t index) {
    const std::string place = fmt::format("/buffers/{}", index);
    if (!buffer.contains("uri")) {
        if (index == 0 && file.hasBinary) return file.binary;
        if (standsForPacked(buffer)) return {};
        file.fail(place, "has no \"uri\", and the file no binary chunk. Export it again.");
    }
    const std::string& uri = buffer["uri"].get_ref<const std::string&>();
    if (isDataUri(uri)) {
        auto bytes = decodeDataUri(uri);
        if (!bytes) file.fail(place + "/uri", "is a malformed data: URI. Export the file again.");
        file.loaded[index] = std::move(*bytes);
    } else {
        const auto path = resolveUri(file, place + "/uri", uri);
        if (path.empty()) file.fail(place + "/uri", fmt::format("{} not found. Put it beside the scene, or export as .glb.", shown(uri)));
        file.loaded[index] = readBytes(path);
    }
    return file.loaded[index];
}

} // namespace

const json& list(const GltfFile& file, const char* name) {
    static const json none = json::array();
    const auto found = file.json.find(name);
    return found == file.json.end() ? none : *found;
}

void loadBuffers(GltfFile& file) {
    const json& buffers = list(file, "buffers");
    file.loaded.resize(buffers.size());
    for (size_t i = 0; i < buffers.size(); ++i) {
        const Bytes bytes = loadBuffer(file, buffers[i], i);
        if (bytes.empty() && standsForPacked(buffers[i])) {
            file.buffers.emplace_back();
            continue;
        }
        const uint64_t length = buffers[i]["byteLength"];
        if (length > bytes.size())
            file.fail(
                fmt::format("/buffers/{}/byteLength", i),
                fmt::format("says {} bytes, its data has {}. The data is truncated; download or export it again.", length, bytes.size()));
        file.buffers.push_back(bytes.first(length));
    }
    unpackMeshopt(file);
    const json& views = list(file, "bufferViews");
    for (size_t i = 0; i < views.size(); ++i) {
        const uint64_t offset = views[i].value("byteOffset", uint64_t(0)), length = views[i]["byteLength"];
        const size_t buffer = views[i]["buffer"];
        if (offset + length > file.buffers[buffer].size()) // both below 2^53
            file.fail(fmt::format("/bufferViews/{}", i), fmt::format("ends at byte {}, its buffer {} has {}. Export the file again.",
                                                                     offset + length, buffer, file.buffers[buffer].size()));
    }
    unpackDraco(file);
}

Bytes bufferView(const GltfFile& file, size_t view) {
    const json& v = file.json["bufferViews"][view];
    return file.buffers[v["buffer"].get<size_t>()].subspan(v.value("byteOffset", size_t(0)), v["byteLength"].get<size_t>());
}

} // namespace chiaro::gltf
