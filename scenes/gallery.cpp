// What materials can do, as a sheet of balls: each row one lobe, each column one step of its roughness or strength. Behind them a striped
// wall, for glass to bend; around them a dim sky with soft boxes, for everything else to mirror. Figures: scenes/gallery.md.
#include "scenes/scenes.h"
#include "scenes/shapes.h"
#include <cmath>
#include <cstring>
#include <numbers>

namespace chiaro {
namespace {

constexpr int columns = 6;
constexpr double pitch = 1.1, radius = 0.47;

struct Row {
    const char* name;
    MaterialDesc (*make)(int column);
    bool lit = false; // with a small lamp inside
};

MaterialDesc named(const char* name, int column) {
    MaterialDesc m;
    m.name = std::string(name) + " " + std::to_string(column + 1);
    m.metallic = 0;
    return m;
}

MaterialDesc roughMetal(int k) {
    MaterialDesc m = named("metal", k);
    m.metallic = 1;
    m.baseColor = {1, 0.766f, 0.336f};
    constexpr float roughness[columns] = {0.05f, 0.2f, 0.4f, 0.6f, 0.8f, 1};
    m.roughness = roughness[k];
    return m;
}
MaterialDesc roughGlass(int k) {
    MaterialDesc m = named("glass", k);
    m.transmission = 1;
    m.volume = true;
    constexpr float roughness[columns] = {0, 0.1f, 0.2f, 0.35f, 0.5f, 0.8f};
    m.roughness = roughness[k];
    return m;
}
MaterialDesc clearcoat(int k) {
    MaterialDesc m = named("clearcoat", k);
    m.baseColor = {0.55f, 0.03f, 0.03f};
    m.metallic = 0.6f;
    m.roughness = 0.5f;
    constexpr float strength[columns] = {0, 0.5f, 1, 1, 1, 1}, roughness[columns] = {0, 0, 0, 0.1f, 0.3f, 0.6f};
    m.clearcoat = strength[k];
    m.clearcoatRoughness = roughness[k];
    return m;
}
MaterialDesc sheen(int k) {
    MaterialDesc m = named("sheen", k);
    m.baseColor = {0.06f, 0.02f, 0.12f};
    m.specular = 0;
    constexpr float roughness[columns] = {0, 0.15f, 0.3f, 0.5f, 0.75f, 1};
    if (k > 0) m.sheenColor = {0.9f, 0.75f, 1};
    m.sheenRoughness = roughness[k];
    return m;
}
MaterialDesc brushed(int k) {
    MaterialDesc m = named("anisotropy", k);
    m.metallic = 1;
    m.baseColor = Spectrum{0.85f};
    m.roughness = 0.3f;
    constexpr float strength[columns] = {0, 0.4f, 0.7f, 1, 1, 1}, turn[columns] = {0, 0, 0, 0, 0.25f, 0.5f};
    m.anisotropy = strength[k];
    m.anisotropyRotation = turn[k] * std::numbers::pi_v<float>;
    return m;
}
MaterialDesc film(int k) {
    MaterialDesc m = named("iridescence", k);
    const bool onMetal = k > 3;
    m.baseColor = onMetal ? Spectrum{0.6f} : Spectrum{0.01f};
    m.metallic = onMetal ? 1.f : 0.f;
    m.roughness = 0.15f;
    constexpr float thickness[columns] = {180, 280, 380, 520, 280, 420};
    m.iridescence = 1;
    m.iridescenceIor = 1.9f;
    m.iridescenceMax = thickness[k];
    return m;
}
MaterialDesc dispersed(int k) {
    MaterialDesc m = named("dispersion", k);
    m.transmission = 1;
    m.volume = true;
    m.roughness = 0;
    constexpr float dispersion[columns] = {0, 0.5f, 1, 2, 4, 8};
    m.dispersion = dispersion[k];
    return m;
}
MaterialDesc lantern(int k) {
    MaterialDesc m = named("diffuse transmission", k);
    m.baseColor = {0.25f, 0.55f, 0.12f};
    m.diffuseTransmissionColor = {0.75f, 0.85f, 0.2f};
    m.diffuseTransmission = float(k) / (columns - 1);
    m.specular = 0;
    return m;
}

// A ball whose tangents run around its axis, which brushes follow.
PrimitiveDesc turned(double r, int subdivisions) {
    PrimitiveDesc p = shapes::sphere(r, subdivisions);
    for (const Vec3& n : p.normals) {
        const Vec3 t{n.z, 0, -n.x};
        const float l = length(t);
        p.tangents.push_back(l > 1e-5f ? Vec4{t.x / l, 0, t.z / l, 1} : Vec4{1, 0, 0, 1});
    }
    return p;
}

int stripes(SceneDesc& s) {
    ImageDesc image;
    image.name = "stripes";
    image.width = 2;
    image.height = 1;
    image.channels = 3;
    for (const uint8_t tone : {200, 60})
        for (int c = 0; c < 3; ++c) image.pixels.push_back(std::byte(tone));
    s.images.push_back(std::move(image));
    TextureDesc texture;
    texture.image = int(s.images.size()) - 1;
    texture.filter = TextureFilter::nearest;
    s.textures.push_back(texture);
    MaterialDesc m = shapes::diffuse("stripes", Spectrum{1});
    m.baseColorTexture.texture = int(s.textures.size()) - 1;
    m.baseColorTexture.transform[0][0] = 24;
    return shapes::add(s, std::move(m));
}

// A grey dome, darker below, with a bright box to the left, a narrow one to the right and a wide one above.
EnvironmentDesc studio() {
    constexpr int width = 128, height = 64;
    std::vector<float> pixels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double around = 2 * std::numbers::pi * ((x + 0.5) / width - 0.5), down = std::numbers::pi * (y + 0.5) / height;
            const Vec3d d{std::sin(down) * std::cos(around), std::cos(down), std::sin(down) * std::sin(around)};
            const double dome = 0.18 + 0.22 * (d.y + 1) / 2;
            const bool left = d.z > 0.3 && d.x < -0.45 && d.x > -0.8 && std::fabs(d.y - 0.25)<0.35, right = d.z> 0.2 && d.x > 0.72 &&
                              d.x < 0.86 && std::fabs(d.y)<0.5, above = d.y> 0.8 && d.z > 0;
            const double light = left ? 6 : right ? 8 : above ? 4 : dome;
            pixels.insert(pixels.end(), {float(light), float(light), float(light * (left ? 0.92 : 1.04))});
        }
    EnvironmentDesc sky;
    sky.image.name = "studio";
    sky.image.width = width;
    sky.image.height = height;
    sky.image.channels = 3;
    sky.image.type = PixelType::f32;
    sky.image.pixels.resize(pixels.size() * sizeof(float));
    std::memcpy(sky.image.pixels.data(), pixels.data(), sky.image.pixels.size());
    return sky;
}

} // namespace

