#include "core/scene/lights_builder.h"
#include "core/render/fault.h"
#include <cstring>
#include <map>

namespace chiaro {

// Mean luminance of a triangle's emission: one value without a texture, else a grid about as fine as the texels it covers. A triangle whose
// texels are all black gets no power; the rays that hit it still see what the filter shows there.
double LightsBuilder::meanEmission(const Lights::Triangle& t) const {
    const MaterialDesc& m = scene_.material(t.material);
    const TextureSlot& slot = m.unlit ? m.baseColorTexture : m.emissionTexture;
    int n = 1;
    if (slot.texture >= 0) {
        Point2 corner[3];
        for (int k = 0; k < 3; ++k)
            corner[k] =
                apply(slot.transform,
                      scene_.attributes({t.geometry, t.triangle, t.instance, k == 1 ? 1.f : 0.f, k == 2 ? 1.f : 0.f, 0}).uv[slot.uvSet]);
        const double width = scene_.textures().width(slot.texture), height = scene_.textures().height(slot.texture);
        double longest = 0;
        for (int k = 0; k < 3; ++k) {
            const Point2 a = corner[k], b = corner[(k + 1) % 3];
            longest = std::max(longest, std::hypot((b.x - a.x) * width, (b.y - a.y) * height));
        }
        n = int(std::clamp(std::isfinite(longest) ? longest * 1.5 : 64.0, 3.0, 64.0));
    }
    double sum = 0;
    int count = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n - i; ++j, ++count) {
            const float u = (float(i) + 1 / 3.f) / float(n), v = (float(j) + 1 / 3.f) / float(n);
            sum += luminance(lights_.emission(scene_.attributes({t.geometry, t.triangle, t.instance, u, v, 0})));
        }
    return sum / count;
}

namespace {

// Twice the area of a moving triangle, its mean over the motion; n: the cross product of its edges in the mesh.
float meanTwice(const Motion& motion, const Vec3& n) {
    double sum = 0;
    for (const Motion::Key& k : motion.keys()) sum += length(Motion::compose(k).normal(cast<double>(n)));
    return float(sum / double(motion.keys().size()));
}

} // namespace

uint32_t LightsBuilder::addMesh(const Geometry& g, uint32_t geometry, const Instance* instance, uint32_t instanceIndex) {
    const MaterialDesc& m = scene_.material(g.material);
    const auto first = uint32_t(lights_.triangles_.size());
    for (uint32_t i = 0; i < g.triangles(); ++i) {
        const auto corner = g.triangle(i);
        Vec3 p[3] = {g.positions[corner[0]], g.positions[corner[1]], g.positions[corner[2]]};
        const bool moves = instance && instance->motion != Hit::none;
        if (instance && !moves)
            for (Vec3& q : p) q = instance->toWorld.point(q);
        Lights::Triangle t;
        t.p = p[0];
        t.e1 = p[1] - p[0];
        t.e2 = p[2] - p[0];
        const Vec3 n = cross(t.e1, t.e2);
        const float twice = moves ? meanTwice(scene_.motion(instance->motion), n) : length(n);
        t.area = twice / 2;
        t.ng = twice > 0 ? n * ((instance && instance->flipped ? -1.f : 1.f) / twice) : Vec3{0, 0, 1};
        t.error = 8 * 0x1p-23f * max(maxAbs(p[0]), max(maxAbs(p[1]), maxAbs(p[2])));
        t.geometry = geometry;
        t.triangle = i;
        t.instance = instanceIndex;
        t.material = g.material;
        if (moves) t.motion = instance->motion;
        t.doubleSided = m.doubleSided || m.unlit || fault(Fault::lampTwoSided);
        t.power = float(meanEmission(t) * double(t.area) * double(pi) * (t.doubleSided ? 2 : 1));
        lights_.triangles_.push_back(t);
    }
    return first;
}

