// What a glTF file says, beside the description that was made of it: for people who ask why a picture is as it is. Nothing of a file is
// left out in silence: what is applied, put in another way, left aside and made up is listed here, in counts and lines.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace chiaro {

struct GltfInventory {
    enum class Use : uint8_t { applied, invisible, ignored }; // invisible: changes nothing that is drawn
    struct Extension {
        std::string name;
        Use use = Use::ignored;
        bool required = false;
        size_t places = 0; // that carry it; 0: only announced
    };
    struct Picture {
        std::string format; // "PNG", "JPEG", "WebP"; empty: none was read
        uint64_t bytes = 0; // as stored
    };
    struct Skin {
        std::string name;
        size_t joints = 0;
    };
    std::string version, generator, copyright;
    uint64_t bytes = 0; // of the file, and of the buffers beside it
    std::vector<Extension> extensions;
    std::vector<Picture> pictures; // of the description's images, in their order
    std::vector<Skin> skins;
    size_t meshes = 0, materials = 0, images = 0; // all that the file holds; the description has what the scene shows
    size_t morphTargets = 0;                      // of the meshes that are shown
    std::vector<std::string> approximated, ignored, added;
};

} // namespace chiaro
