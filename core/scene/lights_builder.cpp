#include "core/scene/lights_builder.h"
#include "core/render/fault.h"
#include <map>
#include <numeric>

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
        // Of few texels each is a large part of the mean.
        const double least = width * height <= 256 ? 16 : 6;
        n = int(std::clamp(std::isfinite(longest) ? longest * 1.5 : 64.0, least, 64.0));
    }
    // The middles of n * n triangles of equal area.
    double sum = 0;
    int count = 0;
    const auto add = [&](float u, float v) {
        sum += luminance(lights_.emission(scene_.attributes({t.geometry, t.triangle, t.instance, u / float(n), v / float(n), 0})));
        ++count;
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n - i; ++j) {
            add(float(i) + 1 / 3.f, float(j) + 1 / 3.f);
            if (j + 1 < n - i) add(float(i) + 2 / 3.f, float(j) + 2 / 3.f);
        }
    return sum / count;
}

namespace {

// Twice the area of a moving triangle, its mean over the motion and the shapes.
float meanTwice(const Motion& motion, const Geometry& g, uint32_t triangle) {
    const std::span<const Motion::Key> keys = motion.keys();
    const std::size_t moments = std::max(keys.size(), g.steps.size() + 1);
    const auto corner = g.triangle(triangle);
    double sum = 0;
    for (std::size_t i = 0; i < moments; ++i) {
        const auto& p = g.positionsAt(i * g.steps.size() / (moments - 1));
        const Vec3 n = cross(p[corner[1]] - p[corner[0]], p[corner[2]] - p[corner[0]]);
        sum += length(Motion::compose(keys[i * (keys.size() - 1) / (moments - 1)]).normal(cast<double>(n)));
    }
    return float(sum / double(moments));
}

} // namespace

uint32_t LightsBuilder::addMesh(const Geometry& g, uint32_t geometry, const Instance* instance, uint32_t instanceIndex, uint32_t motion) {
    const MaterialDesc& m = scene_.material(g.material);
    const auto first = uint32_t(lights_.triangles_.size());
    lamps_ += pieces(g);
    for (uint32_t i = 0; i < g.triangles(); ++i) {
        const auto corner = g.triangle(i);
        Vec3 p[3] = {g.positions[corner[0]], g.positions[corner[1]], g.positions[corner[2]]};
        const bool moves = motion != Lights::none;
        if (instance && !moves)
            for (Vec3& q : p) q = instance->toWorld.point(q);
        Lights::Triangle t;
        t.p = p[0];
        t.e1 = p[1] - p[0];
        t.e2 = p[2] - p[0];
        const Vec3 n = cross(t.e1, t.e2);
        const float twice = moves ? meanTwice(scene_.motion(motion), g, i) : length(n);
        t.area = twice / 2;
        t.ng = twice > 0 ? n * ((instance && instance->flipped ? -1.f : 1.f) / twice) : Vec3{0, 0, 1};
        t.error = 8 * 0x1p-23f * max(maxAbs(p[0]), max(maxAbs(p[1]), maxAbs(p[2])));
        t.geometry = geometry;
        t.triangle = i;
        t.instance = instanceIndex;
        t.material = g.material;
        t.motion = motion;
        t.doubleSided = m.doubleSided || m.unlit || fault(Fault::lampTwoSided);
        t.power = float(meanEmission(t) * double(t.area) * double(pi) * (t.doubleSided ? 2 : 1));
        lights_.triangles_.push_back(t);
    }
    return first;
}

// Of triangles that share vertices.
std::size_t LightsBuilder::pieces(const Geometry& g) {
    std::vector<uint32_t> towards(g.positions.size()); // each vertex to one of its piece, the last to itself
    std::iota(towards.begin(), towards.end(), 0);
    const auto root = [&](uint32_t v) {
        while (towards[v] != v) v = towards[v] = towards[towards[v]];
        return v;
    };
    for (uint32_t i = 0; i < g.triangles(); ++i) {
        const auto corner = g.triangle(i);
        for (const auto& [a, b] : {std::pair{corner[0], corner[1]}, {corner[0], corner[2]}}) towards[root(a)] = root(b);
    }
    std::vector<bool> met(g.positions.size());
    std::size_t count = 0;
    for (uint32_t i = 0; i < g.triangles(); ++i) {
        const uint32_t r = root(g.triangle(i)[0]);
        count += !met[r];
        met[r] = true;
    }
    return count;
}

void LightsBuilder::addPunctual(const PunctualDesc& d, const Vec3d& centre, float sceneRadius, uint32_t motion) {
    Lights::Punctual l;
    l.motion = motion;
    l.kind = d.kind;
    ++lamps_;
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
        // KHR_lights_punctual: clamp(cos * scale + offset)^2; the flux of the squared ramp is a third of its solid angle. The narrowest
        // ramp is what floats can tell; the 0.001 of the extension's sample code would dim every cone of less than 2.5 degrees.
        const double ramp = std::max(1e-5, inner - outer), top = std::min(1.0, (1 - outer) / ramp);
        l.scale = float(1 / ramp);
        l.offset = float(-outer / ramp);
        l.power = 2 * double(pi) * (std::max(0.0, 1 - outer - ramp) + ramp * top * top * top / 3) * y;
    }
    lights_.punctual_.push_back(l);
}

void LightsBuilder::setEnvironment(const EnvironmentDesc& d, float sceneRadius) {
    lights_.environment_.emplace(d);
    lights_.skyPower_ = lights_.environment_->irradiance() * double(pi) * sceneRadius * sceneRadius;
}

void LightsBuilder::finish(const Executor* run) {
    std::vector<double> power;
    for (const Lights::Triangle& t : lights_.triangles_) power.push_back(t.power);
    for (const Lights::Punctual& p : lights_.punctual_) power.push_back(p.power);
    lights_.finite_ = AliasTable(power);
    const double sky = lights_.skyPower_;
    lights_.power_ = lights_.finite_.sum() + sky;
    if (lamps_ > few) plantTree(run);
    const double share = lights_.power_ > 0 ? sky / lights_.power_ : 0;
    lights_.pickEnvironment_ = share > 0 && share < 1 ? float(std::clamp(share, leastShare, 1 - leastShare)) : float(share);
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
    if (environment_) all.push_back({"environment", "environment", skyPower_, 0});
    return all;
}

} // namespace chiaro
