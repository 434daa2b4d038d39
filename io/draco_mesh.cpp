#include "io/draco_mesh.h"
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <fmt/format.h>
#include <stdexcept>

namespace chiaro {

struct DracoMesh::Held {
    draco::Mesh mesh;
};

namespace {

[[noreturn]] void refuse(const std::string& why) { throw std::runtime_error(why); }

// Flat or regular meshes take very few bits a triangle; these many are free whatever the length.
constexpr uint64_t freeElements = uint64_t(1) << 21, elementsPerByte = 64;
constexpr uint64_t freeBytes = uint64_t(1) << 28, bytesPerByte = 1024;

// One of the library's decoders, stopped before it asks for memory that its stream does not account for.
template <class Decoder> class Bounded : public Decoder {
public:
    explicit Bounded(size_t length) : length_(length) {}
    const std::string& why() const { return why_; }

protected:
    // Both kinds begin with two counts: vertices and triangles, or triangles and points.
    bool DecodeConnectivity() override {
        draco::DecoderBuffer ahead = *this->buffer();
        uint32_t first = 0, second = 0;
        if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead)) return false;
        if (std::max(first, second) > freeElements + elementsPerByte * length_) {
            why_ = fmt::format("it says {} elements, more than its {} bytes account for", std::max(first, second), length_);
            return false;
        }
        return Decoder::DecodeConnectivity();
    }
    bool DecodeAllAttributes() override {
        const draco::PointCloud& cloud = *this->point_cloud();
        uint64_t bytes = 0;
        for (int i = 0; i < cloud.num_attributes(); ++i)
            bytes += uint64_t(cloud.num_points()) * uint64_t(std::max<int64_t>(cloud.attribute(i)->byte_stride(), 1));
        if (bytes > freeBytes + bytesPerByte * length_) {
            why_ = fmt::format("its attributes say {} bytes, more than its {} bytes account for", bytes, length_);
            return false;
        }
        return Decoder::DecodeAllAttributes();
    }

private:
    size_t length_;
    std::string why_;
};

template <class Decoder> void decode(std::span<const std::byte> bytes, draco::Mesh& mesh) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const draco::DecoderOptions options;
    Bounded<Decoder> decoder(bytes.size());
    const draco::Status status = decoder.Decode(options, &buffer, &mesh);
    if (!status.ok()) refuse(decoder.why().empty() ? "its bytes are damaged" : decoder.why());
}

template <class T> void convert(const draco::PointAttribute& from, size_t points, int width, size_t stride, std::vector<std::byte>& to) {
    T element[16] = {};
    for (size_t p = 0; p < points; ++p) {
        const draco::AttributeValueIndex at = from.mapped_index(draco::PointIndex(uint32_t(p)));
        if (at.value() >= from.size()) refuse("a vertex has no value");
        if (!from.ConvertValue<T>(at, int8_t(width), element)) refuse("a value does not fit the accessor's type");
        std::memcpy(&to[p * stride], element, size_t(width) * sizeof(T));
    }
}

} // namespace

DracoMesh::DracoMesh(std::span<const std::byte> bytes) : held_(std::make_unique<Held>()) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::DracoHeader header;
    if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) refuse("it is no Draco stream");
    if (header.version_major != 2 || header.version_minor != 2)
        refuse(fmt::format("it is Draco bitstream {}.{}, glTF's is 2.2", header.version_major, header.version_minor));
    if (header.encoder_type != draco::TRIANGULAR_MESH) refuse("it is a cloud of points, not a mesh");
    if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
        decode<draco::MeshEdgebreakerDecoder>(bytes, held_->mesh);
    else if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
        decode<draco::MeshSequentialDecoder>(bytes, held_->mesh);
    else
        refuse(fmt::format("its method {} is unknown", int(header.encoder_method)));
    if (held_->mesh.num_faces() == 0 || held_->mesh.num_points() == 0) refuse("it holds no triangle");
}
DracoMesh::DracoMesh(DracoMesh&&) noexcept = default;
DracoMesh::~DracoMesh() = default;

size_t DracoMesh::points() const { return held_->mesh.num_points(); }

uint64_t DracoMesh::bytes() const {
    const draco::Mesh& mesh = held_->mesh;
    uint64_t all = uint64_t(mesh.num_faces()) * 12;
    for (int i = 0; i < mesh.num_attributes(); ++i) all += mesh.attribute(i)->size() * uint64_t(mesh.attribute(i)->byte_stride());
    return all;
}

std::vector<uint32_t> DracoMesh::indices() const {
    const draco::Mesh& mesh = held_->mesh;
    std::vector<uint32_t> all;
    all.reserve(size_t(mesh.num_faces()) * 3);
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
        for (const draco::PointIndex& p : mesh.face(f)) {
            if (p.value() >= mesh.num_points()) refuse("a triangle names a vertex that is not there");
            all.push_back(p.value());
        }
    return all;
}

std::vector<std::byte> DracoMesh::values(uint32_t number, int component, int width, size_t stride) const {
    const draco::PointAttribute* from = held_->mesh.GetAttributeByUniqueId(number);
    if (!from) refuse(fmt::format("it has no attribute {}", number));
    if (from->num_components() != width)
        refuse(fmt::format("its attribute {} has {} numbers, the accessor {}", number, int(from->num_components()), width));
    std::vector<std::byte> out(points() * stride);
    switch (component) {
    case 5120: convert<int8_t>(*from, points(), width, stride, out); break;
    case 5121: convert<uint8_t>(*from, points(), width, stride, out); break;
    case 5122: convert<int16_t>(*from, points(), width, stride, out); break;
    case 5123: convert<uint16_t>(*from, points(), width, stride, out); break;
    case 5125: convert<uint32_t>(*from, points(), width, stride, out); break;
    case 5126: convert<float>(*from, points(), width, stride, out); break;
    default: refuse(fmt::format("componentType {} is unknown", component));
    }
    return out;
}

} // namespace chiaro
