#include "tools/cli/lens.h"
#include "core/render/error.h"
#include "core/scene/camera.h"
#include "core/scene/scene.h"
#include "tools/cli/console.h"
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

constexpr double sensorHalfHeight = 0.012; // metres: full frame, 36 mm x 24 mm
constexpr double mostDiameter = 1000, leastFocus = 1e-6, mostFocus = 1e9;

double focalLength(const CameraDesc& camera) { return sensorHalfHeight / std::tan(camera.yfov / 2); }

bool isPixel(const std::string& focus) { return focus.find(',') != std::string::npos; }

// Planar depth of what the raster position sees through a pinhole; infinity: nothing.
float depthAt(const CameraDesc& desc, const Scene& scene, Size size, Point2 raster, float time) {
    CameraDesc pinhole = desc;
    pinhole.lens = {};
    const Camera camera(pinhole, size.width, size.height, scene.shutter());
    const Ray ray = camera.ray(raster, {0.5f, 0.5f}, time);
    const Hit hit = scene.intersect(ray);
    return hit ? camera.depth(ray.o + ray.d * hit.t) : infinity;
}

} // namespace

LensRequest readLens(const Arguments& a) {
    LensRequest r;
    for (const char* option : {"focus", "blades"})
        if (a.given(option) && !a.given("aperture"))
            throw Error(Exit::usage,
                        fmt::format("--{}: a pinhole sees everything sharp; add --aperture, such as --aperture f/2.8", option));
    const std::string aperture = a.text("aperture");
    if (aperture.empty()) return r;
    if (aperture.starts_with("f/"))
        r.fNumber = parseReal("aperture", aperture.substr(2), 0.01, 1e6);
    else
        r.diameter = parseReal("aperture", aperture, 0, mostDiameter);
    if (a.given("focus")) r.focus = a.text("focus");
    if (r.focus != "auto" && !isPixel(r.focus)) parseReal("focus", r.focus, leastFocus, mostFocus);
    if (!a.given("blades")) return r;
    const std::string blades = a.text("blades");
    const std::size_t colon = blades.find(':');
    r.blades = int(parseWhole("blades", blades.substr(0, colon), 3, 64));
    if (colon != std::string::npos) r.rotation = parseReal("blades", blades.substr(colon + 1), -360, 360) * std::numbers::pi / 180;
    return r;
}

LensDesc chooseLens(const LensRequest& r, const CameraDesc& camera, const Scene& scene, Size size, float time) {
    LensDesc lens;
    if (!r) return lens;
    if (r.fNumber && camera.projection == Projection::orthographic)
        throw Error(Exit::usage,
                    fmt::format("--aperture f/{:g}: an orthographic camera has no focal length to divide; give the diameter in "
                                "metres, such as --aperture 0.05",
                                *r.fNumber));
    lens.radius = (r.fNumber ? focalLength(camera) / *r.fNumber : *r.diameter) / 2;
    lens.blades = r.blades;
    lens.rotation = r.rotation;
    if (r.focus != "auto" && !isPixel(r.focus)) {
        lens.focus = parseReal("focus", r.focus, leastFocus, mostFocus);
        return lens;
    }
    Point2 raster{float(size.width) / 2, float(size.height) / 2};
    if (isPixel(r.focus)) {
        const Pixel p = parsePixel("focus", r.focus, size);
        raster = {float(p.x) + 0.5f, float(p.y) + 0.5f};
    }
    lens.focus = double(depthAt(camera, scene, size, raster, time));
    if (std::isfinite(lens.focus) && lens.focus > 0) return lens;
    if (isPixel(r.focus))
        throw Error(Exit::usage, fmt::format("--focus {}: this pixel sees no surface; give another one, or metres", r.focus));
    // The middle of the scene is the compiled scene's origin.
    const double middle = double(Camera(camera, size.width, size.height).depth({0, 0, 0}));
    lens.focus = middle > 0 ? middle : double(scene.radius());
    return lens;
}

void tellLens(const LensRequest& r, const LensDesc& lens, const Console& console) {
    if (!r) return;
    std::string text = fmt::format("{:.4g} mm{}", 2000 * lens.radius, r.fNumber ? fmt::format(" (f/{:g})", *r.fNumber) : "");
    if (r.blades) text += fmt::format(", {} blades", r.blades);
    text += fmt::format(", focus {:.4g} m", lens.focus);
    const bool seen = r.focus == "auto" || isPixel(r.focus);
    if (seen) text += fmt::format(" ({})      keep it with: --focus {:.6g}", r.focus == "auto" ? r.focus : "pixel " + r.focus, lens.focus);
    console.phase("lens", text);
}

} // namespace chiaro::cli
