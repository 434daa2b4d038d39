#include "io/gltf_write.h"
#include "io/glb_write.h"
#include "io/gltf_write_content.h"
#include "io/replace_file.h"
#include <fmt/format.h>

namespace chiaro {

using nlohmann::json;
using namespace gltf;

std::size_t GltfDocument::Content::append(const char* list, nlohmann::json value) {
    nlohmann::json& all = json[list];
    if (!all.is_array()) all = nlohmann::json::array();
    all.push_back(std::move(value));
    return all.size() - 1;
}

std::size_t GltfDocument::Content::addView(const void* bytes, std::size_t size, int target, std::size_t stride) {
    binary.resize((binary.size() + 3) / 4 * 4);
    nlohmann::json view{{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}};
    if (target != 0) view["target"] = target;
    if (stride != 0) view["byteStride"] = stride;
    const auto* from = static_cast<const std::byte*>(bytes);
    binary.insert(binary.end(), from, from + size);
    return append("bufferViews", std::move(view));
}

std::size_t GltfDocument::Content::addAccessor(const void* values, std::size_t count, int component, const char* type, std::size_t bytes,
                                               int target) {
    // Vertex attributes begin at multiples of four bytes (glTF 3.6.2.4).
    const std::size_t stride = (bytes + 3) / 4 * 4;
    std::size_t view = 0;
    if (target == arrayBuffer && stride != bytes) {
        std::vector<std::byte> padded(stride * count);
        for (std::size_t i = 0; i < count; ++i) std::copy_n(static_cast<const std::byte*>(values) + i * bytes, bytes, &padded[i * stride]);
        view = addView(padded.data(), padded.size(), target, stride);
    } else {
        view = addView(values, bytes * count, target);
    }
    return append("accessors", {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
}

std::size_t GltfDocument::Content::addImage(const std::string& name, std::span<const std::byte> bytes, const std::string& mime) {
    nlohmann::json image{{"bufferView", addView(bytes.data(), bytes.size())}, {"mimeType", mime}};
    if (!name.empty()) image["name"] = name;
    return append("images", std::move(image));
}

void GltfDocument::Content::use(const std::string& extension) {
    nlohmann::json& used = json["extensionsUsed"];
    if (!used.is_array()) used = nlohmann::json::array();
    if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
}

std::string gltf::mimeOf(std::span<const std::byte> b) {
    const std::string_view text(reinterpret_cast<const char*>(b.data()), std::min<std::size_t>(b.size(), 16));
    if (text.starts_with("\x89PNG")) return "image/png";
    if (text.starts_with("\xff\xd8\xff")) return "image/jpeg";
    if (text.starts_with("RIFF") && text.size() >= 12 && text.substr(8, 4) == "WEBP") return "image/webp";
    if (text.starts_with("\xabKTX 20")) return "image/ktx2";
    return {};
}

namespace {

// All buffers as one, each at a multiple of eight bytes.
void joinBuffers(json& document, std::vector<std::byte>& binary, const GltfFile& file) {
    std::vector<std::size_t> offsets;
    for (const Bytes& buffer : file.buffers) {
        binary.resize((binary.size() + 7) / 8 * 8);
        offsets.push_back(binary.size());
        binary.insert(binary.end(), buffer.begin(), buffer.end());
    }
    if (document.contains("bufferViews"))
        for (json& view : document["bufferViews"]) {
            view["byteOffset"] = view.value("byteOffset", std::size_t(0)) + offsets[view["buffer"].get<std::size_t>()];
            view["buffer"] = 0;
        }
    document.erase("buffers");
}

} // namespace

GltfDocument::GltfDocument(std::unique_ptr<Content> content) : content_(std::move(content)) {}
GltfDocument::GltfDocument(GltfDocument&&) noexcept = default;
GltfDocument::~GltfDocument() = default;

GltfDocument GltfDocument::read(const std::filesystem::path& path, GltfOrigin origin, Diagnostics& notes) {
    auto content = std::make_unique<Content>();
    Content& c = *content;
    GltfFile& file = c.file;
    file.path = path;
    file.name = path.string();
    file.notes = &notes;
    openContainer(file);
    checkSchema(file);
    loadBuffers(file);
    checkAccessors(file);
    c.json = file.json;
    c.origin = std::move(origin);
    joinBuffers(c.json, c.binary, file);
    if (!c.json.contains("images")) return GltfDocument(std::move(content));
    for (json& image : c.json["images"]) {
        if (!image.contains("uri")) continue;
        const std::string uri = image["uri"];
        std::vector<std::byte> bytes;
        if (isDataUri(uri)) {
            if (auto decoded = decodeDataUri(uri)) bytes = std::move(*decoded);
        } else if (const auto found = resolveUri(file, "/images", uri); !found.empty()) {
            bytes = readBytes(found);
            if (!image.contains("name")) image["name"] = uri;
        }
        const std::string mime = mimeOf(bytes);
        if (mime.empty()) continue; // as the file names it: readers say themselves that it is not there
        image["bufferView"] = c.addView(bytes.data(), bytes.size());
        image["mimeType"] = mime;
        image.erase("uri");
    }
    return GltfDocument(std::move(content));
}

std::string GltfDocument::obstacle(uint32_t instance, uint32_t primitive) const {
    const Content& c = *content_;
    const json& node = c.json["nodes"][c.origin.instances[instance].node];
    if (node.contains("skin")) return "skins";
    const json& mesh = c.json["meshes"][node["mesh"].get<std::size_t>()];
    const auto& parts = c.origin.meshes[std::size_t(c.origin.instances[instance].mesh)];
    return mesh["primitives"][parts[primitive].number].contains("targets") ? "morph targets" : "";
}

bool GltfDocument::animated(uint32_t instance) const {
    const json& j = content_->json;
    if (!j.contains("animations")) return false;
    std::set<std::size_t> moved;
    for (const json& animation : j["animations"])
        for (const json& channel : animation.value("channels", json::array()))
            if (const json target = channel.value("target", json::object()); target.contains("node"))
                moved.insert(target["node"].get<std::size_t>());
    std::vector<std::size_t> parent(j["nodes"].size(), j["nodes"].size());
    for (std::size_t i = 0; i < parent.size(); ++i)
        for (const json& child : j["nodes"][i].value("children", json::array())) parent[child.get<std::size_t>()] = i;
    for (std::size_t n = content_->origin.instances[instance].node; n < parent.size(); n = parent[n])
        if (moved.contains(n)) return true;
    return false;
}

std::size_t GltfDocument::materials() const { return content_->json.contains("materials") ? content_->json["materials"].size() : 0; }

void GltfDocument::write(const std::filesystem::path& path) const {
    json document = content_->json;
    if (!content_->binary.empty()) document["buffers"] = json::array({{{"byteLength", content_->binary.size()}}});
    const bool text = path.extension() == ".gltf";
    const auto dumped = [&](int indent) { return document.dump(indent, ' ', false, json::error_handler_t::replace); };
    if (!text) return replaceFile(path, glbContainer(dumped(-1), content_->binary));
    if (!content_->binary.empty()) {
        const std::filesystem::path bin = std::filesystem::path(path).replace_extension(".bin");
        if (content_->binary.size() > 0xffffffffu)
            throw Error(Exit::resources, fmt::format("{}: more than 4 GB in one buffer", bin.string()));
        std::string uri;
        for (const unsigned char ch : bin.filename().string()) // RFC 3986: what is not plain is escaped
            uri += std::isalnum(ch) || ch == '-' || ch == '.' || ch == '_' || ch == '~' ? std::string(1, char(ch))
                                                                                        : fmt::format("%{:02X}", ch);
        document["buffers"][0]["uri"] = uri;
        replaceFile(bin, content_->binary);
    }
    const std::string out = dumped(1);
    replaceFile(path, std::as_bytes(std::span(out)));
}

} // namespace chiaro
