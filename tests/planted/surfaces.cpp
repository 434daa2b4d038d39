// Faults of textures, normals and opacity, against values that the glTF specification fixes.
#include "tests/planted/trial.h"
#include <numbers>

namespace chiaro::test {

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr float rho = 0.8f;

// A sun of pi lux that shines from a direction: a diffuse surface shows its reflectance times the cosine.
void addSun(SceneDesc& s, const Vec3d& from) {
    PunctualDesc sun;
    sun.kind = PunctualKind::directional;
    sun.intensity = Spectrum(float(pi64));
    sun.toWorld = shapes::lookAt(from, {0, 0, 0}, std::fabs(normalize(from).y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1});
    s.lights.push_back(sun);
}

void decoding(Trial& t) { // K1: byte 188 is .5029
    SceneDesc s;
    MaterialDesc m = shapes::diffuse("grey", Spectrum(1));
    const uint8_t texel[] = {188, 188, 188};
    m.baseColorTexture.texture = addTexture(s, 1, 1, 3, texel);
    const int material = shapes::add(s, m);
    shapes::add(s, "plate", plate({0, 0, 0}, {0, 1, 0}, 1), material);
    addSun(s, {0, 1, 0});
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), {4, 4}, .5028864580, "path", 1e-4);
}
void filtering(Trial& t) { // K3: half way between black and white is .5, in linear light
    SceneDesc s;
    const uint8_t texels[] = {0, 0, 0, 255, 255, 255};
    const int texture = addTexture(s, 2, 1, 3, texels);
    const auto scene = compiled(std::move(s));
    t.exact(double(scene->textures().lookup(texture, {0.5f, 0.5f}, Transfer::srgb).x), 0.5, 1e-6);
}
void greenUp(Trial& t) { // K5: green bends the normal up the picture, against +v
    SceneDesc s;
    MaterialDesc m = shapes::diffuse("bumpy", Spectrum(rho));
    const uint8_t texel[] = {128, 218, 218};
    m.normalTexture.texture = addTexture(s, 1, 1, 3, texel);
    const int material = shapes::add(s, m);
    shapes::add(s, "triangle", triangle({-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}), material);
    addSun(s, {0, -1, 1});
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, 0, -1}), {4, 4}, double(rho), "path", 1e-3);
}
// A plane y = x with its normals, stretched by (1, 2, -1): the normal becomes (-2, 1, 0) / sqrt 5.
void stretched(Trial& t) {
    SceneDesc s;
    const int material = shapes::add(s, shapes::diffuse("slope", Spectrum(rho)));
    PrimitiveDesc p = shapes::quad({-1, -1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, -1, -1});
    const float c = float(1 / std::sqrt(2.));
    p.normals.assign(p.positions.size(), Vec3{-c, c, 0});
    shapes::add(s, "slope", std::move(p), material, scaling(1, 2, -1));
    addSun(s, {0, 1, 0});
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), {4, 4}, double(rho) / std::sqrt(5.), "path", 1e-4);
}
void fromBehind(Trial& t) { // a double-sided sheet, seen and lit from its back
    SceneDesc s;
    const int material = shapes::add(s, shapes::diffuse("sheet", Spectrum(rho)));
    shapes::add(s, "sheet", plate({0, 0, 0}, {0, 1, 0}, 1), material);
    addSun(s, {0.5, -1, 0.2});
    const double cosine = 1 / std::sqrt(1.29);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0.1, 1, 0}), {4, 4}, double(rho) * cosine, "path", 1e-4);
}
void cutOff(Trial& t) { // glTF: alpha at the cut-off is opaque
    SceneDesc s;
    MaterialDesc m = shapes::diffuse("leaf", Spectrum(0));
    m.alphaMode = AlphaMode::mask;
    m.alpha = m.alphaCutoff = 0.5f;
    const int material = shapes::add(s, m);
    shapes::add(s, "leaf", plate({0, 0, 0}, {0, 1, 0}, 1), material);
    s.environment = uniformSky(1);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), {4, 4}, 0);
}
void blending(Trial& t) { // J4: a quarter of .4 over .8 is .7
    SceneDesc s;
    MaterialDesc m = shapes::lamp("veil", Spectrum(0.4f));
    m.alphaMode = AlphaMode::blend;
    m.alpha = 0.25f;
    const int veil = shapes::add(s, m), back = shapes::add(s, shapes::lamp("back", Spectrum(0.8f)));
    shapes::add(s, "veil", plate({0, 0, 0}, {0, 1, 0}, 1), veil);
    shapes::add(s, "back", plate({0, -1, 0}, {0, 1, 0}, 1), back);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), {32, 32}, 0.7);
}

const Check decodingCheck{"texel 188 (K1)", decoding, 16}, filteringCheck{"between two texels (K3)", filtering, 1},
    greenCheck{"normal map, green (K5)", greenUp, 16}, stretchedCheck{"normals under (1, 2, -1) (M7)", stretched, 16},
    behindCheck{"sheet from behind", fromBehind, 16}, cutOffCheck{"alpha at the cut-off", cutOff, 16},
    blendCheck{"a veil before a lamp (J4)", blending, 256};

const PlantedRow rows[] = {
    {Fault::baseColorNotDecoded, 19, "base colour read without its transfer function", decodingCheck},
    {Fault::filterBeforeDecode, 20, "texels filtered before they are decoded", filteringCheck},
    {Fault::normalGreenFlipped, 21, "green of a normal map points down", greenCheck},
    {Fault::normalsByMatrix, 22, "normals carried by the matrix of points", stretchedCheck},
    {Fault::backNormalKept, 23, "normal not turned on the back", behindCheck},
    {Fault::alphaCutoffOpen, 24, "alpha at the cut-off passes", cutOffCheck},
    {Fault::blendTwice, 25, "alpha multiplied twice", blendCheck},
};

} // namespace

std::span<const PlantedRow> plantedSurfaces() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-surfaces") {
    TEST_CASE("each planted fault of a surface is caught") { chiaro::test::catchAll(chiaro::test::plantedSurfaces()); }
} // TEST_SUITE
