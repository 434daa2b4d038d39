// Writes small glTF files from code: every input of the reader's tests is made here, none is data from elsewhere.
#pragma once
#include "io/gltf.h"
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <unistd.h>
#include <vector>

namespace chiaro::test {

using nlohmann::json;
namespace fs = std::filesystem;

// A fresh folder that goes when the test ends.
class Folder {
public:
    explicit Folder(const std::string& name) : path(fs::temp_directory_path() / ("chiaro-" + name + "-" + std::to_string(getpid()))) {
        fs::remove_all(path);
        fs::create_directories(path);
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    fs::path write(const std::string& name, const std::string& content) const {
        fs::create_directories((path / name).parent_path());
        std::ofstream(path / name, std::ios::binary) << content;
        return path / name;
    }
    const fs::path path;
};

inline std::string base64(const std::string& bytes) {
    const char* const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t v = 0;
        for (size_t k = 0; k < 3; ++k) v = v << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? letters[v >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

inline std::string u32(uint32_t v) { return {reinterpret_cast<const char*>(&v), 4}; }

// glTF's componentType of a C++ type.
template <class T> constexpr int componentOf() {
    if constexpr (std::is_same_v<T, int8_t>)
        return 5120;
    else if constexpr (std::is_same_v<T, uint8_t>)
        return 5121;
    else if constexpr (std::is_same_v<T, int16_t>)
        return 5122;
    else if constexpr (std::is_same_v<T, uint16_t>)
        return 5123;
    else if constexpr (std::is_same_v<T, uint32_t>)
        return 5125;
    else
        return 5126;
}

struct Builder {
    json root = {{"asset", {{"version", "2.0"}}}};
    std::string bytes; // buffer 0

    int add(const char* array, json entry) {
        root[array].push_back(std::move(entry));
        return int(root[array].size()) - 1;
    }
    int view(const std::string& data, size_t stride = 0) {
        bytes.resize((bytes.size() + 3) / 4 * 4);
        json entry = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size()}};
        if (stride) entry["byteStride"] = stride;
        bytes += data;
        return add("bufferViews", entry);
    }
    // Elements of `width` numbers; a stride spreads them, with garbage between.
    template <class T>
    int accessor(const std::vector<T>& values, size_t width, const char* type, bool normalized = false, size_t stride = 0,
                 size_t offset = 0) {
        const size_t count = values.size() / width, size = width * sizeof(T), step = stride ? stride : size;
        std::string data(offset + (count ? (count - 1) * step + size : 0), '\x7f');
        for (size_t i = 0; i < count; ++i) std::memcpy(&data[offset + i * step], &values[i * width], size);
        json entry = {{"bufferView", view(data, stride)}, {"componentType", componentOf<T>()}, {"count", count}, {"type", type}};
        if (offset) entry["byteOffset"] = offset;
        if (normalized) entry["normalized"] = true;
        return add("accessors", entry);
    }
    // A mesh of one primitive; attributes and what else the primitive holds.
    int mesh(json attributes, json more = json::object()) {
        more["attributes"] = std::move(attributes);
        return add("meshes", {{"primitives", {more}}});
    }
    int node(json entry) { // a root of scene 0
        const int index = add("nodes", std::move(entry));
        if (!root.contains("scenes")) root["scenes"] = {{{"nodes", json::array()}}};
        root["scenes"][0]["nodes"].push_back(index);
        return index;
    }
    // One triangle (0,0,0) (1,0,0) (0,1,0), drawn once.
    static Builder triangle(json more = json::object()) {
        Builder b;
        b.node({{"mesh", b.mesh({{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, "VEC3")}}, std::move(more))}});
        return b;
    }
    json finished() const {
        json j = root;
        if (!bytes.empty() && !j.contains("buffers")) j["buffers"] = {{{"byteLength", bytes.size()}}};
        return j;
    }
    static std::string glb(std::string text, std::string binary) {
        text.resize((text.size() + 3) / 4 * 4, ' ');
        binary.resize((binary.size() + 3) / 4 * 4, '\0');
        std::string out = u32(uint32_t(text.size())) + "JSON" + text;
        if (!binary.empty()) out += u32(uint32_t(binary.size())) + std::string("BIN\0", 4) + binary;
        return "glTF" + u32(2) + u32(uint32_t(out.size() + 12)) + out;
    }
    std::string asGlb() const { return glb(finished().dump(), bytes); }
    std::string asData() const { // .gltf with its buffer in a data: URI
        json j = finished();
        if (!bytes.empty()) j["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(bytes);
        return j.dump();
    }
    SceneDesc read(const Folder& folder, Diagnostics& notes, const GltfOptions& options = {}) const {
        return readGltf(folder.write("scene.glb", asGlb()), options, notes);
    }
    SceneDesc read(const Folder& folder) const {
        Diagnostics notes;
        return read(folder, notes);
    }
};

// The message and exit code with which reading fails; "" and Exit::done when it does not.
struct Failure {
    Exit code = Exit::done;
    std::string message;
};
inline Failure failure(const fs::path& file, const GltfOptions& options = {}) {
    Diagnostics notes;
    try {
        readGltf(file, options, notes);
    } catch (const Error& e) { return {e.code, e.what()}; }
    return {};
}
inline bool warns(const Diagnostics& notes, const std::string& part) {
    for (const std::string& w : notes.warnings())
        if (w.find(part) != w.npos) return true;
    return false;
}

} // namespace chiaro::test
