// Materials beyond metal and roughness: every factor and every texture slot of each extension arrives, and is written back as it was.
#include "io/gltf_write.h"
#include "tests/io/gltf_builder.h"
#include "tests/io/gltf_pictures.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr int pictures = 24;

// A triangle with this material, and textures to choose from: number n wraps and mirrors its own way.
Builder withMaterial(json material) {
    Builder b = Builder::triangle({{"material", 0}});
    b.root["materials"] = {std::move(material)};
    b.root["images"] = {{{"bufferView", b.view(png(2, 2, 4))}, {"mimeType", "image/png"}}};
    b.root["samplers"] = {{{"wrapS", 33071}}, {{"wrapS", 33648}}};
    for (int i = 0; i < pictures; ++i) b.add("textures", {{"source", 0}, {"sampler", i % 2}});
    return b;
}
MaterialDesc materialOf(json extensions, Diagnostics& notes) {
    const Folder folder("layers");
    const SceneDesc scene = withMaterial({{"extensions", std::move(extensions)}}).read(folder, notes);
    REQUIRE(scene.materials.size() == 1);
    return scene.materials[0];
}
json info(int texture) {
    return {{"index", texture},
            {"texCoord", texture % 2},
            {"extensions", {{"KHR_texture_transform", {{"offset", {0.125 * texture, 0.5}}, {"scale", {2, 4}}}}}}};
}

// Everything that a slot says but the number of its texture, which readers choose.
void checkSlot(const TextureSlot& s, int number) {
    CAPTURE(number);
    REQUIRE(s.texture >= 0);
    CHECK(s.uvSet == number % 2);
    CHECK(s.transform[0][2] == 0.125f * float(number));
    CHECK(s.transform[1][2] == 0.5f);
    CHECK(s.transform[0][0] == 2);
    CHECK(s.transform[1][1] == 4);
}

struct Slot {
    const char* extension;
    const char* name;
    TextureSlot MaterialDesc::*slot;
};
constexpr Slot slots[] = {
    {"KHR_materials_clearcoat", "clearcoatTexture", &MaterialDesc::clearcoatTexture},
    {"KHR_materials_clearcoat", "clearcoatRoughnessTexture", &MaterialDesc::clearcoatRoughnessTexture},
    {"KHR_materials_clearcoat", "clearcoatNormalTexture", &MaterialDesc::clearcoatNormalTexture},
    {"KHR_materials_sheen", "sheenColorTexture", &MaterialDesc::sheenColorTexture},
    {"KHR_materials_sheen", "sheenRoughnessTexture", &MaterialDesc::sheenRoughnessTexture},
    {"KHR_materials_anisotropy", "anisotropyTexture", &MaterialDesc::anisotropyTexture},
    {"KHR_materials_iridescence", "iridescenceTexture", &MaterialDesc::iridescenceTexture},
    {"KHR_materials_iridescence", "iridescenceThicknessTexture", &MaterialDesc::iridescenceThicknessTexture},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionTexture", &MaterialDesc::diffuseTransmissionTexture},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionColorTexture", &MaterialDesc::diffuseTransmissionColorTexture},
    {"KHR_materials_specular", "specularTexture", &MaterialDesc::specularTexture},
    {"KHR_materials_specular", "specularColorTexture", &MaterialDesc::specularColorTexture},
    {"KHR_materials_transmission", "transmissionTexture", &MaterialDesc::transmissionTexture}};
constexpr Slot oldSlots[] = {
    {"KHR_materials_pbrSpecularGlossiness", "diffuseTexture", &MaterialDesc::baseColorTexture},
    {"KHR_materials_pbrSpecularGlossiness", "specularGlossinessTexture", &MaterialDesc::specularGlossinessTexture}};

json everything() {
    return {
        {"KHR_materials_clearcoat",
         {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.25}, {"clearcoatNormalTexture", {{"index", 0}, {"scale", 0.75}}}}},
        {"KHR_materials_sheen", {{"sheenColorFactor", {0.5, 0.25, 0.125}}, {"sheenRoughnessFactor", 0.375}}},
        {"KHR_materials_anisotropy", {{"anisotropyStrength", 0.625}, {"anisotropyRotation", -7.5}}},
        {"KHR_materials_iridescence",
         {{"iridescenceFactor", 0.75},
          {"iridescenceIor", 1.75},
          {"iridescenceThicknessMinimum", 50},
          {"iridescenceThicknessMaximum", 850}}},
        {"KHR_materials_dispersion", {{"dispersion", 2.5}}},
        {"KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", 0.25}, {"diffuseTransmissionColorFactor", {1, 0.5, 0.25}}}}};
}

