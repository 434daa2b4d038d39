// Faults of the lens, of the importance that it emits, and of the particles that meet it.
#include "core/math/sampler.h"
#include "tests/planted/trial.h"
#include <numbers>

namespace chiaro::test {

namespace {

constexpr double pi64 = std::numbers::pi;

// Inside a closed sphere of emission 1 and reflectance 1/2 everything is 2, whatever finds it.
std::unique_ptr<const Scene> furnace() {
    SceneDesc s;
    PrimitiveDesc shell = shapes::insideOut(shapes::sphere(1, 3));
    shell.normals.clear();
    shapes::add(s, "wall", std::move(shell), shapes::add(s, shapes::lamp("wall", Spectrum(1), Spectrum(.5f))));
    return compiled(std::move(s));
}
void furnaceByLight(Trial& t) {
    t.equal(*furnace(), perspective({.1, .2, .3}, {-.4, .1, -.5}, 1.4), {8, 8, 16, {}, 1, 0, SamplerKind::sobol, FilterKind::box}, 2,
            "light");
}

// Half of the opening's area lies within 0.7071 of its radius.
void opening(Trial& t) {
    CameraDesc c;
    c.lens = {.1, 2};
    const Camera camera(c, 8, 8);
    const int side = 64;
    int inner = 0;
    for (int i = 0; i < side * side; ++i)
        inner += lengthSquared(camera.ray({4, 4}, {(float(i % side) + .5f) / side, (float(i / side) + .5f) / side}, 0).o) < .005f;
    t.exact(double(inner) / (side * side), .5, .03); // rings of a grid
}
// Rays of a corner meet on the plane of focus.
void planeOfFocus(Trial& t) {
    CameraDesc c;
    c.yfov = 1;
    c.lens = {.1, 2};
    const Camera camera(c, 8, 8);
    const auto meets = [&](Point2 lens) {
        const Ray r = camera.ray({0, 0}, lens, 0);
        return r.o + r.d * (2 / -r.d.z);
    };
    t.exact(double(length(meets({.1f, .5f}) - meets({.9f, .5f}))), 0, 1e-5);
}
// What a point lamp emits: 4 pi lumen a candela.
void flux(Trial& t) {
    SceneDesc s;
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 1), shapes::add(s, shapes::diffuse("floor", Spectrum(.5f))));
    s.lights.push_back({});
    const auto scene = compiled(std::move(s));
    const auto e = scene->lights().emit({.3, {.2f, .6f}}, {.7, {.1f, .9f}}, 0);
    t.exact(e ? double(e->flux[0]) : 0, 4 * pi64, 1e-4);
}
// Over a smooth-shaded surface the particle picture is that of the path tracer, of which the value is known here: a ball whose shading
// normals are all bent alike would be lit by |wi.ns| / |wi.ng| too much.
void bentNormals(Trial& t) {
    SceneDesc s;
    PrimitiveDesc floor = plate({0, 0, 0}, {0, 1, 0}, .5);
    floor.normals.assign(floor.positions.size(), Vec3{.6f, .8f, 0});
    shapes::add(s, "floor", std::move(floor), shapes::add(s, shapes::diffuse("floor", Spectrum(1))));
    PunctualDesc sun; // straight down: E = 1 lx, under the bent normal 0.8
    sun.kind = PunctualKind::directional;
    sun.toWorld = shapes::lookAt({0, 1, 0}, {0, 0, 0}, {0, 0, 1});
    s.lights = {sun};
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {.3, -1, 0}, 1, .2), {8, 8, 16, {}, 1, 0, SamplerKind::sobol, FilterKind::box},
            .8 / pi64, "light");
}

const Check furnaceCheck{"sphere furnace by light tracing (F1)", furnaceByLight, 1024}, openingCheck{"the lens is uniform", opening, 1},
    focusCheck{"the plane of focus (H11)", planeOfFocus, 1}, fluxCheck{"flux of a point lamp (G1)", flux, 1},
    bentCheck{"a matt floor with bent normals, by light tracing (F8)", bentNormals, 1024};

const PlantedRow rows[] = {
    {Fault::lensNotUniform, 0, "the lens is sampled uniformly in its radius", openingCheck},
    {Fault::focusAlongRay, 0, "focus measured along the ray, not the axis", focusCheck},
    {Fault::importanceCosine, 0, "a cosine of the pixel's solid angle missing in the importance", furnaceCheck},
    {Fault::emittedFluxBias, 0, "1 % too much flux emitted", fluxCheck},
    {Fault::adjointMissing, 0, "no correction for shading normals where importance travels", bentCheck},
};

} // namespace

std::span<const PlantedRow> plantedLens() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-lens") {
    TEST_CASE("each planted fault of a lens or of a particle is caught") { chiaro::test::catchAll(chiaro::test::plantedLens()); }
} // TEST_SUITE
