// Inside the glTF reader: compressed geometry becomes plain before anything looks at it. EXT_meshopt_compression and
// KHR_meshopt_compression pack buffer views, KHR_draco_mesh_compression packs the vertices and indices of a primitive. What is unpacked
// ends as further buffers, and the JSON then says what that of an uncompressed file would: accessors, tinygltf and writers need nothing
// new. Every size is held against the packed bytes before memory is asked for. Sources: the three extensions as of glTF 2.0 (Khronos
// registry), meshoptimizer 0.18, Draco bitstream 2.2.
#pragma once
#include "io/gltf_file.h"

namespace chiaro::gltf {

void unpackMeshopt(GltfFile& file); // before ranges of views are checked: those of packed ones lie in buffers that have no bytes
void unpackDraco(GltfFile& file);   // after

// The buffer holds no bytes of its own: it stands for what its packed views unpack to.
bool standsForPacked(const nlohmann::json& buffer);

// Appends a buffer; its number.
size_t addBuffer(GltfFile& file, std::vector<std::byte> bytes);
// The extension is no longer there.
void forgetExtension(GltfFile& file, const char* name);

} // namespace chiaro::gltf
