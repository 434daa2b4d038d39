// Scenes by hand for tests: build a SceneDesc from the shapes of scenes/shapes.h, compile it, ask it, render a view of it with any
// integrator of the registry and read means. A scene is recentred when it is compiled: world() and local() translate.
#pragma once
#include "core/render/integrator.h"
#include "core/render/render.h"
#include "core/scene/scene.h"
#include "integrators/registry.h"
#include "materials/closure_table.h"
#include "scenes/shapes.h"
#include <memory>
#include <string>

namespace chiaro::test {

inline std::unique_ptr<const Scene> compiled(SceneDesc desc, const std::string& isa = {}) {
    Diagnostics notes;
    return Scene::compile(std::move(desc), notes, isa, nullptr, ClosureTable::make);
}
// A position of the description in the compiled scene.
inline Vec3 local(const Scene& scene, const Vec3d& world) { return cast<float>(world - scene.centre()); }

// A surface point that lies on nothing: to ask the lights what they send there.
inline SurfacePoint receiver(const Scene& scene, const Vec3d& world, const Vec3& normal) {
    SurfacePoint s;
    s.p = local(scene, world);
    s.ng = s.ns = normalize(normal);
    return s;
}
inline Ray rayFrom(const Vec3& o, const Vec3& d) { return {o, 0, normalize(d), infinity, 0}; }

// A single triangle, front counter-clockwise.
inline PrimitiveDesc triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    PrimitiveDesc p;
    p.positions = {a, b, c};
    p.uv[0] = {{0, 0}, {1, 0}, {0, 1}};
    p.indices = {0, 1, 2};
    return p;
}
// The square of a half extent about the origin in the plane z = 0, front towards +z.
inline PrimitiveDesc square(double half) { return shapes::quad({-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}); }

inline Affine scaling(double x, double y, double z) {
    Affine m;
    m.m[0][0] = x;
    m.m[1][1] = y;
    m.m[2][2] = z;
    return m;
}
// Rotation by an angle about an axis (Rodrigues 1840).
inline Affine rotation(Vec3d axis, double angle) {
    axis = normalize(axis);
    const double s = std::sin(angle), c = std::cos(angle), k = 1 - c;
    const double a[3] = {axis.x, axis.y, axis.z};
    const double cross[3][3] = {{0, -axis.z, axis.y}, {axis.z, 0, -axis.x}, {-axis.y, axis.x, 0}};
    Affine m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m.m[i][j] = (i == j ? c : 0) + k * a[i] * a[j] + s * cross[i][j];
    return m;
}
// Puts a mesh into the scene under several nodes: it is instanced.
inline void addInstances(SceneDesc& scene, PrimitiveDesc shape, int material, std::span<const Affine> places) {
    shape.material = material;
    scene.meshes.push_back({"mesh", {std::move(shape)}});
    for (const Affine& m : places) scene.instances.push_back({int(scene.meshes.size()) - 1, m, "node"});
}

// Pictures from numbers: u8 texels, row by row from the top.
inline int addTexture(SceneDesc& scene, int width, int height, int channels, std::span<const uint8_t> texels, TextureDesc how = {}) {
    ImageDesc image;
    image.width = width;
    image.height = height;
    image.channels = channels;
    for (const uint8_t t : texels) image.pixels.push_back(std::byte(t));
    scene.images.push_back(std::move(image));
    how.image = int(scene.images.size()) - 1;
    scene.textures.push_back(how);
    return int(scene.textures.size()) - 1;
}
// An environment of radiance value(column, row).
template <class F> EnvironmentDesc environment(int width, int height, F value, TextureFilter filter = TextureFilter::nearest) {
    EnvironmentDesc e;
    e.filter = filter;
    e.image.width = width;
    e.image.height = height;
    e.image.channels = 3;
    e.image.type = PixelType::f32;
    std::vector<float> rgb;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Spectrum s = value(x, y);
            rgb.insert(rgb.end(), {s[0], s[1], s[2]});
        }
    const auto* bytes = reinterpret_cast<const std::byte*>(rgb.data());
    e.image.pixels.assign(bytes, bytes + rgb.size() * sizeof(float));
    return e;
}
inline EnvironmentDesc uniformSky(float radiance) {
    return environment(1, 1, [radiance](int, int) { return Spectrum(radiance); });
}

