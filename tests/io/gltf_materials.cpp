// Materials, texture slots, samplers, and where pictures come from.
#include "tests/io/gltf_builder.h"
#include "tests/io/gltf_pictures.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

MaterialDesc materialOf(const Folder& folder, json material, Diagnostics& notes) {
    Builder b = Builder::triangle({{"material", 0}});
    b.root["materials"] = {std::move(material)};
    const SceneDesc scene = b.read(folder, notes);
    REQUIRE(scene.materials.size() == 1);
    CHECK(scene.meshes[0].primitives[0].material == 0);
    return scene.materials[0];
}

// A triangle whose base colour is texture 0 of image 0.
Builder textured(json image) {
    Builder b = Builder::triangle({{"material", 0}});
    b.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    b.root["textures"] = {{{"source", 0}}};
    b.root["images"] = {std::move(image)};
    return b;
}

void checkTransform(const TextureSlot& slot, Point2 uv, Point2 expected) {
    const auto& m = slot.transform;
    CHECK(m[0][0] * uv.x + m[0][1] * uv.y + m[0][2] == doctest::Approx(expected.x));
    CHECK(m[1][0] * uv.x + m[1][1] * uv.y + m[1][2] == doctest::Approx(expected.y));
}

} // namespace

TEST_SUITE("gltf_materials") {
    TEST_CASE("defaults are glTF's") {
        const Folder folder("defaults");
        Diagnostics notes;
        const MaterialDesc m = materialOf(folder, json::object(), notes);
        CHECK(m.baseColor == Spectrum(1));
        CHECK(m.alpha == 1);
        CHECK(m.metallic == 1);
        CHECK(m.roughness == 1);
        CHECK(black(m.emission));
        CHECK(m.alphaMode == AlphaMode::opaque);
        CHECK(m.alphaCutoff == 0.5f);
        CHECK(!m.doubleSided);
        CHECK(!m.unlit);
        CHECK(m.ior == 1.5f);
        CHECK(m.specular == 1);
        CHECK(m.transmission == 0);
        CHECK(!m.volume);
        CHECK(std::isinf(m.attenuationDistance));
        CHECK(m.baseColorTexture.texture == -1);
        CHECK(notes.warnings().empty());
    }

    TEST_CASE("every factor arrives") {
        const Folder folder("factors");
        Diagnostics notes;
        const MaterialDesc m = materialOf(
            folder,
            {{"name", "all"},
             {"pbrMetallicRoughness", {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.6}}},
             {"emissiveFactor", {1, 0.5, 0}},
             {"alphaMode", "MASK"},
             {"alphaCutoff", 0.7},
             {"doubleSided", true},
             {"extensions",
              {{"KHR_materials_emissive_strength", {{"emissiveStrength", 200}}},
               {"KHR_materials_ior", {{"ior", 1.33}}},
               {"KHR_materials_specular", {{"specularFactor", 0}, {"specularColorFactor", {2, 1, 0}}}},
               {"KHR_materials_transmission", {{"transmissionFactor", 0.9}}},
               {"KHR_materials_unlit", json::object()},
               {"KHR_materials_volume", {{"thicknessFactor", 0.01}, {"attenuationDistance", 3}, {"attenuationColor", {0.5, 0.6, 0.7}}}}}}},
            notes);
        CHECK(m.name == "all");
        CHECK(m.baseColor == Spectrum(0.1f, 0.2f, 0.3f));
        CHECK(m.alpha == 0.4f);
        CHECK(m.metallic == 0.5f);
        CHECK(m.roughness == 0.6f);
        CHECK(m.emission == Spectrum(200, 100, 0));
        CHECK(m.alphaMode == AlphaMode::mask);
        CHECK(m.alphaCutoff == 0.7f);
        CHECK(m.doubleSided);
        CHECK(m.unlit);
        CHECK(m.ior == 1.33f);
        CHECK(m.specular == 0);
        CHECK(m.specularColor == Spectrum(2, 1, 0));
        CHECK(m.transmission == 0.9f);
        CHECK(m.volume);
        CHECK(m.attenuationDistance == 3);
        CHECK(m.attenuationColor == Spectrum(0.5f, 0.6f, 0.7f));
        CHECK(notes.warnings().empty());
    }

    TEST_CASE("corner cases: infinite ior, thin volume, BLEND, values out of range, unknown extensions") {
        const Folder folder("corners");
        Diagnostics notes;
        const MaterialDesc m = materialOf(folder,
                                          {{"alphaMode", "BLEND"},
                                           {"pbrMetallicRoughness", {{"roughnessFactor", 1.5}}},
                                           {"extensions",
                                            {{"KHR_materials_ior", {{"ior", 0}}},
                                             {"KHR_materials_volume", {{"attenuationDistance", 3}}},
                                             {"VENDOR_glitter", json::object()},
                                             {"MSFT_packing_occlusionRoughnessMetallic", {{"x", 1}}}}}},
                                          notes);
        CHECK(m.ior == 0);
        CHECK(!m.volume);
        CHECK(m.alphaMode == AlphaMode::blend);
        CHECK(m.roughness == 1);
        CHECK(warns(notes, "/materials/0 has roughnessFactor 1.5, must be from 0 to 1; 1 is used"));
        CHECK(warns(notes, "uses VENDOR_glitter, which is not applied"));
        CHECK(warns(notes, "uses MSFT_packing_occlusionRoughnessMetallic, which is not applied"));
        CHECK(notes.warnings().size() == 3);
    }

    TEST_CASE("every texture slot, its UV set and its transform") {
        const Folder folder("slots");
        Builder b = Builder::triangle({{"material", 0}});
        b.root["images"] = {{{"bufferView", b.view(png(2, 2, 3))}, {"mimeType", "image/png"}}};
        for (int i = 0; i < 8; ++i) b.add("textures", {{"source", 0}});
        const auto info = [](int i) { return json{{"index", i}, {"texCoord", i % 2}}; };
        b.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", info(0)}, {"metallicRoughnessTexture", info(1)}}},
                                {"normalTexture", {{"index", 2}, {"scale", 0.5}}},
                                {"emissiveTexture", info(3)},
                                {"occlusionTexture", info(4)},
                                {"extensions",
                                 {{"KHR_materials_specular", {{"specularTexture", info(5)}, {"specularColorTexture", info(6)}}},
                                  {"KHR_materials_transmission", {{"transmissionTexture", info(7)}}}}}}};
        json& base = b.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
        base["extensions"]["KHR_texture_transform"] = {
            {"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}, {"texCoord", 1}};
        const SceneDesc scene = b.read(folder);
        CHECK(scene.images.size() == 1); // decoded once
        const MaterialDesc& m = scene.materials.at(0);
        for (const TextureSlot* s : {&m.baseColorTexture, &m.metallicRoughnessTexture, &m.normalTexture, &m.emissionTexture,
                                     &m.specularTexture, &m.specularColorTexture, &m.transmissionTexture}) {
            REQUIRE(s->texture >= 0);
            CHECK(scene.textures.at(size_t(s->texture)).image == 0);
        }
        CHECK(m.normalScale == 0.5f);
        CHECK(m.baseColorTexture.uvSet == 1);
        CHECK(m.metallicRoughnessTexture.uvSet == 1);
        CHECK(m.specularColorTexture.uvSet == 0);
        // The extension's own example: the lower left quarter of the picture (u 0..0.5, v 0.5..1), turned clockwise.
        checkTransform(m.baseColorTexture, {0, 0}, {0, 1});
        checkTransform(m.baseColorTexture, {1, 0}, {0, 0.5f});
        checkTransform(m.baseColorTexture, {0, 1}, {0.5f, 1});
        checkTransform(m.metallicRoughnessTexture, {0.3f, 0.4f}, {0.3f, 0.4f});
    }

    TEST_CASE("texture sets beyond the fourth fall back to the first, with a warning") {
        const Folder folder("sets");
        Builder b = textured({{"uri", "data:image/png;base64," + base64(png(1, 1, 3))}});
        b.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 4;
        Diagnostics notes;
        CHECK(b.read(folder, notes).materials[0].baseColorTexture.uvSet == 0);
        CHECK(warns(notes, "uses TEXCOORD_4"));
    }

    TEST_CASE("samplers: wrap and filter") {
        const Folder folder("samplers");
        Builder b = textured({{"uri", "data:image/png;base64," + base64(png(1, 1, 3))}});
        CHECK(b.read(folder).textures[0].wrapS == Wrap::repeat);
        CHECK(b.read(folder).textures[0].filter == TextureFilter::linear);
        b.root["textures"][0]["sampler"] = 0;
        b.root["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9987}}};
        const TextureDesc t = b.read(folder).textures[0];
        CHECK(t.wrapS == Wrap::clamp);
        CHECK(t.wrapT == Wrap::mirror);
        CHECK(t.filter == TextureFilter::nearest);
    }

    TEST_CASE("pictures: embedded, data: URI, files with spaces and Unicode names, WebP") {
        const Folder folder("pictures");
        folder.write("tex tures/\xc3\xbc 1.png", png(3, 2, 3));
        folder.write("plain.webp", picture("webp", 3, 2, 3, OIIO::TypeDesc::UINT8));
        const auto check = [&](const Builder& b) {
            Diagnostics notes;
            const SceneDesc scene = b.read(folder, notes);
            REQUIRE(scene.images.size() == 1);
            CHECK(scene.images[0].width == 3);
            CHECK(scene.images[0].height == 2);
            CHECK(scene.images[0].channels == 3);
            CHECK(notes.warnings().empty());
        };
        check(textured({{"uri", "tex%20tures/%C3%BC%201.png"}}));
        check(textured({{"uri", "tex tures/\xc3\xbc 1.png"}}));
        check(textured({{"uri", "data:image/png;base64," + base64(png(3, 2, 3))}}));
        Builder embedded = textured({{"mimeType", "image/png"}});
        embedded.root["images"][0]["bufferView"] = embedded.view(png(3, 2, 3));
        check(embedded);
        Builder webp = textured({{"uri", "plain.webp"}});
        webp.root["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
        webp.root["extensionsRequired"] = {"EXT_texture_webp"};
        check(webp);
    }

    TEST_CASE("only what a drawn material uses is decoded") {
        const Folder folder("unused");
        Builder b = Builder::triangle();
        b.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        b.root["textures"] = {{{"source", 0}}};
        b.root["images"] = {{{"uri", "absent.png"}}};
        const SceneDesc scene = b.read(folder);
        CHECK(scene.images.empty());
        CHECK(scene.materials.empty());
    }

    TEST_CASE("a missing or broken picture: an error with its place, or grey") {
        const Folder folder("missing");
        const auto check = [&](const Builder& b, const std::string& message) {
            const fs::path file = folder.write("room.gltf", b.asData());
            const Failure f = failure(file);
            CHECK(f.code == Exit::file);
            CHECK(f.message == file.string() + ": " + message + ". Fix the path or pass --missing-texture grey");
            Diagnostics notes;
            const SceneDesc scene = readGltf(file, {MissingTexture::grey}, notes);
            REQUIRE(scene.images.size() == 1);
            CHECK(scene.images[0].width == 1);
            CHECK(scene.images[0].pixels == std::vector<std::byte>(3, std::byte(128)));
            CHECK(notes.warnings().size() == 1);
            CHECK(warns(notes, "grey stands in"));
        };
        check(textured({{"uri", "tex/wood.png"}}), "/images/0/uri \"tex/wood.png\" not found");
        folder.write("broken.png", png(64, 64, 3).substr(0, 120));
        const Failure f = failure(folder.write("broken.gltf", textured({{"uri", "broken.png"}}).asData()));
        CHECK(f.message.find("/images/0/uri \"broken.png\" cannot be decoded (") != std::string::npos);
        folder.write("text.png", "this is no picture");
        check(textured({{"uri", "text.png"}}), "/images/0/uri \"text.png\" cannot be decoded (no known picture format)");
        check(textured(json::object()), "/images/0 has neither \"uri\" nor \"bufferView\"");
        Builder normal = textured({{"uri", "gone.png"}}); // grey is no direction: no normal map then
        normal.root["materials"] = {{{"normalTexture", {{"index", 0}}}}};
        Diagnostics notes;
        CHECK(readGltf(folder.write("n.gltf", normal.asData()), {MissingTexture::grey}, notes).materials[0].normalTexture.texture == -1);
    }
}