void LightsBuilder::addPunctual(const PunctualDesc& d, const Vec3d& centre, float sceneRadius, uint32_t motion) {
    Lights::Punctual l;
    l.motion = motion;
    l.kind = d.kind;
    l.intensity = d.intensity * (fault(Fault::candelaAsLumen) ? 1 / (4 * pi) : 1.f);
    l.name = d.name;
    l.p = cast<float>(d.toWorld.point(Vec3d{0, 0, 0}) - centre);
    l.axis = cast<float>(normalize(d.toWorld.vector(Vec3d{0, 0, -1})));
    l.range = float(d.range);
    const double y = double(luminance(d.intensity)), share = fault(Fault::spotHalfAngle) ? 0.5 : 1;
    const double inner = std::cos(d.innerCone * share), outer = std::cos(d.outerCone * share);
    if (d.kind == PunctualKind::point) l.power = 4 * double(pi) * y;
    if (d.kind == PunctualKind::directional) l.power = double(pi) * sceneRadius * sceneRadius * y;
    if (d.kind == PunctualKind::spot) {
        // KHR_lights_punctual: clamp(cos * scale + offset)^2; the flux of the squared ramp is a third of its solid angle.
        l.scale = float(1 / std::max(0.001, inner - outer));
        l.offset = float(-outer * double(l.scale));
        l.power = 2 * double(pi) * (1 - inner + (inner - outer) / 3) * y;
    }
    lights_.punctual_.push_back(l);
}

namespace {

// What the look-up shows on average over each texel: the texels themselves, or with a linear filter their blend with the neighbours (the
// tent over a texel: 1/8, 3/4, 1/8 along each axis). So no direction that shines is left without density.
std::vector<double> meanLuminance(std::span<const Vec4> texels, int width, int height, TextureFilter filter) {
    std::vector<double> own(texels.size());
    for (std::size_t i = 0; i < own.size(); ++i) own[i] = std::max(0.0, double(luminance(Spectrum(texels[i].x, texels[i].y, texels[i].z))));
    if (filter == TextureFilter::nearest) return own;
    std::vector<double> across(own.size()), mean(own.size());
    const auto index = [width](int x, int y) { return std::size_t(y) * width + x; };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            across[index(x, y)] =
                0.75 * own[index(x, y)] + 0.125 * (own[index((x + width - 1) % width, y)] + own[index((x + 1) % width, y)]);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            mean[index(x, y)] =
                0.75 * across[index(x, y)] + 0.125 * (across[index(x, std::max(0, y - 1))] + across[index(x, std::min(height - 1, y + 1))]);
    return mean;
}

} // namespace

void LightsBuilder::setEnvironment(const EnvironmentDesc& d, float sceneRadius) {
    Lights::Environment e;
    e.width = d.image.width;
    e.height = d.image.height;
    e.cosRotate = std::cos(d.rotate);
    e.sinRotate = std::sin(d.rotate);
    for (int row = 0; row <= e.height; ++row) e.rowCosine.push_back(float(std::cos(double(pi) * row / e.height)));
    e.rowCosine.back() = -1;
    const std::size_t count = std::size_t(e.width) * e.height;
    std::vector<float> rgb(count * 3);
    std::memcpy(rgb.data(), d.image.pixels.data(), rgb.size() * sizeof(float));
    e.filter = d.filter;
    std::vector<double> solidAngle(e.height);
    for (int y = 0; y < e.height; ++y)
        solidAngle[y] =
            (std::cos(std::numbers::pi * y / e.height) - std::cos(std::numbers::pi * (y + 1) / e.height)) * 2 * std::numbers::pi / e.width;
    for (std::size_t i = 0; i < count; ++i)
        e.texels.push_back({rgb[3 * i] * d.scale, rgb[3 * i + 1] * d.scale, rgb[3 * i + 2] * d.scale, 0});
    std::vector<double> weights = meanLuminance(e.texels, e.width, e.height, e.filter);
    for (std::size_t i = 0; i < count; ++i) weights[i] *= solidAngle[i / e.width];
    e.table = AliasTable(weights);
    if (!e.table.empty())
        for (std::size_t i = 0; i < count; ++i)
            e.texels[i].w = float(double(e.table.pmf(uint32_t(i))) /
                                  (fault(Fault::skySineMissing) ? 4 * double(pi) / double(count) : solidAngle[i / e.width]));
    e.power = e.table.sum() * double(pi) * sceneRadius * sceneRadius;
    lights_.environment_ = std::move(e);
}