struct Settings {
    uint32_t width = 32, height = 32, spp = 16;
    Rect crop{}; // empty: all
    unsigned threads = 1;
    uint64_t seed = 0;
    SamplerKind sampler = SamplerKind::sobol;
    FilterKind filter = FilterKind::box;
    uint32_t maxDepth = unlimitedDepth;
};

// One view of a scene and all that a Job points to.
class Bench {
public:
    Bench(const Scene& scene, const CameraDesc& camera, const Settings& s)
        : settings(s), classes(s.maxDepth), run(s.threads),
          view{Camera(camera, s.width, s.height, scene.shutter()),     s.width,          s.height,
               s.crop.area() ? s.crop : Rect{0, 0, s.width, s.height}, Filter(s.filter), scene.shutter()},
          job{{scene, classes, view.shutter, s.seed, s.sampler, run, stop, progress, notes}, view} {}
    Bench(const Bench&) = delete;
    FilmLayout layout() const { return {view.width, view.height, view.crop, {}, false}; }
    // Renders settings.spp samples a pixel onto the film, from where it stands.
    void render(Film& film, const std::string& integrator = "path") {
        const IntegratorChoice choice = chooseIntegrator(integrator);
        chiaro::render(job, *choice.entry->make(choice.options), film, {settings.spp, infinity}, stop);
    }

    Settings settings;
    PathClasses classes;
    Executor run;
    StopToken stop;
    Progress progress;
    Diagnostics notes;
    View view;
    Job job;
};

struct Rendering {
    std::unique_ptr<Film> film;
    Spectrum mean{0}; // over the crop
};
inline Spectrum meanOf(const Film& film) {
    const Rect c = film.layout().crop;
    Rgb<double> sum(0);
    for (uint32_t y = c.y0; y < c.y1; ++y)
        for (uint32_t x = c.x0; x < c.x1; ++x) {
            const Spectrum m = film.mean({x, y});
            sum += {double(m[0]), double(m[1]), double(m[2])};
        }
    const double n = double(c.area());
    return {float(sum[0] / n), float(sum[1] / n), float(sum[2] / n)};
}
inline Rendering rendered(const Scene& scene, const CameraDesc& camera, const Settings& s, const std::string& integrator = "path") {
    Bench bench(scene, camera, s);
    Rendering r;
    FilmLayout layout = bench.layout();
    const IntegratorChoice choice = chooseIntegrator(integrator);
    layout.splats = choice.entry->traits(choice.options).splats;
    r.film = std::make_unique<Film>(layout);
    bench.render(*r.film, integrator);
    r.mean = meanOf(*r.film);
    return r;
}
// The same samples kept and the same bits in every pixel, both halves.
inline bool samePicture(const Film& a, const Film& b) {
    const Rect c = a.layout().crop;
    if (!(c == b.layout().crop)) return false;
    for (uint32_t y = c.y0; y < c.y1; ++y)
        for (uint32_t x = c.x0; x < c.x1; ++x) {
            const Pixel p{x, y};
            if (a.count(p) != b.count(p) || a.next(p) != b.next(p) || !(a.mean(p) == b.mean(p))) return false;
            if (!(a.halfMean(p, Half::even) == b.halfMean(p, Half::even)) || !(a.halfMean(p, Half::odd) == b.halfMean(p, Half::odd)))
                return false;
            for (const Aov v : {Aov::albedo, Aov::normal})
                if (!(a.aov(p, v) == b.aov(p, v))) return false;
        }
    return true;
}

} // namespace chiaro::test
