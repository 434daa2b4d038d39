// Camera: the view's ray for a raster position, and the importance it emits towards a point (for splatting light paths). Raster
// coordinates are pixels, (0, 0) the upper left corner of the picture, x to the right, y down; pixel (i, j) has its centre at (i + .5, j +
// .5).
#pragma once
#include "core/math/ray.h"
#include "core/scene/desc.h"
#include "core/scene/motion.h"
#include <optional>

namespace chiaro {

class Scene;
struct SurfacePoint;

// How a point is seen: a light path that ends there adds flux x f |cos| x importance to the mean of the pixels around `raster`, spread by
// the reconstruction filter.
struct CameraConnection {
    Point2 raster;        // not cut at the frame: a filter reaches over it
    Vec3 wi;              // from the point towards the lens
    float importance = 0; // draster / domega / distance^2 over the density of the lens point: 1/m2
    Ray shadow;           // trace it with Scene::occluded
};
// Where a light ray lands that goes through the opening of the lens by itself, unaimed: its flux x importance is its share of the mean of
// the pixels around `raster`.
struct CameraLanding {
    Point2 raster;
    float t = 0;          // metres along the ray to the opening
    float importance = 0; // draster / (dA cos domega), 1/m2
};

class Camera {
public:
    Camera() = default;
    // The view of a description on a picture of width x height pixels. Where the aspects differ, the vertical angle is kept.
    // shutter: that of the scene, which the camera's motion covers; a camera that rests needs none.
    Camera(const CameraDesc&, uint32_t width, uint32_t height, Interval shutter = {});
    // lens: uniform in the unit square, unused by a pinhole. The lens is that of an ideal thin lens: rays of all lens points through one
    // raster position meet on the plane of focus (Cook, Porter, Carpenter 1984).
    Ray ray(Point2 raster, Point2 lens, float time) const noexcept;
    // A pinhole in perspective that rests: its rays are nothing but arithmetic, for loops over many of them. All begin at position(), in
    // this direction; the same bits as ray().
    bool plain() const noexcept { return projection_ == Projection::perspective && !hasLens() && !moves(); }
    [[gnu::always_inline]] Vec3 plainDirection(Point2 raster) const noexcept {
        return normalize(towardsPlane({position_, axis_, right_, up_}, onPlane(raster)));
    }
    // The same pixel seen from a point of the scene, at the point's time; empty: behind the camera.
    std::optional<CameraConnection> importance(const SurfacePoint& from, Point2 lens) const noexcept;
    // Empty: the ray misses the opening, or comes from behind; always so for a pinhole.
    std::optional<CameraLanding> landing(const Ray&) const noexcept;
    bool hasLens() const noexcept { return lensRadius_ > 0; }
    LensDesc lens() const noexcept { return {double(lensRadius_), double(focus_), blades_, double(lensRotation_)}; }
    bool moves() const noexcept { return !motion_.keys().empty(); }
    Footprint footprint() const noexcept { return footprint_; } // of one pixel
    // Planar depth: the distance along the viewing axis; of a moving camera, as it stands when the shutter opens, like the two below.
    float depth(const Vec3& p) const noexcept;
    const Vec3& position() const noexcept { return position_; }
    const Vec3& axis() const noexcept { return axis_; }

private:
    Projection projection_ = Projection::perspective;
    Vec3 position_, axis_{0, 0, -1}, right_{1, 0, 0}, up_{0, 1, 0};
    float width_ = 1, height_ = 1, halfX_ = 1, halfY_ = 1; // half extents on the plane at distance 1
    Footprint footprint_;
    float lensRadius_ = 0, focus_ = 1, lensRotation_ = 0;
    int blades_ = 0;
    // Where it stands at a time.
    struct Pose {
        Vec3 position, axis, right, up;
    };
    Pose pose(float time) const noexcept;
    // A raster position on the plane at distance 1, and the way there from the middle of a perspective lens.
    [[gnu::always_inline]] Point2 onPlane(Point2 raster) const noexcept {
        return {(2 * raster.x / width_ - 1) * halfX_, (1 - 2 * raster.y / height_) * halfY_};
    }
    [[gnu::always_inline]] static Vec3 towardsPlane(const Pose& c, Point2 at) noexcept { return c.axis + c.right * at.x + c.up * at.y; }
    Motion motion_; // no keys: at rest
};

// A camera that shows all of the scene: three-quarter view from the front, slightly above, 40 degrees.
CameraDesc frameScene(const Scene&, double aspect);

} // namespace chiaro
