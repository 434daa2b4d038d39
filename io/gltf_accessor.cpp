#include "io/gltf_file.h"
#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <map>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

size_t componentSize(int component) {
    switch (component) {
    case 5120:
    case 5121: return 1;
    case 5122:
    case 5123: return 2;
    case 5125:
    case 5126: return 4;
    default: return 0;
    }
}

int widthOf(const std::string& type) {
    static const std::map<std::string, int> widths = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                      {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    const auto found = widths.find(type);
    return found == widths.end() ? 0 : found->second;
}

// Columns of a matrix begin at multiples of 4 bytes (glTF 3.6.2.4). Values are read only of matrices of floats, which have no gaps.
size_t elementSize(const Accessor& a) {
    const size_t size = componentSize(a.component);
    const size_t columns = a.type == "MAT2" ? 2 : a.type == "MAT3" ? 3 : a.type == "MAT4" ? 4 : 0;
    return columns ? columns * ((columns * size + 3) / 4 * 4) : size * size_t(a.width);
}

// The bytes of `count` elements, `stride` apart, from `offset` in a view. All numbers are below 2^53 and strides below 2^8: nothing
// overflows.
Bytes slice(const GltfFile& file, const std::string& place, size_t view, uint64_t offset, uint64_t count, uint64_t stride, uint64_t size) {
    const Bytes bytes = bufferView(file, view);
    const uint64_t end = offset + (count - 1) * stride + size;
    if (end > bytes.size())
        file.fail(place, fmt::format("reads {} elements up to byte {}, its bufferView {} has {}. Export the file again.", count, end, view,
                                     bytes.size()));
    return bytes.subspan(offset, end - offset);
}

void checkSparse(const GltfFile& file, const std::string& place, const json& sparse, Accessor& a) {
    a.sparse.count = sparse["count"];
    if (a.sparse.count > a.count)
        file.fail(place + "/sparse/count",
                  fmt::format("is {}, the accessor has {} elements. Export the file again.", a.sparse.count, a.count));
    const json &indices = sparse["indices"], &values = sparse["values"];
    a.sparse.component = indices["componentType"];
    const size_t indexSize = componentSize(a.sparse.component), size = elementSize(a);
    if (!indexSize || a.sparse.component == 5122)
        file.fail(place + "/sparse/indices/componentType", "must be 5121, 5123 or 5125. Export the file again.");
    a.sparse.indices = slice(file, place + "/sparse/indices", indices["bufferView"], indices.value("byteOffset", uint64_t(0)),
                             a.sparse.count, indexSize, indexSize);
    a.sparse.values =
        slice(file, place + "/sparse/values", values["bufferView"], values.value("byteOffset", uint64_t(0)), a.sparse.count, size, size);
}

Accessor checkAccessor(const GltfFile& file, const std::string& place, const json& j) {
    Accessor a;
    a.component = j["componentType"];
    a.type = j["type"];
    a.width = widthOf(a.type);
    a.count = j["count"];
    a.normalized = j.value("normalized", false);
    if (!componentSize(a.component))
        file.fail(place + "/componentType", fmt::format("{} is none of 5120 to 5123, 5125, 5126. Export the file again.", a.component));
    if (!a.width) file.fail(place + "/type", fmt::format("{} is unknown. Export the file again.", shown(a.type)));
    const size_t size = elementSize(a);
    a.stride = size;
    if (j.contains("bufferView")) {
        const size_t view = j["bufferView"];
        a.stride = list(file, "bufferViews")[view].value("byteStride", size);
        if (a.stride < size)
            file.fail(fmt::format("/bufferViews/{}/byteStride", view),
                      fmt::format("is {}, elements of accessor {} have {} bytes. Export the file again.", a.stride, place, size));
        a.data = slice(file, place, view, j.value("byteOffset", uint64_t(0)), a.count, a.stride, size);
    }
    if (j.contains("sparse")) checkSparse(file, place, j["sparse"], a);
    return a;
}

template <class T> T load(const std::byte* at) {
    T v;
    std::memcpy(&v, at, sizeof v);
    return v;
}

// glTF 3.6.2.2: normalized integers are c / max, signed ones not below -1.
float loadFloat(const std::byte* at, int component, bool normalized) {
    switch (component) {
    case 5120: return normalized ? std::max(float(load<int8_t>(at)) / 127.f, -1.f) : float(load<int8_t>(at));
    case 5121: return float(load<uint8_t>(at)) / (normalized ? 255.f : 1.f);
    case 5122: return normalized ? std::max(float(load<int16_t>(at)) / 32767.f, -1.f) : float(load<int16_t>(at));
    case 5123: return float(load<uint16_t>(at)) / (normalized ? 65535.f : 1.f);
    case 5125: return float(double(load<uint32_t>(at)) / (normalized ? 4294967295.0 : 1.0));
    default: return load<float>(at);
    }
}

uint32_t loadIndex(const std::byte* at, int component) {
    return component == 5121 ? load<uint8_t>(at) : component == 5123 ? load<uint16_t>(at) : load<uint32_t>(at);
}

// Overwrites what the sparse part names; `store` takes element index and the bytes of its new value.
template <class Store> void applySparse(const GltfFile& file, size_t accessor, Store store) {
    const Accessor& a = file.accessors[accessor];
    const size_t indexSize = componentSize(a.sparse.component), size = elementSize(a);
    uint32_t last = 0;
    for (size_t i = 0; i < a.sparse.count; ++i) {
        const uint32_t at = loadIndex(a.sparse.indices.data() + i * indexSize, a.sparse.component);
        if (at >= a.count)
            file.fail(fmt::format("/accessors/{}/sparse/indices", accessor),
                      fmt::format("names element {} of {}. Export the file again.", at, a.count));
        if (i > 0 && at <= last)
            file.fail(fmt::format("/accessors/{}/sparse/indices", accessor),
                      fmt::format("names element {} after {}, must rise. Export the file again.", at, last));
        last = at;
        store(at, a.sparse.values.data() + i * size);
    }
}

} // namespace

