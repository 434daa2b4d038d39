#include "core/scene/camera.h"
#include "core/math/warp.h"
#include "core/render/fault.h"
#include "core/scene/scene.h"

namespace chiaro {

namespace {

// A camera has no scale: its axes are made orthonormal again, the viewing axis first (glTF 2.0, 3.10.1).
Affine orthonormal(const Affine& m) noexcept {
    const Vec3d back = normalize(m.vector(Vec3d{0, 0, 1})), right = normalize(cross(m.vector(Vec3d{0, 1, 0}), back)),
                up = cross(back, right);
    const Vec3d axes[4] = {right, up, back, m.point(Vec3d{0, 0, 0})};
    Affine frame;
    for (int j = 0; j < 4; ++j) {
        frame.m[0][j] = axes[j].x;
        frame.m[1][j] = axes[j].y;
        frame.m[2][j] = axes[j].z;
    }
    return frame;
}

// Uniform over the opening of radius 1, corners of a polygon on that circle; x to the right, y up.
Point2 lensPoint(Point2 u, int blades, float rotation) noexcept {
    if (fault(Fault::lensNotUniform)) return {u.x * std::cos(2 * pi * u.y), u.x * std::sin(2 * pi * u.y)};
    if (blades < 3) return concentricDisk(u);
    // One of the equal triangles between the centre and two corners, and a point in it. The first corner is at the top; seen from the
    // scene, counter-clockwise begins towards our right.
    const float wedge = std::floor(u.x * float(blades)), step = 2 * pi / float(blades), angle = rotation + wedge * step;
    const Point2 b = uniformTriangle(Point2{min(u.x * float(blades) - wedge, oneMinusEpsilon), u.y});
    return {b.x * std::sin(angle) + b.y * std::sin(angle + step), b.x * std::cos(angle) + b.y * std::cos(angle + step)};
}

// The area of that opening, and whether it holds a point.
float lensArea(int blades) noexcept { return blades < 3 ? pi : float(blades) / 2 * std::sin(2 * pi / float(blades)); }
bool lensHolds(Point2 p, int blades, float rotation) noexcept {
    if (blades < 3) return p.x * p.x + p.y * p.y < 1;
    // In the wedge where it lies, below the edge between the two corners.
    const float step = 2 * pi / float(blades), turn = (std::atan2(p.x, p.y) - rotation) / step, within = turn - std::floor(turn) - 0.5f;
    return std::hypot(p.x, p.y) * std::cos(within * step) < std::cos(step / 2);
}

} // namespace

Camera::Camera(const CameraDesc& c, uint32_t width, uint32_t height, Interval shutter)
    : projection_(c.projection), width_(float(width)), height_(float(height)), lensRadius_(float(c.lens.radius)),
      focus_(float(c.lens.focus)), lensRotation_(float(c.lens.rotation)), blades_(c.lens.blades) {
    const Affine m = orthonormal(c.toWorld);
    const auto column = [&m](int j) { return Vec3d{m.m[0][j], m.m[1][j], m.m[2][j]}; };
    position_ = cast<float>(column(3));
    right_ = cast<float>(column(0));
    up_ = cast<float>(column(1));
    axis_ = cast<float>(-column(2));
    if (c.motion.size() > 1 && shutter.close > shutter.open) {
        std::vector<Affine> frames;
        for (const Affine& frame : c.motion) frames.push_back(orthonormal(frame));
        motion_ = Motion(frames, shutter);
    }
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

Camera::Pose Camera::pose(float time) const noexcept {
    if (!moves()) return {position_, axis_, right_, up_};
    const AffineT<float> m = motion_.at(time);
    return {m.point(Vec3{}), m.vector(Vec3{0, 0, -1}), m.vector(Vec3{1, 0, 0}), m.vector(Vec3{0, 1, 0})};
}

// Every ray of one raster position meets the plane of focus in one point: position + (axis + x right + y up) focus in perspective, so that
// with a lens point l the direction is axis + x right + y up - l / focus. An orthographic camera has a lens of its own before every raster
// position, as telecentric optics have: the bundle about x, y converges on the plane of focus in position + x right + y up + axis focus.
Ray Camera::ray(Point2 raster, Point2 lens, float time) const noexcept {
    const Pose c = pose(time);
    const Point2 at = onPlane(raster);
    const bool perspective = projection_ == Projection::perspective;
    const Vec3 middle = perspective ? c.position : c.position + c.right * at.x + c.up * at.y;
    Vec3 towards = perspective ? towardsPlane(c, at) : c.axis; // to the plane at distance 1
    if (lensRadius_ == 0) return {middle, 0, perspective ? normalize(towards) : towards, infinity, time};
    const Point2 l = lensPoint(lens, blades_, lensRotation_);
    const Vec3 from = c.right * (l.x * lensRadius_) + c.up * (l.y * lensRadius_);
    if (fault(Fault::focusAlongRay)) towards = normalize(towards);
    return {middle + from, 0, normalize(towards - from * (1 / focus_)), infinity, time};
}

// The mean of a pixel is the integral of h(raster) p(l) L over the raster and the lens, h the reconstruction filter, p = 1 / lens area. For
// a fixed lens point the rays are those of a pinhole there, and an area dA of the scene at distance d, seen along w, fills the solid angle
// dA |cos| / d^2: flux that leaves it towards the lens adds flux f |cos| (draster / dw) / d^2 to the pixels around raster, and p cancels
// with the density of the lens point. With K = width height / (4 halfX halfY) pixels per unit of the plane at distance 1 and z = d cos the
// planar depth, in
//   perspective   dw = cos^3 dx dy, so importance = K / (cos^3 d^2) = K d / z^3
//   orthographic  the rays of one lens point are parallel, dx dy cos = dA |cos|, so importance = K / cos; cos is that between ray and axis
std::optional<CameraConnection> Camera::importance(const SurfacePoint& from, Point2 lens) const noexcept {
    const Pose c = pose(from.time);
    const Vec3 way = from.p - c.position;
    const float z = dot(way, c.axis), scale = width_ * height_ / (4 * halfX_ * halfY_);
    if (!(z > 0)) return {};
    const Point2 l = lensRadius_ > 0 ? lensPoint(lens, blades_, lensRotation_) : Point2{};
    const float lx = l.x * lensRadius_, ly = l.y * lensRadius_;
    float x = dot(way, c.right), y = dot(way, c.up);
    Vec3 eye = c.position + c.right * lx + c.up * ly;
    if (projection_ == Projection::perspective) {
        x = (x - lx) / z + lx / focus_; // of the plane at distance 1
        y = (y - ly) / z + ly / focus_;
    } else {
        x -= lx * (1 - z / focus_);
        y -= ly * (1 - z / focus_);
        eye += c.right * x + c.up * y;
    }
    const Vec3 d = eye - from.p;
    const float distance = length(d), cosine = z / distance;
    CameraConnection r;
    r.raster = {(x / halfX_ + 1) / 2 * width_, (1 - y / halfY_) / 2 * height_};
    r.wi = d * (1 / distance);
    r.importance = projection_ == Projection::orthographic ? scale / cosine
                   : fault(Fault::importanceCosine)        ? scale / (z * z)
                                                           : scale * distance / (z * z * z);
    const Vec3 origin = from.offset(r.wi), left = eye - origin;
    const float rest = length(left);
    if (!(rest > 0) || !std::isfinite(r.importance)) return {};
    r.shadow = {origin, 0, left * (1 / rest), rest, from.time};
    return r;
}

// A flux dF = L cos dA dw through the opening adds L p (draster / dw) dA dw = dF (draster / dw) / (cos area) in perspective. In an
// orthographic camera the direction names the lens point, l = -focus tan, dl = focus^2 dw / cos^3, and the place of the ray on the plane of
// focus the raster position: dF focus^2 K / (cos^4 area).
std::optional<CameraLanding> Camera::landing(const Ray& ray) const noexcept {
    const Pose c = pose(ray.time);
    const float cosine = -dot(ray.d, c.axis);
    if (lensRadius_ == 0 || !(cosine > 0)) return {};
    CameraLanding r;
    r.t = dot(ray.o - c.position, c.axis) / cosine;
    if (!(r.t > 0)) return {};
    const Vec3 way = ray.o + ray.d * r.t - c.position, slope = ray.d * (-1 / cosine); // seen from the lens, per metre of depth
    const float lx = dot(way, c.right), ly = dot(way, c.up), sx = dot(slope, c.right), sy = dot(slope, c.up);
    const bool perspective = projection_ == Projection::perspective;
    const Point2 lens =
        perspective ? Point2{lx / lensRadius_, ly / lensRadius_} : Point2{-sx * focus_ / lensRadius_, -sy * focus_ / lensRadius_};
    if (!lensHolds(lens, blades_, lensRotation_)) return {};
    const float x = perspective ? sx + lx / focus_ : lx + sx * focus_, y = perspective ? sy + ly / focus_ : ly + sy * focus_;
    r.raster = {(x / halfX_ + 1) / 2 * width_, (1 - y / halfY_) / 2 * height_};
    const float scale = width_ * height_ / (4 * halfX_ * halfY_), area = lensArea(blades_) * sqr(lensRadius_);
    r.importance = scale * (perspective ? 1 : sqr(focus_)) / (area * sqr(sqr(cosine)));
    return r;
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
