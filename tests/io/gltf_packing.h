// Packs vertices and indices as files do that use EXT_meshopt_compression or KHR_draco_mesh_compression.
#pragma once
#include <cstdint>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>
#include <stdexcept>
#include <string>
#include <vector>

namespace chiaro::test {

template <class T> std::string packedVertices(const std::vector<T>& values, size_t stride) {
    const size_t count = values.size() * sizeof(T) / stride;
    std::string out(meshopt_encodeVertexBufferBound(count, stride), '\0');
    out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), values.data(), count, stride));
    return out;
}
template <class T> std::string packedTriangles(const std::vector<T>& values, size_t vertices) {
    std::string out(meshopt_encodeIndexBufferBound(values.size(), vertices), '\0');
    out.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), values.data(), values.size()));
    return out;
}
template <class T> std::string packedSequence(const std::vector<T>& values, size_t vertices) {
    std::string out(meshopt_encodeIndexSequenceBound(values.size(), vertices), '\0');
    out.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(out.data()), out.size(), values.data(), values.size()));
    return out;
}

// Attribute 0: positions, attribute 1: (x, z) * scale as texture coordinates.
inline std::string packedDraco(const std::vector<float>& positions, const std::vector<uint32_t>& indices, float scale, int method) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(int(indices.size() / 3));
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32),
              uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
    for (uint32_t t = 0; t < indices.size() / 3; ++t) {
        float p[3][3], c[3][2];
        for (size_t k = 0; k < 3; ++k) {
            for (size_t n = 0; n < 3; ++n) p[k][n] = positions[3 * indices[3 * t + k] + n];
            c[k][0] = p[k][0] * scale, c[k][1] = p[k][2] * scale;
        }
        builder.SetAttributeValuesForFace(position, draco::FaceIndex(t), p[0], p[1], p[2]);
        builder.SetAttributeValuesForFace(uv, draco::FaceIndex(t), c[0], c[1], c[2]);
    }
    const auto mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
    draco::EncoderBuffer out;
    if (!mesh || !encoder.EncodeMeshToBuffer(*mesh, &out).ok()) throw std::runtime_error("Draco cannot pack this mesh");
    return {out.data(), out.size()};
}

} // namespace chiaro::test