void checkEverything(const MaterialDesc& m) {
    CHECK(m.clearcoat == 0.5f);
    CHECK(m.clearcoatRoughness == 0.25f);
    CHECK(m.clearcoatNormalScale == 0.75f);
    CHECK(m.sheenColor == Spectrum(0.5f, 0.25f, 0.125f));
    CHECK(m.sheenRoughness == 0.375f);
    CHECK(m.anisotropy == 0.625f);
    CHECK(m.anisotropyRotation == -7.5f);
    CHECK(m.iridescence == 0.75f);
    CHECK(m.iridescenceIor == 1.75f);
    CHECK(m.iridescenceMin == 50);
    CHECK(m.iridescenceMax == 850);
    CHECK(m.dispersion == 2.5f);
    CHECK(m.diffuseTransmission == 0.25f);
    CHECK(m.diffuseTransmissionColor == Spectrum(1, 0.5f, 0.25f));
}

} // namespace

TEST_SUITE("gltf_layers") {
    TEST_CASE("empty extensions are their defaults") {
        json empty;
        for (const Slot& s : slots) empty[s.extension] = json::object();
        empty["KHR_materials_dispersion"] = json::object();
        Diagnostics notes;
        const MaterialDesc m = materialOf(empty, notes), d;
        CHECK(m.clearcoat == 0);
        CHECK(black(m.sheenColor));
        CHECK(m.anisotropy == 0);
        CHECK(m.iridescence == 0);
        CHECK(m.iridescenceIor == d.iridescenceIor);
        CHECK(m.iridescenceMin == 100);
        CHECK(m.iridescenceMax == 400);
        CHECK(m.dispersion == 0);
        CHECK(m.diffuseTransmission == 0);
        CHECK(m.diffuseTransmissionColor == Spectrum(1));
        CHECK_FALSE(m.specularGlossiness);
        CHECK(notes.warnings().empty());
        const MaterialDesc old = materialOf({{"KHR_materials_pbrSpecularGlossiness", json::object()}}, notes);
        CHECK(old.specularGlossiness);
        CHECK(old.baseColor == Spectrum(1));
        CHECK(old.specularColor == Spectrum(1));
        CHECK(old.glossiness == 1);
        CHECK(notes.warnings().empty());
    }

    TEST_CASE("every factor arrives") {
        Diagnostics notes;
        checkEverything(materialOf(everything(), notes));
        CHECK(notes.warnings().empty());
    }

    TEST_CASE("every texture slot, its UV set and its transform") {
        json extensions;
        int number = 0;
        for (const Slot& s : slots) extensions[s.extension][s.name] = info(number++);
        Diagnostics notes;
        const MaterialDesc m = materialOf(extensions, notes);
        CHECK(notes.warnings().empty());
        number = 0;
        for (const Slot& s : slots) checkSlot(m.*s.slot, number++);
        json old;
        number = 0;
        for (const Slot& s : oldSlots) old[s.extension][s.name] = info(number++);
        const MaterialDesc o = materialOf(old, notes);
        number = 0;
        for (const Slot& s : oldSlots) checkSlot(o.*s.slot, number++);
    }

    TEST_CASE("values out of range are brought into it, and named") {
        Diagnostics notes;
        const MaterialDesc m = materialOf({{"KHR_materials_clearcoat", {{"clearcoatFactor", 3}}},
                                           {"KHR_materials_sheen", {{"sheenColorFactor", {2, -1, 0.5}}}},
                                           {"KHR_materials_iridescence", {{"iridescenceIor", 0.5}, {"iridescenceThicknessMaximum", -4}}},
                                           {"KHR_materials_dispersion", {{"dispersion", -1}}}},
                                          notes);
        CHECK(m.clearcoat == 1);
        CHECK(m.sheenColor == Spectrum(1, 0, 0.5f));
        CHECK(m.iridescenceIor == 1);
        CHECK(m.iridescenceMax == 0);
        CHECK(m.dispersion == 0);
        CHECK(warns(notes, "/materials/0 has clearcoatFactor 3, must be from 0 to 1; 1 is used"));
        CHECK(notes.warnings().size() == 6);
    }

    TEST_CASE("specular-glossiness is taken before metal and roughness, whose pictures are not read; unlit before both") {
        const Folder folder("old");
        json material = {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 1, 0, 1}}, {"baseColorTexture", {{"index", 0}}}}},
                         {"extensions",
                          {{"KHR_materials_pbrSpecularGlossiness",
                            {{"diffuseFactor", {0.5, 0.25, 0, 0.75}}, {"specularFactor", {0.5, 0, 0}}, {"glossinessFactor", 0.25}}},
                           {"KHR_materials_specular", {{"specularFactor", 0.1}, {"specularTexture", {{"index", 1}}}}}}}};
        Diagnostics notes;
        const SceneDesc scene = withMaterial(material).read(folder, notes);
        const MaterialDesc& m = scene.materials.at(0);
        CHECK(scene.images.empty());
        CHECK(m.specularGlossiness);
        CHECK(m.baseColor == Spectrum(0.5f, 0.25f, 0));
        CHECK(m.alpha == 0.75f);
        CHECK(m.specularColor == Spectrum(0.5f, 0, 0));
        CHECK(m.glossiness == 0.25f);
        CHECK(m.specular == 1);
        material["extensions"]["KHR_materials_unlit"] = json::object();
        const SceneDesc plain = withMaterial(material).read(folder, notes);
        CHECK_FALSE(plain.materials.at(0).specularGlossiness);
        CHECK(plain.materials.at(0).baseColor == Spectrum(0, 1, 0));
        CHECK(notes.warnings().empty());
    }

    TEST_CASE("members of the wrong type name their place") {
        const auto check = [](json extensions, const std::string& part) {
            const Folder folder("wrong");
            const Failure f = failure(folder.write("a.glb", withMaterial({{"extensions", std::move(extensions)}}).asGlb()));
            CHECK(f.code == Exit::file);
            CHECK_MESSAGE(f.message.find(part) != std::string::npos, f.message);
        };
        check({{"KHR_materials_clearcoat", {{"clearcoatFactor", "1"}}}},
              "/materials/0/extensions/KHR_materials_clearcoat/clearcoatFactor must be a number");
        check({{"KHR_materials_clearcoat", {{"clearcoatNormalTexture", {{"index", 0}, {"scale", json::array()}}}}}},
              "clearcoatNormalTexture/scale must be a number");
        check({{"KHR_materials_sheen", {{"sheenColorFactor", {1, 2}}}}}, "sheenColorFactor must be a list of 3 numbers, not a list of 2");
        check({{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {1, 2, 3}}}}}, "must be a list of 4 numbers");
        check({{"KHR_materials_anisotropy", {{"anisotropyTexture", {{"index", 99}}}}}}, "anisotropyTexture/index is 99");
        check({{"KHR_materials_dispersion", {{"dispersion", nullptr}}}}, "dispersion must be a number");
    }

    TEST_CASE("written and read again") {
        const Folder folder("written");
        const auto again = [&](json material) {
            Diagnostics notes;
            const SceneDesc scene = withMaterial(std::move(material)).read(folder, notes);
            GltfDocument::describe(scene).write(folder.path / "again.glb");
            const SceneDesc back = readGltf(folder.path / "again.glb", {}, notes);
            CHECK(notes.warnings().empty());
            CHECK(back.textures.size() == scene.textures.size());
            return back.materials.at(0);
        };
        json extensions = everything();
        extensions["KHR_materials_transmission"] = {{"transmissionFactor", 0.5}};
        int number = 0;
        for (const Slot& s : slots) extensions[s.extension][s.name] = info(number++);
        extensions["KHR_materials_clearcoat"]["clearcoatNormalTexture"]["scale"] = 0.75;
        const MaterialDesc m = again({{"extensions", extensions}});
        checkEverything(m);
        number = 0;
        for (const Slot& s : slots) checkSlot(m.*s.slot, number++);
        json old = {{"diffuseFactor", {0.5, 0.25, 0, 0.75}}, {"specularFactor", {0.5, 0, 0}}, {"glossinessFactor", 0.25}};
        number = 0;
        for (const Slot& s : oldSlots) old[s.name] = info(number++);
        const MaterialDesc o = again({{"extensions", {{"KHR_materials_pbrSpecularGlossiness", old}}}});
        CHECK(o.specularGlossiness);
        CHECK(o.baseColor == Spectrum(0.5f, 0.25f, 0));
        CHECK(o.alpha == 0.75f);
        CHECK(o.specularColor == Spectrum(0.5f, 0, 0));
        CHECK(o.glossiness == 0.25f);
        number = 0;
        for (const Slot& s : oldSlots) checkSlot(o.*s.slot, number++);
    }

    TEST_CASE("a picture that is not there is no direction") {
        const Folder folder("gone");
        Builder b =
            withMaterial({{"extensions",
                           {{"KHR_materials_clearcoat", {{"clearcoatNormalTexture", {{"index", 0}}}, {"clearcoatTexture", {{"index", 1}}}}},
                            {"KHR_materials_anisotropy", {{"anisotropyTexture", {{"index", 0}}}}}}}});
        b.root["images"] = {{{"uri", "gone.png"}}};
        Diagnostics notes;
        const MaterialDesc m = b.read(folder, notes, {MissingTexture::grey}).materials.at(0);
        CHECK(m.clearcoatNormalTexture.texture == -1);
        CHECK(m.anisotropyTexture.texture == -1);
        CHECK(m.clearcoatTexture.texture >= 0);
    }
}
