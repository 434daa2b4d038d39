// Inside the glTF writer: the document under construction, its JSON and the bytes of its one buffer.
#pragma once
#include "io/gltf_file.h"
#include "io/gltf_write.h"
#include <set>

namespace chiaro {

struct GltfDocument::Content {
    nlohmann::json json;
    std::vector<std::byte> binary; // buffer 0
    GltfOrigin origin;
    gltf::GltfFile file; // as it was before anything was written into it

    std::size_t addView(const void* bytes, std::size_t size, int target = 0, std::size_t stride = 0);
    // component: glTF's componentType; width: numbers an element.
    std::size_t addAccessor(const void* values, std::size_t count, int component, const char* type, std::size_t bytes, int target);
    std::size_t addImage(const std::string& name, std::span<const std::byte>, const std::string& mime);
    std::size_t append(const char* list, nlohmann::json value); // its number
    void use(const std::string& extension);
};

namespace gltf {
nlohmann::json materialOf(GltfDocument::Content& to, const MaterialDesc&); // notes the extensions that it uses
std::string mimeOf(std::span<const std::byte>);                            // of a picture; empty: unknown
constexpr int arrayBuffer = 34962, elementArrayBuffer = 34963, floatNumber = 5126, uintNumber = 5125;
} // namespace gltf

} // namespace chiaro
