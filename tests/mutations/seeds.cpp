#include "tests/mutations/seeds.h"
#include "tests/io/gltf_builder.h"
#include "tests/io/gltf_packing.h"
#include "tests/io/gltf_pictures.h"

namespace chiaro::test {

namespace {

const std::vector<float> quad = {-1, 0, -1, 1, 0, -1, -1, 0, 1, 1, 0, 1};
const std::vector<uint32_t> corners = {0, 2, 1, 1, 2, 3};

int texture(Builder& b, const std::string& bytes, const char* mime) {
    const int image = b.add("images", {{"bufferView", b.view(bytes)}, {"mimeType", mime}});
    return b.add("textures", {{"source", image}, {"sampler", b.add("samplers", {{"wrapS", 33071}, {"magFilter", 9728}})}});
}
json slot(int number) {
    return {{"index", number},
            {"texCoord", number % 2},
            {"extensions", {{"KHR_texture_transform", {{"offset", {0.1, 0.2}}, {"rotation", 0.3}, {"scale", {2, 2}}}}}}};
}

void addLights(Builder& b) {
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"intensity", 10}},
        {{"type", "spot"}, {"intensity", 20}, {"range", 30}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}},
        {{"type", "directional"}, {"color", {1, 0.5, 0.25}}}};
    for (int i = 0; i < 3; ++i) b.node({{"translation", {0, 3, i}}, {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
    b.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}},
                         {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 9}}}}};
    for (int i = 0; i < 2; ++i) b.node({{"camera", i}, {"translation", {0, 3, 0}}, {"rotation", {-0.7071068, 0, 0, 0.7071068}}});
}

json quadMesh(Builder& b) {
    return {{"POSITION", b.accessor<float>(quad, 3, "VEC3")},
            {"NORMAL", b.accessor<float>({0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0}, 3, "VEC3")},
            {"TANGENT", b.accessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, 4, "VEC4")},
            {"TEXCOORD_0", b.accessor<float>({0, 0, 1, 0, 0, 1, 1, 1}, 2, "VEC2")},
            {"TEXCOORD_1", b.accessor<uint16_t>({0, 0, 65535, 0, 0, 65535, 65535, 65535}, 2, "VEC2", true)},
            {"COLOR_0", b.accessor<uint8_t>({255, 255, 255, 255, 9, 99, 199, 255, 255, 0, 0, 255, 0, 255, 0, 128}, 4, "VEC4", true)}};
}

// Every extension of the materials, every kind of picture.
Builder materials() {
    Builder b;
    addLights(b);
    texture(b, png(3, 3, 4), "image/png");
    texture(b, picture("jpg", 8, 8, 3, OIIO::TypeDesc::UINT8), "image/jpeg");
    texture(b, picture("webp", 4, 4, 3, OIIO::TypeDesc::UINT8), "image/webp");
    texture(b, picture("exr", 2, 2, 3, OIIO::TypeDesc::HALF), "image/x-exr");
    texture(b, picture("png", 2, 2, 1, OIIO::TypeDesc::UINT16), "image/png");
    b.root["textures"][2] = {{"extensions", {{"EXT_texture_webp", {{"source", 2}}}}}};
    const json coat = {{"clearcoatFactor", 0.5}, {"clearcoatTexture", slot(0)}, {"clearcoatNormalTexture", slot(1)}};
    const json film = {{"iridescenceFactor", 1}, {"iridescenceThicknessTexture", slot(2)}, {"iridescenceThicknessMaximum", 700}};
    const json sheen = {{"sheenColorFactor", {1, 0.5, 0}}, {"sheenRoughnessFactor", 0.5}, {"sheenRoughnessTexture", slot(0)}};
    const json glass = {{"KHR_materials_transmission", {{"transmissionFactor", 1}, {"transmissionTexture", slot(4)}}},
                        {"KHR_materials_volume", {{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {1, 0.5, 0.5}}}},
                        {"KHR_materials_dispersion", {{"dispersion", 3}}},
                        {"KHR_materials_ior", {{"ior", 1.7}}}};
    const json old = {{"diffuseFactor", {0.5, 0.5, 0.5, 1}}, {"specularGlossinessTexture", slot(0)}, {"glossinessFactor", 0.5}};
    b.root["materials"] = {
        {{"pbrMetallicRoughness",
          {{"baseColorFactor", {1, 1, 1, 1}}, {"baseColorTexture", slot(0)}, {"metallicRoughnessTexture", slot(1)}}},
         {"normalTexture", {{"index", 2}, {"scale", 0.5}}},
         {"occlusionTexture", {{"index", 4}}},
         {"extensions",
          {{"KHR_materials_clearcoat", coat},
           {"KHR_materials_iridescence", film},
           {"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}, {"anisotropyTexture", slot(3)}}}}}},
        {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.2}}},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.4},
         {"extensions",
          {{"KHR_materials_sheen", sheen}, {"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorTexture", slot(0)}}}}}},
        {{"doubleSided", true}, {"alphaMode", "BLEND"}, {"extensions", glass}},
        {{"emissiveFactor", {1, 1, 1}},
         {"emissiveTexture", slot(3)},
         {"extensions",
          {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}},
           {"KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", 0.5}}}}}},
        {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", old}}}},
        {{"extensions", {{"KHR_materials_unlit", json::object()}}}}};
    const json attributes = quadMesh(b);
    const int indices = b.accessor<uint32_t>(corners, 1, "SCALAR");
    for (int m = 0; m < 6; ++m)
        b.node({{"mesh", b.mesh(attributes, {{"indices", indices}, {"material", m}})}, {"translation", {0, 0.1 * m, 0}}});
    return b;
}