void checkAccessors(GltfFile& file) {
    const json& accessors = list(file, "accessors");
    for (size_t i = 0; i < accessors.size(); ++i)
        file.accessors.push_back(checkAccessor(file, fmt::format("/accessors/{}", i), accessors[i]));
}

void readFloats(const GltfFile& file, size_t accessor, std::span<float> out) {
    const Accessor& a = file.accessors[accessor];
    const size_t width = size_t(a.width), step = componentSize(a.component);
    const auto store = [&](size_t element, const std::byte* from) {
        for (size_t k = 0; k < width; ++k) out[element * width + k] = loadFloat(from + k * step, a.component, a.normalized);
    };
    if (a.data.empty())
        std::fill(out.begin(), out.end(), 0.f);
    else if (a.component == 5126 && a.stride == width * sizeof(float)) // as they are kept
        std::memcpy(out.data(), a.data.data(), out.size_bytes());
    else
        for (size_t i = 0; i < a.count; ++i) store(i, a.data.data() + i * a.stride);
    applySparse(file, accessor, store);
}

std::vector<float> readFloats(const GltfFile& file, size_t accessor) {
    const Accessor& a = file.accessors[accessor];
    std::vector<float> out(a.count * size_t(a.width));
    readFloats(file, accessor, out);
    return out;
}

std::vector<uint32_t> readIndices(const GltfFile& file, size_t accessor) {
    const Accessor& a = file.accessors[accessor];
    std::vector<uint32_t> out(a.count);
    if (!a.data.empty() && a.component == 5125 && a.stride == sizeof(uint32_t))
        std::memcpy(out.data(), a.data.data(), a.count * sizeof(uint32_t));
    else if (!a.data.empty())
        for (size_t i = 0; i < a.count; ++i) out[i] = loadIndex(a.data.data() + i * a.stride, a.component);
    applySparse(file, accessor, [&](size_t element, const std::byte* from) { out[element] = loadIndex(from, a.component); });
    return out;
}

} // namespace chiaro::gltf
