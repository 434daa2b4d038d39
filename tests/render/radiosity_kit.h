// What the tests of radiosity share: solving a scene without a view of it, and asking for the irradiance at a place.
#pragma once
#include "integrators/radiosity/field.h"
#include "integrators/radiosity/solve.h"
#include "tests/render/measure.h"
#include "tests/work_kit.h"
#include <memory>
#include <vector>

namespace chiaro::test {

// Relative to the larger of the two alone; doctest's own adds 1 to it.
inline doctest::Approx near(double expected, double relative) { return doctest::Approx(expected).epsilon(relative).scale(0); }

struct Solved {
    radiosity::Patches patches;
    radiosity::Solution solution;
    double patchSeconds = 0;
};

class RadiosityBench : public Bare {
public:
    using Bare::Bare;
    Solved solve(const radiosity::PatchSettings& cut, const radiosity::SolveSettings& how) const {
        Solved s;
        s.patches = radiosity::Patches::of(work, cut);
        s.solution = radiosity::solve(work, s.patches, how);
        CHECK(s.solution.complete);
        return s;
    }
    // The patch that is seen from `from` along `direction`, in coordinates of the description.
    uint32_t seen(const radiosity::Patches& patches, const Vec3d& from, const Vec3d& direction) const {
        const Vec3 d = normalize(cast<float>(direction));
        const Hit hit = scene.intersect(rayFrom(local(scene, from), d));
        REQUIRE(hit);
        const uint32_t patch = patches.seen(hit, d);
        REQUIRE(patch != ~0u);
        return patch;
    }
};

// Mean over area of what is asked of each patch that `counts` lets count.
template <class Counts, class Value> double meanOver(const radiosity::Patches& patches, Counts counts, Value value) {
    double sum = 0, area = 0;
    for (uint32_t i = 0; i < patches.size(); ++i)
        if (counts(patches[i])) {
            sum += value(i) * double(patches[i].area);
            area += double(patches[i].area);
        }
    return area > 0 ? sum / area : 0;
}
inline double radiosityOf(const Solved& s, uint32_t i) {
    const radiosity::Patch& p = s.patches[i];
    return double(luminance(p.emission)) + double(luminance(p.reflectance)) * luminance(s.solution.irradiance(i));
}

// A camera of the description, in the space of the compiled scene.
inline CameraDesc recentred(const Scene& scene, CameraDesc c) {
    const Vec3d o = scene.centre();
    for (int i = 0; i < 3; ++i) c.toWorld.m[i][3] -= i == 0 ? o.x : i == 1 ? o.y : o.z;
    return c;
}

// Picture means of the paths L D^k E for k of 0 ... most, and of all of them.
inline std::vector<double> byBounce(const Scene& scene, const CameraDesc& camera, const Settings& how, uint32_t most,
                                    const std::string& integrator) {
    Bench bench(scene, camera, how);
    PathQuery query;
    query.paths = "L D* E";
    query.split = "bounces";
    const PathClasses classes = PathClasses::make(query);
    FilmLayout layout = bench.layout();
    layout.layers = classes.layerNames();
    Film film(layout);
    const Job job{{scene, classes, bench.view.shutter, 0, SamplerKind::sobol, bench.run, bench.stop, bench.progress, bench.notes},
                  bench.view};
    const IntegratorChoice i = chooseIntegrator(integrator);
    chiaro::render(job, *i.entry->make(i.options), film, {how.spp, infinity}, bench.stop);
    std::vector<double> means(most + 2, 0);
    for (uint32_t y = 0; y < how.height; ++y)
        for (uint32_t x = 0; x < how.width; ++x)
            for (uint32_t k = 0; k < layout.layers.size(); ++k) {
                const double v = double(luminance(film.mean({x, y}, int(k)))) / double(how.width * how.height);
                if (k > 0 && k <= most + 1) means[k - 1] += v;
                means.back() += v;
            }
    return means;
}

inline PrimitiveDesc unitFace(int axis, int side) {
    Vec3d centre, normal;
    (axis == 0 ? centre.x : axis == 1 ? centre.y : centre.z) = 0.5 * side;
    (axis == 0 ? normal.x : axis == 1 ? normal.y : normal.z) = -side;
    return plate(centre, normal, 0.5);
}
// The closed cube of rows A13 and A16: the ceiling shines with E = 1 (radiance 1 / pi).
inline SceneDesc emittingCube(float rho) {
    SceneDesc s;
    const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(float(1 / std::numbers::pi)), Spectrum(rho))),
              wall = shapes::add(s, shapes::diffuse("wall", Spectrum(rho)));
    for (int axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1}) shapes::add(s, "face", unitFace(axis, side), axis == 1 && side == 1 ? lamp : wall);
    return s;
}

} // namespace chiaro::test