// Strips, sparse values, quantized numbers, instances, a tree of nodes, animations, skins and morph targets.
Builder shapes() {
    Builder b;
    addLights(b);
    const json attributes = quadMesh(b);
    const int strip = b.mesh(attributes, {{"mode", 5}}), fan = b.mesh(attributes, {{"mode", 6}}), lines = b.mesh(attributes, {{"mode", 1}});
    const int sparse = b.accessor<float>(quad, 3, "VEC3"), where = b.view(std::string("\x01\x03", 2)), what = b.view(std::string(24, '\0'));
    b.root["accessors"][size_t(sparse)]["sparse"] = {
        {"count", 2}, {"indices", {{"bufferView", where}, {"componentType", 5121}}}, {"values", {{"bufferView", what}}}};
    const int small = b.accessor<int16_t>({-1000, 0, -1000, 0, 1000, 0, -1000, 0, -1000, 0, 1000, 0}, 3, "VEC3", true, 8);
    const int indices = b.accessor<uint8_t>({0, 2, 1, 1, 2, 3}, 1, "SCALAR");
    json target = {{"POSITION", b.accessor<float>({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0}, 3, "VEC3")}};
    const int morphed = b.mesh(attributes, {{"indices", indices}, {"targets", {target}}});
    b.root["meshes"][size_t(morphed)]["weights"] = {0.5};
    json skinned = attributes;
    skinned["JOINTS_0"] = b.accessor<uint8_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, 4, "VEC4");
    skinned["WEIGHTS_0"] = b.accessor<float>({1, 0, 0, 0, 0.5, 0.5, 0, 0, 0, 1, 0, 0, 0.25, 0.75, 0, 0}, 4, "VEC4");
    const int body = b.mesh(skinned, {{"indices", indices}});
    const int root =
        b.node({{"name", "w\xc3\xbcrzel"}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.5, 0, 1}}, {"children", json::array()}});
    const auto child = [&](json node) {
        const int number = b.add("nodes", std::move(node));
        b.root["nodes"][size_t(root)]["children"].push_back(number);
        return number;
    };
    for (const int mesh :
         {strip, fan, lines, b.mesh({{"POSITION", sparse}}, {{"indices", indices}}), b.mesh({{"POSITION", small}}, {{"indices", indices}})})
        child({{"mesh", mesh}, {"scale", {0.5, 0.5, 0.5}}});
    const int moving = child({{"mesh", morphed}}), bone = child({{"translation", {0, 1, 0}}});
    b.root["skins"] = {{{"joints", {bone, moving}}}};
    child({{"mesh", body}, {"skin", 0}});
    const int places = b.accessor<float>({0, 0, 0, 0, 2, 0}, 3, "VEC3");
    child({{"mesh", strip}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
    const int times = b.accessor<float>({0, 1}, 1, "SCALAR"), turns = b.accessor<float>({0, 0, 0, 1, 0, 1, 0, 0}, 4, "VEC4"),
              shifts = b.accessor<float>({0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 2, 2, 2, 0, 0, 0}, 3, "VEC3"),
              weights = b.accessor<float>({0, 1}, 1, "SCALAR");
    b.root["animations"] = {{{"samplers",
                              {{{"input", times}, {"output", turns}},
                               {{"input", times}, {"output", shifts}, {"interpolation", "CUBICSPLINE"}},
                               {{"input", times}, {"output", weights}, {"interpolation", "STEP"}}}},
                             {"channels",
                              {{{"sampler", 0}, {"target", {{"node", bone}, {"path", "rotation"}}}},
                               {{"sampler", 1}, {"target", {{"node", moving}, {"path", "translation"}}}},
                               {{"sampler", 2}, {"target", {{"node", moving}, {"path", "weights"}}}}}}}};
    return b;
}

Builder packedByMeshopt() {
    Builder b;
    addLights(b);
    const auto view = [&](const std::string& bytes, size_t count, size_t stride, const char* mode, const char* filter) {
        const int number = b.view(bytes);
        json& v = b.root["bufferViews"][size_t(number)];
        json packed = v;
        packed.update({{"count", count}, {"byteStride", stride}, {"mode", mode}, {"filter", filter}});
        v = {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", packed}}}};
        return number;
    };
    std::vector<uint32_t> exponents(quad.size());
    meshopt_encodeFilterExp(exponents.data(), 4, 12, 16, quad.data());
    const int plain = view(packedVertices(quad, 12), 4, 12, "ATTRIBUTES", "NONE"),
              coarse = view(packedVertices(exponents, 12), 4, 12, "ATTRIBUTES", "EXPONENTIAL"),
              triangles = view(packedTriangles(corners, 4), 6, 4, "TRIANGLES", "NONE"),
              sequence = view(packedSequence(corners, 4), 6, 4, "INDICES", "NONE");
    const auto accessor = [&](int from, int component, int count, const char* type) {
        return b.add("accessors", {{"bufferView", from}, {"componentType", component}, {"count", count}, {"type", type}});
    };
    b.node({{"mesh", b.mesh({{"POSITION", accessor(plain, 5126, 4, "VEC3")}}, {{"indices", accessor(triangles, 5125, 6, "SCALAR")}})}});
    b.node({{"mesh", b.mesh({{"POSITION", accessor(coarse, 5126, 4, "VEC3")}}, {{"indices", accessor(sequence, 5125, 6, "SCALAR")}})},
            {"translation", {0, 1, 0}}});
    b.root["buffers"] = {{{"byteLength", b.bytes.size()}},
                         {{"byteLength", 1000}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    b.root["extensionsRequired"] = {"EXT_meshopt_compression"};
    return b;
}

Builder packedByDraco(int method) {
    Builder b;
    addLights(b);
    std::vector<float> positions;
    std::vector<uint32_t> indices;
    for (uint32_t y = 0; y < 5; ++y)
        for (uint32_t x = 0; x < 5; ++x) {
            positions.insert(positions.end(), {float(x), float(x * y % 3), float(y)});
            const uint32_t at = 5 * y + x;
            if (x < 4 && y < 4) indices.insert(indices.end(), {at, at + 5, at + 1, at + 1, at + 5, at + 6});
        }
    const json packed = {{"bufferView", b.view(packedDraco(positions, indices, 0.2f, method))},
                         {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}};
    const int p = b.add("accessors", {{"componentType", 5126}, {"count", 25}, {"type", "VEC3"}}),
              c = b.add("accessors", {{"componentType", 5126}, {"count", 25}, {"type", "VEC2"}}),
              i = b.add("accessors", {{"componentType", 5123}, {"count", indices.size()}, {"type", "SCALAR"}});
    b.node({{"mesh",
             b.mesh({{"POSITION", p}, {"TEXCOORD_0", c}}, {{"indices", i}, {"extensions", {{"KHR_draco_mesh_compression", packed}}}})}});
    b.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return b;
}

} // namespace

std::vector<Seed> gltfSeeds() {
    return {{"materials.glb", materials().asGlb()},
            {"shapes.glb", shapes().asGlb()},
            {"shapes.gltf", shapes().asData()},
            {"meshopt.glb", packedByMeshopt().asGlb()},
            {"draco-edgebreaker.glb", packedByDraco(draco::MESH_EDGEBREAKER_ENCODING).asGlb()},
            {"draco-sequential.glb", packedByDraco(draco::MESH_SEQUENTIAL_ENCODING).asGlb()}};
}

std::vector<Seed> pictureSeeds() {
    std::vector<Seed> all;
    const auto add = [&](const char* format, int channels, OIIO::TypeDesc depth, const char* compression = "") {
        OIIO::ImageSpec spec;
        if (*compression) spec["compression"] = compression;
        all.push_back({std::to_string(all.size()) + "." + format, picture(format, 5, 4, channels, depth, {}, spec)});
    };
    for (int channels = 1; channels <= 4; ++channels) {
        add("png", channels, OIIO::TypeDesc::UINT8);
        add("png", channels, OIIO::TypeDesc::UINT16);
    }
    add("jpg", 1, OIIO::TypeDesc::UINT8);
    add("jpg", 3, OIIO::TypeDesc::UINT8);
    add("webp", 3, OIIO::TypeDesc::UINT8);
    add("webp", 4, OIIO::TypeDesc::UINT8, "lossless");
    add("hdr", 3, OIIO::TypeDesc::FLOAT);
    for (const char* compression : {"none", "rle", "zip", "zips", "piz", "pxr24", "b44", "dwaa"})
        add("exr", 3, OIIO::TypeDesc::HALF, compression);
    add("exr", 4, OIIO::TypeDesc::FLOAT, "zip");
    add("tif", 3, OIIO::TypeDesc::UINT8, "lzw");
    add("tif", 4, OIIO::TypeDesc::FLOAT, "none");
    add("bmp", 3, OIIO::TypeDesc::UINT8);
    return all;
}

} // namespace chiaro::test
