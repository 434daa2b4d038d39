// Lights::lamps(): the lights as the classics see them, one position each. The intensity of a mesh is what it shows from far away, where
// it is one point: of a flat one I cos(theta) with I = integral L dA (the inverse square law of a Lambert emitter); of any other mesh the
// mean over all directions, I = integral L dA / 4, which for a ball is exact in every direction (Cauchy 1841: the mean projected area of a
// convex body is a quarter of its surface). What moves is where it is in the middle of the shutter.
#include "core/scene/accel.h"
#include "core/scene/scene.h"
#include <algorithm>
#include <array>

namespace chiaro {
namespace {

using Corners = std::array<Vec3d, 3>;

// How many look-ups along an edge see every texel of a texture on a triangle.
int gridOf(const Scene& scene, const TextureSlot& slot, Hit at) {
    if (slot.texture < 0) return 1;
    double longest = 0;
    Point2 corner[3];
    for (int k = 0; k < 3; ++k) {
        at.u = k == 1 ? 1.f : 0.f;
        at.v = k == 2 ? 1.f : 0.f;
        corner[k] = apply(slot.transform, scene.attributes(at).uv[slot.uvSet]);
    }
    const double width = scene.textures().width(slot.texture), height = scene.textures().height(slot.texture);
    for (int k = 0; k < 3; ++k) {
        const Point2 a = corner[k], b = corner[(k + 1) % 3];
        longest = std::max(longest, std::hypot((b.x - a.x) * width, (b.y - a.y) * height));
    }
    return int(std::clamp(std::isfinite(longest) ? longest * 1.5 : 64.0, 8.0, 64.0));
}
// One where nothing varies.
int gridOf(const Scene& scene, const MaterialDesc& m, const Hit& triangle) {
    const int shine = m.unlit ? 1 : gridOf(scene, m.emissionTexture, triangle);
    return m.unlit || m.alphaMode != AlphaMode::opaque ? std::max(shine, gridOf(scene, m.baseColorTexture, triangle)) : shine;
}

// Mean of a value over a triangle, by the centres of equal small ones.
template <class F> Rgb<double> meanOver(Hit triangle, int n, F value) {
    Rgb<double> sum(0);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n - i; ++j) {
            triangle.u = (float(i) + 1 / 3.f) / float(n);
            triangle.v = (float(j) + 1 / 3.f) / float(n);
            const Spectrum s = value(triangle);
            sum += {double(s[0]), double(s[1]), double(s[2])};
        }
    return sum * (2.0 / (double(n) * (n + 1)));
}

// The triangles of one mesh, summed in double.
class MeshSum {
public:
    // radiance: its mean over the triangle; error: bound of the corners' rounding error, metres.
    void add(const Corners& p, const Vec3d& front, const Rgb<double>& radiance, float error) {
        const double area = length(cross(p[1] - p[0], p[2] - p[0])) / 2;
        if (!(area > 0)) return;
        if (area > largest_) {
            largest_ = area;
            normal_ = front;
        }
        area_ += area;
        moment_ = moment_ + (p[0] + p[1] + p[2]) * (area / 3);
        integral_ += radiance * area;
        error_ = std::max(error_, double(error));
        corners_.push_back(p);
        fronts_.push_back(front);
    }
    bool empty() const { return corners_.empty(); }
    Lamp lamp(bool doubleSided, uint32_t first, uint32_t count) const {
        Lamp lamp;
        lamp.centre = cast<float>(moment_ * (1 / area_));
        const bool plane = flat();
        if (plane) lamp.normal = cast<float>(normal_);
        const Rgb<double> intensity = integral_ * (plane ? 1 : doubleSided ? 0.5 : 0.25);
        lamp.intensity = {float(intensity[0]), float(intensity[1]), float(intensity[2])};
        lamp.doubleSided = doubleSided;
        lamp.first = first;
        lamp.count = count;
        return lamp;
    }

private:
    // All corners in one plane but for rounding, all fronts on one side of it.
    bool flat() const {
        const Vec3d origin = moment_ * (1 / area_);
        for (std::size_t i = 0; i < corners_.size(); ++i) {
            if (dot(fronts_[i], normal_) < 0) return false;
            for (const Vec3d& p : corners_[i])
                if (std::fabs(dot(p - origin, normal_)) > 4 * error_) return false;
        }
        return true;
    }
    Rgb<double> integral_{0}; // of L dA over the front
    Vec3d moment_, normal_;   // integral of p dA; the front of the largest triangle
    double area_ = 0, largest_ = 0, error_ = 0;
    std::vector<Corners> corners_;
    std::vector<Vec3d> fronts_;
};

} // namespace

std::vector<Lamp> Lights::lamps() const {
    std::vector<Lamp> all;
    const float middle = (scene_->shutter().open + scene_->shutter().close) / 2;
    const auto radiance = [this](const Hit& hit) {
        const SurfacePoint at = scene_->attributes(hit);
        return emission(at) * scene_->opacity(at);
    };
    for (uint32_t first = 0, end = 0; first < triangles_.size(); first = end) {
        const Triangle& head = triangles_[first];
        MeshSum mesh;
        for (; end < triangles_.size(); ++end) {
            if (triangles_[end].geometry != head.geometry || triangles_[end].instance != head.instance) break;
            const Triangle t = placed(triangles_[end], middle);
            const Hit hit{t.geometry, t.triangle, t.instance, 0, 0, 0};
            const Corners corners = {cast<double>(t.p), cast<double>(t.p + t.e1), cast<double>(t.p + t.e2)};
            mesh.add(corners, cast<double>(t.ng), meanOver(hit, gridOf(*scene_, scene_->material(t.material), hit), radiance), t.error);
        }
        if (!mesh.empty()) all.push_back(mesh.lamp(head.doubleSided, first, end - first)); // nothing shines from a mesh without area
    }
    for (uint32_t i = 0; i < punctual_.size(); ++i) {
        Lamp lamp;
        lamp.kind = LightKind::delta;
        if (punctual_[i].kind != PunctualKind::directional) lamp.centre = placeOf(punctual_[i], middle).p;
        lamp.intensity = punctual_[i].intensity;
        lamp.first = uint32_t(triangles_.size()) + i;
        all.push_back(lamp);
    }
    return all;
}

} // namespace chiaro