void LightsBuilder::plantTree(const Executor* run) {
    std::vector<LightTree::Emitter> emitters;
    std::vector<double> outside;
    double inside = 0;
    for (uint32_t i = 0; i < lights_.triangles_.size(); ++i) {
        const Lights::Triangle& t = lights_.triangles_[i];
        if (t.motion != Lights::none) {
            lights_.outsideLights_.push_back(i);
            outside.push_back(t.power);
            continue;
        }
        const Vec3 q = t.p + t.e1, r = t.p + t.e2;
        const Vec3 centre = Vec3{max(t.p.x, max(q.x, r.x)) + min(t.p.x, min(q.x, r.x)), max(t.p.y, max(q.y, r.y)) + min(t.p.y, min(q.y, r.y)),
                                 max(t.p.z, max(q.z, r.z)) + min(t.p.z, min(q.z, r.z))} *
                            0.5f;
        const float radius = max(length(t.p - centre), max(length(q - centre), length(r - centre)));
        emitters.push_back({centre, radius, t.ng, 1, 0, t.doubleSided, t.power / (pi * (t.doubleSided ? 2 : 1)), i});
        inside += double(t.power);
    }
    for (uint32_t i = 0; i < lights_.punctual_.size(); ++i) {
        const Lights::Punctual& l = lights_.punctual_[i];
        const auto number = uint32_t(lights_.triangles_.size()) + i;
        if (l.motion != Lights::none || l.kind == PunctualKind::directional) {
            lights_.outsideLights_.push_back(number);
            outside.push_back(l.power);
            continue;
        }
        // A spot: clamp(cos * scale + offset)^2 is 1 within its inner cone and 0 beyond the outer.
        const bool spot = l.kind == PunctualKind::spot;
        const float inner = spot ? std::clamp((1 - l.offset) / l.scale, -1.f, 1.f) : -1, outer = spot ? std::clamp(-l.offset / l.scale, -1.f, 1.f) : 0;
        const float reach = std::acos(outer) - std::acos(inner);
        emitters.push_back({l.p, 0, l.axis, inner, spot ? std::cos(reach) : 0, false, luminance(l.intensity), number});
        inside += l.power;
    }
    const char* few = getenv("CHIARO_FEW");
    if (emitters.size() <= std::size_t(few ? atoi(few) : 0) || !(inside > 0)) return lights_.outsideLights_.clear();
    lights_.tree_ = LightTree(emitters, lights_.count(), run);
    lights_.outside_ = AliasTable(outside);
    constexpr double least = 0x1p-10;
    const double rest = lights_.outside_.sum();
    lights_.pickTree_ = rest > 0 ? float(std::clamp(inside / (inside + rest), least, 1 - least)) : 1;
}

void LightsBuilder::finish(const Executor* run) {
    std::vector<double> power;
    for (const Lights::Triangle& t : lights_.triangles_) power.push_back(t.power);
    for (const Lights::Punctual& p : lights_.punctual_) power.push_back(p.power);
    lights_.finite_ = AliasTable(power);
    const double sky = lights_.environment_ ? lights_.environment_->power : 0;
    lights_.power_ = lights_.finite_.sum() + sky;
    // Neither side may round to nothing: a lamp on a wide plain under the sky has less than 2^-24 of its power.
    constexpr double least = 0x1p-10;
    plantTree(run);
    const double share = lights_.power_ > 0 ? sky / lights_.power_ : 0;
    lights_.pickEnvironment_ = share > 0 && share < 1 ? float(std::clamp(share, least, 1 - least)) : float(share);
}

std::vector<LightInfo> Lights::describe() const {
    std::vector<LightInfo> all;
    std::map<uint32_t, LightInfo> meshes; // by material
    for (const Triangle& t : triangles_) {
        LightInfo& info = meshes[t.material];
        info = {scene_->material(t.material).name, "mesh", info.power + t.power, info.triangles + 1};
    }
    for (const auto& [material, info] : meshes) all.push_back(info);
    static constexpr const char* kinds[] = {"point", "spot", "directional"};
    for (const Punctual& p : punctual_) all.push_back({p.name, kinds[int(p.kind)], p.power, 0});
    if (environment_) all.push_back({"environment", "environment", environment_->power, 0});
    return all;
}

} // namespace chiaro
