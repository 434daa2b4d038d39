#include "core/scene/camera.h"
#include "core/scene/scene.h"

namespace chiaro {

Camera::Camera(const CameraDesc& c, uint32_t width, uint32_t height)
    : projection_(c.projection), width_(float(width)), height_(float(height)) {
    const Affine& m = c.toWorld;
    position_ = cast<float>(m.point(Vec3d{0, 0, 0}));
    // A camera has no scale: its axes are made orthonormal again, the viewing axis first (glTF 2.0, 3.10.1).
    const Vec3d back = normalize(m.vector(Vec3d{0, 0, 1})), upHint = m.vector(Vec3d{0, 1, 0});
    const Vec3d right = normalize(cross(upHint, back)), up = cross(back, right);
    axis_ = cast<float>(-back);
    right_ = cast<float>(right);
    up_ = cast<float>(up);
    const double aspect = double(width) / height;
    if (projection_ == Projection::perspective) {
        halfY_ = float(std::tan(c.yfov / 2));
        halfX_ = float(double(halfY_) * aspect);
        footprint_ = {0, float(2 * std::atan(double(halfY_) / height))};
    } else {
        halfX_ = float(c.xmag);
        halfY_ = float(c.ymag);
        // A picture of another aspect than the camera's shows more, never less, and does not stretch.
        const double own = c.xmag / c.ymag;
        if (aspect > own) halfX_ = float(c.ymag * aspect);
        if (aspect < own) halfY_ = float(c.xmag / aspect);
        footprint_ = {2 * halfY_ / float(height), 0};
    }
}

Ray Camera::ray(Point2 raster, Point2, float time) const noexcept {
    const float x = (2 * raster.x / width_ - 1) * halfX_, y = (1 - 2 * raster.y / height_) * halfY_;
    if (projection_ == Projection::perspective) return {position_, 0, normalize(axis_ + right_ * x + up_ * y), infinity, time};
    return {position_ + right_ * x + up_ * y, 0, axis_, infinity, time};
}

float Camera::depth(const Vec3& p) const noexcept { return dot(p - position_, axis_); }

CameraDesc frameScene(const Scene& scene, double aspect) {
    CameraDesc c;
    c.name = "auto";
    c.yfov = 0.6981317007977318; // 40 degrees
    const double narrow = std::min(1.0, aspect), half = std::atan(std::tan(c.yfov / 2) * narrow);
    const double distance = scene.radius() / std::sin(half) * 1.02;
    const Vec3d back = normalize(Vec3d{0.45, 0.35, 1.0}), right = normalize(cross(Vec3d{0, 1, 0}, back)), up = cross(back, right);
    const Vec3d eye = back * distance;
    const Vec3d axes[3] = {right, up, back};
    const double position[3] = {eye.x, eye.y, eye.z};
    for (int column = 0; column < 3; ++column) {
        c.toWorld.m[0][column] = axes[column].x;
        c.toWorld.m[1][column] = axes[column].y;
        c.toWorld.m[2][column] = axes[column].z;
    }
    for (int row = 0; row < 3; ++row) c.toWorld.m[row][3] = position[row];
    return c;
}

} // namespace chiaro
