// Draco's meshes (bitstream 2.2, as KHR_draco_mesh_compression demands), decoded by Google's library under limits: what the stream says of
// its size is held against its length before the library asks for memory, and what comes out is checked before it is used.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace chiaro {

class DracoMesh {
public:
    // Throws std::runtime_error that says why not, without the file's name.
    explicit DracoMesh(std::span<const std::byte> bytes);
    DracoMesh(DracoMesh&&) noexcept;
    ~DracoMesh();

    size_t points() const;
    uint64_t bytes() const;                // of all that it holds
    std::vector<uint32_t> indices() const; // three a triangle, below points()
    // The values of an attribute, by its number in the stream, for every point: `width` numbers of glTF's componentType each, at steps of
    // `stride` bytes. Throws std::runtime_error when there is none, or it does not fit these numbers.
    std::vector<std::byte> values(uint32_t attribute, int component, int width, size_t stride) const;

private:
    struct Held;
    std::unique_ptr<Held> held_;
};

} // namespace chiaro
