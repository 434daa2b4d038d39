#include "io/gltf_file.h"
#include <cstring>
#include <fmt/format.h>

namespace chiaro::gltf {

void GltfFile::fail(const std::string& place, const std::string& what) const {
    throw Error(Exit::file, printable(place.empty() ? fmt::format("{}: {}", name, what) : fmt::format("{}: {} {}", name, place, what)));
}
void GltfFile::admit(uint64_t more) const {
    if (!admission) return;
    uint64_t bytes = content.size() + more;
    for (const auto& l : loaded) bytes += l.size();
    admission({.fileBytes = bytes});
}
void GltfFile::warn(const std::string& what) const { notes->warn(printable(fmt::format("{}: {}", name, what))); }

namespace {

uint32_t u32(Bytes bytes, size_t at) { // glTF is little-endian, as is every machine that Embree runs on
    uint32_t v;
    std::memcpy(&v, bytes.data() + at, 4);
    return v;
}

std::string_view text(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

// Nesting is measured before any parser sees the text: parsers recurse. Brackets inside strings do not count.
void checkJsonDepth(const GltfFile& file, std::string_view json) {
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (quoted) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                quoted = false;
        } else if (c == '"') {
            quoted = true;
        } else if (c == '[' || c == '{') {
            if (++depth > maxJsonDepth)
                file.fail("", fmt::format("JSON nested more than {} deep at byte {}. This is no scene; export it again.", maxJsonDepth, i));
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
}

void parseJson(GltfFile& file, std::string_view json) {
    if (json.size() > maxJsonBytes)
        file.fail("", fmt::format("has {} bytes of JSON, limit {}. Export it as .glb, or split it.", json.size(), maxJsonBytes));
    checkJsonDepth(file, json);
    try {
        file.json = nlohmann::json::parse(json);
    } catch (const nlohmann::json::exception& e) {
        const std::string_view why = e.what();
        const size_t from = why.find("] ");
        const std::string message = shown(from == why.npos ? why : why.substr(from + 2), 160);
        file.fail("", fmt::format("is not valid JSON: {}. Export it again.", message.substr(1, message.size() - 2)));
    }
    if (!file.json.is_object()) file.fail("", "is JSON, but not a glTF object. Give a .gltf or .glb file.");
}

void splitGlb(GltfFile& file) {
    const Bytes bytes = file.content;
    if (bytes.size() < 12)
        file.fail("", fmt::format("is a .glb of {} bytes, too short for its header. Download or export it again.", bytes.size()));
    const uint32_t version = u32(bytes, 4), length = u32(bytes, 8);
    if (version != 2)
        throw Error(Exit::unsupported,
                    fmt::format("{}: is glTF binary version {}, this build reads 2. Convert it: npx gltf-pipeline -i {} -o out.glb",
                                file.name, version, file.name));
    size_t at = 12;
    std::string_view json;
    for (int chunk = 0; at < std::min<size_t>(length, bytes.size()); ++chunk) {
        if (bytes.size() - at < 8)
            file.fail("", fmt::format("chunk {} begins at byte {}, file ends after {}. The file is truncated; download or export it again.",
                                      chunk, at, bytes.size()));
        const uint32_t size = u32(bytes, at), kind = u32(bytes, at + 4);
        if (size > bytes.size() - at - 8)
            file.fail("", fmt::format("chunk {} says {} bytes, file ends after {}. The file is truncated; download or export it again.",
                                      chunk, size, bytes.size()));
        const Bytes body = bytes.subspan(at + 8, size);
        constexpr uint32_t kindJson = 0x4E4F534A, kindBin = 0x004E4942;
        if (chunk == 0 && kind != kindJson) file.fail("", fmt::format("chunk 0 has type {:#010x}, not JSON. Export it again.", kind));
        if (chunk == 0) json = text(body);
        if (kind == kindBin && !file.hasBinary) {
            file.binary = body;
            file.hasBinary = true;
        }
        at += 8 + size_t(size);
    }
    if (length > bytes.size())
        file.fail("", fmt::format("header says {} bytes, file ends after {}. The file is truncated; download or export it again.", length,
                                  bytes.size()));
    if (json.empty()) file.fail("", "has no JSON chunk. Export it again.");
    parseJson(file, json);
}

} // namespace

void openContainer(GltfFile& file) {
    file.content = readBytes(file.path);
    if (file.content.empty()) file.fail("", "is empty. Download or export it again.");
    if (text(file.content).starts_with("glTF"))
        splitGlb(file);
    else
        parseJson(file, text(file.content));
}

} // namespace chiaro::gltf
