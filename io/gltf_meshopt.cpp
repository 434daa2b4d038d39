#include "core/render/in_parallel.h"
#include "io/gltf_compressed.h"
#include <algorithm>
#include <fmt/format.h>
#include <meshoptimizer.h>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

constexpr const char* names[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

struct Packed {
    size_t view = 0;
    std::string extension, place, mode, filter;
    Bytes data;
    size_t count = 0, stride = 0;
    std::vector<std::byte> plain;
};

// The high four bits of the first byte name a codec, the low ones its version.
struct Codec {
    const char* mode;
    int mark, newest;
    int (*decode)(void* to, size_t count, size_t stride, const unsigned char* from, size_t bytes);
};
constexpr Codec codecs[] = {{"ATTRIBUTES", 0xa0, 0, meshopt_decodeVertexBuffer},
                            {"TRIANGLES", 0xe0, 1, meshopt_decodeIndexBuffer},
                            {"INDICES", 0xd0, 1, meshopt_decodeIndexSequence}};
const Codec* codecOf(const Packed& p) {
    for (const Codec& c : codecs)
        if (p.mode == c.mode) return &c;
    return nullptr;
}

[[noreturn]] void unreadable(const GltfFile& file, const Packed& p, const std::string& what) {
    throw Error(Exit::unsupported,
                printable(fmt::format("{}: {} {}. Try: gltf-transform copy {} out.glb", file.name, p.place, what, file.name)));
}

// What the decoders take for granted (their library asserts it), and that the packed bytes can hold so much: a byte of a vertex buffer
// stands for at most 64, those of the other codecs for fewer.
void check(const GltfFile& file, const Packed& p) {
    const Codec* codec = codecOf(p);
    if (!codec) file.fail(p.place + "/mode", fmt::format("{} is none of ATTRIBUTES, TRIANGLES, INDICES. Export it again.", shown(p.mode)));
    const bool attributes = p.mode == "ATTRIBUTES";
    if (attributes ? p.stride % 4 != 0 : p.stride != 2 && p.stride != 4)
        file.fail(p.place + "/byteStride",
                  fmt::format("is {}, must be {}. Export it again.", p.stride, attributes ? "a multiple of 4" : "2 or 4"));
    if (p.mode == "TRIANGLES" && p.count % 3 != 0)
        file.fail(p.place + "/count", fmt::format("is {}, must be a multiple of 3. Export it again.", p.count));
    if (p.filter == "COLOR") unreadable(file, p, "is packed with the filter COLOR, which this build cannot read");
    const bool fits = p.filter == "NONE" || (attributes && ((p.filter == "OCTAHEDRAL" && (p.stride == 4 || p.stride == 8)) ||
                                                            (p.filter == "QUATERNION" && p.stride == 8) || p.filter == "EXPONENTIAL"));
    if (!fits)
        file.fail(p.place + "/filter",
                  fmt::format("{} does not go with mode {} and byteStride {}. Export it again.", shown(p.filter), shown(p.mode), p.stride));
    if (p.count > (p.data.size() * 64 + 256) / p.stride)
        file.fail(p.place, fmt::format("says {} x {} bytes, more than its {} packed bytes can hold. Export it again.", p.count, p.stride,
                                       p.data.size()));
    const int mark = std::to_integer<int>(p.data[0]);
    if ((mark & 0xf0) == codec->mark && (mark & 0x0f) > codec->newest)
        unreadable(file, p,
                   fmt::format("is packed by version {} of meshoptimizer's codec, this build reads {}", mark & 0x0f, codec->newest));
}

void unpack(const GltfFile& file, Packed& p) {
    p.plain.resize(p.count * p.stride);
    const auto* data = reinterpret_cast<const unsigned char*>(p.data.data());
    if (codecOf(p)->decode(p.plain.data(), p.count, p.stride, data, p.data.size()) != 0)
        file.fail(p.place, "cannot be unpacked: its bytes are damaged. Download or export the file again.");
    if (p.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(p.plain.data(), p.count, p.stride);
    if (p.filter == "QUATERNION") meshopt_decodeFilterQuat(p.plain.data(), p.count, p.stride);
    if (p.filter == "EXPONENTIAL") meshopt_decodeFilterExp(p.plain.data(), p.count, p.stride);
}

std::vector<Packed> packedViews(const GltfFile& file) {
    std::vector<Packed> all;
    const json& views = list(file, "bufferViews");
    for (size_t i = 0; i < views.size(); ++i)
        for (const char* name : names) {
            if (!views[i].contains("extensions") || !views[i]["extensions"].contains(name)) continue;
            const json& from = views[i]["extensions"][name];
            Packed p;
            p.view = i;
            p.extension = name;
            p.place = fmt::format("/bufferViews/{}/extensions/{}", i, name);
            const uint64_t offset = from.value("byteOffset", uint64_t(0)), length = from["byteLength"];
            const Bytes buffer = file.buffers[from["buffer"].get<size_t>()];
            if (offset + length > buffer.size()) // both below 2^53
                file.fail(p.place,
                          fmt::format("ends at byte {}, its buffer has {}. Export the file again.", offset + length, buffer.size()));
            p.data = buffer.subspan(offset, length);
            p.count = from["count"];
            p.stride = from["byteStride"];
            p.mode = from["mode"];
            p.filter = from.value("filter", "NONE");
            check(file, p);
            all.push_back(std::move(p));
            break;
        }
    return all;
}

} // namespace

bool standsForPacked(const json& buffer) {
    for (const char* name : names)
        if (!buffer.contains("uri") && buffer.contains("extensions") && buffer["extensions"].contains(name)) return true;
    return false;
}

size_t addBuffer(GltfFile& file, std::vector<std::byte> bytes) {
    json& buffers = file.json["buffers"];
    if (!buffers.is_array()) buffers = json::array();
    buffers.push_back({{"byteLength", bytes.size()}});
    file.loaded.push_back(std::move(bytes));
    file.buffers.push_back(file.loaded.back());
    return file.buffers.size() - 1;
}

void forgetExtension(GltfFile& file, const char* name) {
    for (const char* key : {"extensionsUsed", "extensionsRequired"})
        if (file.json.contains(key)) {
            json& all = file.json[key];
            all.erase(std::remove(all.begin(), all.end(), name), all.end());
            if (all.empty()) file.json.erase(key);
        }
}

void unpackMeshopt(GltfFile& file) {
    std::vector<Packed> all = packedViews(file);
    if (all.empty()) return;
    uint64_t bytes = 0;
    for (const Packed& p : all) bytes += p.count * p.stride;
    file.admit(bytes);
    inParallel(file.run, all.size(), [&](uint64_t i) { unpack(file, all[i]); });
    for (Packed& p : all) {
        const size_t size = p.plain.size(), buffer = addBuffer(file, std::move(p.plain));
        json& view = file.json["bufferViews"][p.view];
        view["buffer"] = buffer;
        view["byteOffset"] = 0;
        view["byteLength"] = size;
        view["extensions"].erase(p.extension);
    }
    for (const char* name : names) {
        for (json& buffer : file.json["buffers"])
            if (buffer.contains("extensions")) buffer["extensions"].erase(name);
        forgetExtension(file, name);
    }
}

} // namespace chiaro::gltf