SceneDesc makeGallery() {
    using namespace shapes;
    SceneDesc s;
    s.name = "@gallery";
    const Row rows[] = {{"metal", roughMetal},   {"glass", roughGlass}, {"clearcoat", clearcoat},  {"sheen", sheen},
                        {"anisotropy", brushed}, {"iridescence", film}, {"dispersion", dispersed}, {"diffuse transmission", lantern, true}};
    constexpr int count = int(std::size(rows));
    const int wall = stripes(s), light = add(s, lamp("bulb", Spectrum{40, 34, 26}));
    const double w = pitch * columns / 2 + 4, h = pitch * count / 2 + 4;
    add(s, "wall", quad({-w, -h, -1.1}, {w, -h, -1.1}, {w, h, -1.1}, {-w, h, -1.1}), wall);
    for (int row = 0; row < count; ++row)
        for (int k = 0; k < columns; ++k) {
            const Vec3d at{pitch * (k - (columns - 1) / 2.0), pitch * ((count - 1) / 2.0 - row), 0};
            const MaterialDesc m = rows[row].make(k);
            const std::string name = m.name;
            add(s, name, turned(radius, 4), add(s, m), translation(at));
            if (rows[row].lit) add(s, "bulb " + std::to_string(k + 1), sphere(0.09, 3), light, translation(at));
        }
    s.environment = studio();
    addCamera(s, "main", 2 * std::atan(pitch * (count + 0.3) / 2 / 20), lookAt({0, 0, 20}, {0, 0, 0}));
    return s;
}

} // namespace chiaro
