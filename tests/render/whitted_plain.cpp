// Plain surfaces are answered in lanes, everything else and every path that is logged by the general way: both must give the same bits.
#include "tests/render/whitted_kit.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

// Walls, a mirror, a polished block, a lamp of a mesh, a bulb, and lamps without a body.
SceneDesc room(bool bodies) {
    SceneDesc d;
    MaterialDesc mirror;
    mirror.name = "mirror";
    mirror.baseColor = Spectrum(0.9f, 0.8f, 0.7f);
    mirror.metallic = 1;
    mirror.roughness = 0;
    MaterialDesc polished;
    polished.name = "polished";
    polished.baseColor = Spectrum(0.3f, 0.5f, 0.4f);
    polished.metallic = 0;
    polished.roughness = 0.3f;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.6f, 0.5f, 0.4f))), metal = shapes::add(d, mirror),
              black = shapes::add(d, shapes::diffuse("black", Spectrum(0))), coat = shapes::add(d, polished),
              lamp = shapes::add(d, shapes::lamp("lamp", Spectrum(9, 8, 7)));
    shapes::add(d, "room", shapes::insideOut(shapes::box({2, 2, 2})), grey);
    shapes::add(d, "mirror", square(0.8), metal, shapes::translation({-0.9, -0.4, -1.2}));
    shapes::add(d, "black", square(0.4), black, shapes::translation({0.9, 0.6, -1.5}));
    shapes::add(d, "block", shapes::box({0.4, 0.7, 0.3}), coat, shapes::translation({0.8, -1, -0.6}));
    shapes::add(d, "ball", shapes::sphere(0.4, 2), grey, shapes::translation({0.1, -1.2, 0.2}));
    if (bodies) {
        shapes::add(d, "lamp", square(0.5), lamp, shapes::translation({0, 1.9, 0}) * rotation({1, 0, 0}, std::numbers::pi / 2));
        shapes::add(d, "bulb", shapes::sphere(0.1, 1), lamp, shapes::translation({1.2, 1, 0.3}));
    } else {
        d.lights.push_back(pointLight({0.5, 1.5, 0.5}, Spectrum(3, 2, 1)));
        PunctualDesc sun;
        sun.kind = PunctualKind::directional;
        sun.intensity = Spectrum(0.5f);
        d.lights.push_back(sun);
    }
    shapes::addCamera(d, "main", 0.9, shapes::translation({0, 0, 1.9}));
    return d;
}

} // namespace

TEST_SUITE("whitted-plain") {

    TEST_CASE("the picture of the lanes is the sum of trees that are logged one by one") {
        for (const bool bodies : {true, false}) {
            const auto scene = compiled(room(bodies));
            for (const char* text : {"whitted", "whitted:attenuation=classic,ambient=0.2", "whitted:shadows=none", "whitted:shadows=opaque",
                                     "whitted:glossy=mirror,fresnel=schlick", "whitted:ray-falloff=on", "whitted:aa=grid,aa-samples=4"}) {
                for (const uint32_t depth : {0u, 1u, 4u}) {
                    CAPTURE(std::string(text));
                    CAPTURE(bodies);
                    CAPTURE(depth);
                    Settings s{24, 20, 3};
                    s.filter = FilterKind::blackmanHarris;
                    s.maxDepth = depth;
                    Bench bench(*scene, scene->cameras()[0], s);
                    const IntegratorChoice choice = chooseIntegrator(text);
                    const auto made = choice.entry->make(choice.options);
                    made->prepare(bench.job);
                    auto& whitted = dynamic_cast<CameraIntegrator&>(*made);
                    Film lanes(bench.layout()), trees(bench.layout());
                    uint64_t rays = 0;
                    int wrong = 0;
                    forEachBatch(
                        bench.job, {0, 3, nullptr}, lanes,
                        [&](std::span<PathStart> p, std::span<Outputs> o) {
                            whitted.radianceWide(bench.job, p, o);
                            for (std::size_t i = 0; i < p.size(); ++i) {
                                PathLog log;
                                Outputs out(bench.layout());
                                out.log = &log;
                                PathStart again = startPixel(bench.job, p[i].pixel, p[i].sample, whitted.starts(bench.job));
                                whitted.radiance(bench.job, again, out);
                                rays += out.rays;
                                wrong += !(out.total() == o[i].total()) || out.rays != o[i].rays || out.depth != o[i].depth ||
                                         !(out.aovs[0] == o[i].aovs[0]) || !(out.aovs[1] == o[i].aovs[1]);
                            }
                        },
                        whitted.starts(bench.job));
                    CHECK(wrong == 0);
                    if (depth > 0 && std::string_view(text) == "whitted") CHECK(rays > 24 * 20 * 3);
                }
            }
        }
    }
}
