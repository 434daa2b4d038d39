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

// A camera with its lens closed, in the middle of the shutter: where a picture with motion is sharp.
class Pinhole {
public:
    Pinhole(CameraDesc desc, const Scene& scene, Size size) : scene_(scene), middle_{float(size.width) / 2, float(size.height) / 2} {
        desc.lens = {};
        camera_ = Camera(desc, size.width, size.height, scene.shutter());
        axis_ = along(middle_);
    }
    Point2 middle() const noexcept { return middle_; }
    float depth(const Vec3& p) const noexcept { return dot(p - axis_.o, axis_.d); } // planar
    // Of what the raster position sees; infinity: nothing.
    float depthAt(Point2 raster) const {
        const Ray ray = along(raster);
        const Hit hit = scene_.intersect(ray);
        return hit ? depth(ray.o + ray.d * hit.t) : infinity;
    }

private:
    Ray along(Point2 raster) const {
        const Interval shutter = scene_.shutter();
        return camera_.ray(raster, {0.5f, 0.5f}, shutter.open + (shutter.close - shutter.open) / 2);
    }
    const Scene& scene_;
    Point2 middle_;
    Camera camera_;
    Ray axis_;
};

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

LensDesc chooseLens(const LensRequest& r, const CameraDesc& camera, const Scene& scene, Size size) {
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
    const Pinhole pinhole(camera, scene, size);
    Point2 raster = pinhole.middle();
    if (isPixel(r.focus)) {
        const Pixel p = parsePixel("focus", r.focus, size);
        raster = {float(p.x) + 0.5f, float(p.y) + 0.5f};
    }
    lens.focus = double(pinhole.depthAt(raster));
    if (std::isfinite(lens.focus) && lens.focus > 0) return lens;
    if (isPixel(r.focus))
        throw Error(Exit::usage, fmt::format("--focus {}: this pixel sees no surface; give another one, or metres", r.focus));
    // The middle of the scene is the compiled scene's origin.
    const double middle = double(pinhole.depth({0, 0, 0}));
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
