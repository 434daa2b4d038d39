// SceneDesc -> Scene: places geometry (once-used meshes in world space, others as instances), recentres in double, builds hierarchy and
// lights.
#include "core/render/error.h"
#include "core/render/fault.h"
#include "core/render/in_parallel.h"
#include "core/scene/accel.h"
#include "core/scene/geometry.h"
#include "core/scene/lights_builder.h"
#include "core/scene/scene_hash.h"
#include "core/scene/swept_bounds.h"
#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace chiaro {

namespace {

Affine moved(Affine m, const Vec3d& centre) noexcept {
    m.m[0][3] -= centre.x;
    m.m[1][3] -= centre.y;
    m.m[2][3] -= centre.z;
    return m;
}

// Also in the floats of the ray tracer: it divides by the determinant.
bool invertible(const Affine& m) noexcept {
    double largest = 0;
    for (const auto& row : m.m)
        for (int j = 0; j < 3; ++j) largest = std::max(largest, std::fabs(row[j]));
    const double d = std::fabs(m.determinant());
    return d > 1e-9 * largest * largest * largest && d > 1e-30 && d < 1e30;
}

AffineT<float> narrowed(const Affine& m) noexcept {
    AffineT<float> r;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) r.m[i][j] = float(m.m[i][j]);
    return r;
}

Affine widened(const AffineT<float>& m) noexcept {
    Affine r;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) r.m[i][j] = double(m.m[i][j]);
    return r;
}

// A ray has no image under a map that flattens space, and beyond one an object is inside out: at such steps it is what it is at the last
// sound step (before the first of these: at that one), a ten-thousandth of the size. How many were mended; all of them: no step is sound.
std::size_t mend(MotionDesc& maps) {
    constexpr double least = 1e-4;
    const auto first = std::find_if(maps.begin(), maps.end(), invertible);
    if (first == maps.end()) return maps.size();
    std::size_t mended = 0;
    Affine last = *first;
    for (Affine& m : maps) {
        if (invertible(m) && (m.determinant() < 0) == (last.determinant() < 0)) {
            last = m;
            continue;
        }
        ++mended;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) m.m[i][j] = last.m[i][j] * least;
    }
    return mended;
}

template <class T> std::size_t heldBy(const std::vector<T>& v) noexcept { return v.capacity() * sizeof(T); }

} // namespace

class SceneCompiler {
public:
    SceneCompiler(SceneDesc desc, Diagnostics& notes, const Executor* run)
        : desc_(std::move(desc)), notes_(notes), run_(run), scene_(new Scene) {}
    std::unique_ptr<const Scene> run(const std::string& isa, Scene::MakeTable);

private:
    void materials();
    void motions();
    bool moves(const MotionDesc& m) const noexcept { return m.size() > 1 && desc_.shutter.close > desc_.shutter.open; }
    uint32_t addMotion(MotionDesc); // recentred; its number
    void centre();
    // A primitive on its way into the scene; with a map, in world space.
    struct Source {
        PrimitiveDesc* primitive;
        std::optional<Affine> toWorld;
    };
    void place();
    void bake(const std::vector<const InstanceDesc*>&, bool keep);
    void draw(uint32_t geometry, uint32_t instance, const InstanceDesc&, std::size_t primitive);
    void add(const std::vector<Source>&, bool keep); // keep: the primitives are needed again
    Geometry geometry(PrimitiveDesc, const std::optional<Affine>& toWorld) const;
    void shapes();
    uint32_t stillMotion(const Affine&);
    void count();
    void lights();
    std::size_t lightBytes() const;

    SceneDesc desc_;
    Diagnostics& notes_;
    const Executor* run_;
    std::unique_ptr<Scene> scene_;
    std::size_t top_ = 0; // geometries in world space
};

void SceneCompiler::materials() {
    scene_->materials_ = std::move(desc_.materials);
    scene_->materials_.push_back(MaterialDesc{}); // glTF's default, for primitives without one
    scene_->materials_.back().name = "default";
    std::vector<Pyramids> pyramids = wantedPyramids(scene_->materials_, desc_.textures, desc_.images.size());
    scene_->textures_ = Textures(std::move(desc_.images), std::move(desc_.textures), std::move(pyramids), run_);
}

// Leaves a motion only to what moves while the shutter is open, every step of it invertible, and begins it where the thing stands.
void SceneCompiler::motions() {
    std::size_t mended = 0;
    const auto settle = [&](Affine& toWorld, MotionDesc& motion, bool needsInverse) {
        if (motion.empty()) return;
        toWorld = motion.front();
        const bool still = std::all_of(motion.begin(), motion.end(), [&](const Affine& m) { return m == motion.front(); });
        if (still || !moves(motion)) return motion.clear();
        const std::size_t bad = needsInverse ? mend(motion) : 0;
        if (bad == motion.size()) return motion.clear();
        mended += bad > 0;
        toWorld = motion.front();
    };
    for (InstanceDesc& i : desc_.instances) settle(i.toWorld, i.motion, true);
    for (PunctualDesc& l : desc_.lights) settle(l.toWorld, l.motion, true);
    for (CameraDesc& c : desc_.cameras) settle(c.toWorld, c.motion, false);
    if (mended > 0)
        notes_.warn(fmt::format("{}: {} {} to nothing or inside out while the shutter is open; drawn a ten-thousandth of the size there",
                                desc_.name, mended, mended == 1 ? "instance goes" : "instances go"));
}

// Leaves steps only to what changes its shape while the shutter is open.
void SceneCompiler::shapes() {
    const bool open = desc_.shutter.close > desc_.shutter.open;
    for (MeshDesc& mesh : desc_.meshes)
        for (PrimitiveDesc& p : mesh.primitives) {
            if (p.steps.size() >= Motion::mostKeys)
                throw Error(Exit::unsupported, fmt::format("{}: mesh \"{}\" has {} shapes over the shutter, more than {}", desc_.name,
                                                           mesh.name, p.steps.size() + 1, Motion::mostKeys));
            const auto same = [&p](const ShapeDesc& s) { return s.positions == p.positions && s.normals == p.normals; };
            if (!open || std::all_of(p.steps.begin(), p.steps.end(), same)) p.steps.clear();
        }
}

uint32_t SceneCompiler::addMotion(MotionDesc maps) {
    for (Affine& m : maps) m = moved(m, scene_->centre_);
    scene_->motions_.emplace_back(maps, desc_.shutter);
    return uint32_t(scene_->motions_.size() - 1);
}

// Of a light that changes its shape but stays where it is.
uint32_t SceneCompiler::stillMotion(const Affine& place) {
    const Affine twice[] = {place, place};
    scene_->motions_.emplace_back(twice, desc_.shutter);
    return uint32_t(scene_->motions_.size() - 1);
}

void SceneCompiler::centre() {
    std::vector<Bounds> local(desc_.meshes.size());
    inParallel(run_, local.size(), [&](uint64_t i) {
        for (const PrimitiveDesc& p : desc_.meshes[i].primitives) {
            for (const Vec3& v : p.positions) local[i].add(cast<double>(v));
            for (const ShapeDesc& s : p.steps)
                for (const Vec3& v : s.positions) local[i].add(cast<double>(v));
        }
    });
    Bounds world;
    for (const InstanceDesc& in : desc_.instances)
        if (const Bounds& b = local[in.mesh]; b.empty())
            continue;
        else if (moves(in.motion))
            addSwept(world, b, Motion(in.motion, desc_.shutter));
        else
            for (int k = 0; k < 8; ++k) world.add(in.toWorld.point(b.corner(k)));
    if (world.empty()) {
        notes_.warn(fmt::format("{}: no triangles to draw; only the background will be seen", desc_.name));
        return;
    }
    scene_->centre_ = (world.low + world.high) * 0.5;
    const double radius = length(world.high - world.low) / 2;
    if (!(radius < 1e15))
        throw Error(Exit::unsupported,
                    fmt::format("{}: the scene is {:.3g} m wide, more than 1e15 m; scale it down", desc_.name, 2 * radius));
    scene_->radius_ = radius > 0 ? float(radius) : 1.f;
}

Geometry SceneCompiler::geometry(PrimitiveDesc p, const std::optional<Affine>& toWorld) const {
    const uint32_t material = p.material < 0 ? uint32_t(scene_->materials_.size() - 1) : uint32_t(p.material);
    return makeGeometry(std::move(p), toWorld, material, scene_->materials_[material]);
}

void SceneCompiler::draw(uint32_t geometry, uint32_t instance, const InstanceDesc& in, std::size_t primitive) {
    const Geometry& g = scene_->geometries_[geometry];
    scene_->parts_.push_back({geometry, instance, g.triangles(), g.material, uint32_t(&in - desc_.instances.data()), uint32_t(primitive)});
}

void SceneCompiler::add(const std::vector<Source>& sources, bool keep) {
    const std::size_t first = scene_->geometries_.size();
    scene_->geometries_.resize(first + sources.size());
    inParallel(run_, sources.size(), [&](uint64_t i) {
        PrimitiveDesc& p = *sources[i].primitive;
        scene_->geometries_[first + i] = geometry(keep ? p : std::move(p), sources[i].toWorld);
    });
}

// Meshes into world space, at the top level.
void SceneCompiler::bake(const std::vector<const InstanceDesc*>& nodes, bool keep) {
    std::vector<Source> sources;
    auto index = uint32_t(scene_->geometries_.size());
    for (const InstanceDesc* in : nodes)
        for (PrimitiveDesc& p : desc_.meshes[in->mesh].primitives) sources.push_back({&p, moved(in->toWorld, scene_->centre_)});
    add(sources, keep);
    for (const InstanceDesc* in : nodes)
        for (std::size_t k = 0; k < desc_.meshes[in->mesh].primitives.size(); ++k) draw(index++, Hit::none, *in, k);
}

void SceneCompiler::place() {
    // Nodes that flatten their mesh cannot be instances: a ray has no image under them. What moves must be one.
    std::vector<uint32_t> uses(desc_.meshes.size(), 0);
    std::vector<const InstanceDesc*> flattened, single;
    for (const InstanceDesc& in : desc_.instances)
        if (invertible(in.toWorld))
            uses[in.mesh] += moves(in.motion) ? 2 : 1;
        else
            flattened.push_back(&in);
    for (const InstanceDesc& in : desc_.instances)
        if (uses[in.mesh] == 1 && invertible(in.toWorld)) single.push_back(&in);
    bake(flattened, true);
    bake(single, false);
    top_ = scene_->geometries_.size();
    std::vector<uint32_t> first(desc_.meshes.size(), 0);
    std::vector<Source> sources;
    for (std::size_t i = 0; i < desc_.meshes.size(); ++i) {
        if (uses[i] < 2) continue;
        first[i] = uint32_t(top_ + sources.size());
        for (PrimitiveDesc& p : desc_.meshes[i].primitives) sources.push_back({&p, {}});
    }
    add(sources, false);
    for (const InstanceDesc& in : desc_.instances) {
        if (uses[in.mesh] < 2 || !invertible(in.toWorld)) continue;
        const Affine m = moved(in.toWorld, scene_->centre_);
        Instance instance;
        instance.toWorld = narrowed(m);
        instance.firstGeometry = first[in.mesh];
        instance.geometryCount = uint32_t(desc_.meshes[in.mesh].primitives.size());
        instance.firstLights.assign(instance.geometryCount, Lights::none);
        instance.flipped = m.determinant() < 0;
        if (moves(in.motion)) instance.motion = addMotion(in.motion);
        for (uint32_t k = 0; k < instance.geometryCount; ++k) draw(instance.firstGeometry + k, uint32_t(scene_->instances_.size()), in, k);
        scene_->instances_.push_back(std::move(instance));
    }
    count();
    desc_.meshes = {};
}

void SceneCompiler::count() {
    SceneCounts& n = scene_->counts_;
    n.instances = desc_.instances.size();
    for (const Geometry& g : scene_->geometries_) {
        n.triangles += g.triangles();
        n.bytes.geometry += bytesOf(g);
    }
    for (std::size_t i = 0; i < top_; ++i) n.trianglesDrawn += scene_->geometries_[i].triangles();
    for (const Instance& in : scene_->instances_)
        for (uint32_t k = 0; k < in.geometryCount; ++k) n.trianglesDrawn += scene_->geometries_[in.firstGeometry + k].triangles();
    n.bytes.placement = heldBy(scene_->instances_) + heldBy(scene_->parts_) + heldBy(scene_->geometries_);
    for (const Instance& in : scene_->instances_) n.bytes.placement += heldBy(in.firstLights);
    for (const Motion& m : scene_->motions_) n.bytes.placement += sizeof(Motion) + m.keys().size_bytes();
}

void SceneCompiler::lights() {
    LightsBuilder builder(*scene_, scene_->lights_);
    const auto shines = [&](const Geometry& g) {
        const MaterialDesc& m = scene_->materials_[g.material];
        return m.unlit ? !black(m.baseColor) : !black(m.emission);
    };
    SceneCounts& n = scene_->counts_;
    std::size_t triangles = 0;
    for (const DrawnPart& p : scene_->parts_) triangles += shines(scene_->geometries_[p.geometry]) ? p.triangles : 0;
    scene_->lights_.triangles_.reserve(triangles);
    for (uint32_t i = 0; i < top_; ++i) {
        Geometry& g = scene_->geometries_[i];
        if (!shines(g)) continue;
        g.firstLight = builder.addMesh(g, i, nullptr, Hit::none, g.deforms() ? stillMotion({}) : Lights::none);
        n.emissiveTriangles += g.triangles();
        ++n.emissiveMeshes;
    }
    for (uint32_t i = 0; i < scene_->instances_.size(); ++i) {
        Instance& in = scene_->instances_[i];
        for (uint32_t k = 0; k < in.geometryCount; ++k) {
            const Geometry& g = scene_->geometries_[in.firstGeometry + k];
            if (!shines(g)) continue;
            const uint32_t motion = g.deforms() && in.motion == Hit::none ? stillMotion(widened(in.toWorld)) : in.motion;
            in.firstLights[k] = builder.addMesh(g, in.firstGeometry + k, &in, i, motion);
            n.emissiveTriangles += g.triangles();
            ++n.emissiveMeshes;
        }
    }
    for (const PunctualDesc& l : desc_.lights)
        builder.addPunctual(l, scene_->centre_, scene_->radius_, moves(l.motion) ? addMotion(l.motion) : Lights::none);
    n.punctualLights = desc_.lights.size();
    if (desc_.environment) builder.setEnvironment(*desc_.environment, scene_->radius_);
    builder.finish(run_);
}

std::size_t SceneCompiler::lightBytes() const {
    constexpr std::size_t cell = 12; // of an alias table
    const Lights& l = scene_->lights_;
    std::size_t sum = heldBy(l.triangles_) + heldBy(l.punctual_) + (l.finite_.size() + l.outside_.size()) * cell +
                      heldBy(l.outsideLights_) + l.tree_.bytes();
    if (l.environment_) sum += l.environment_->bytes();
    return sum;
}

std::unique_ptr<const Scene> SceneCompiler::run(const std::string& isa, Scene::MakeTable makeTable) {
    scene_->name_ = desc_.name;
    scene_->shutter_ = desc_.shutter;
    scene_->clock_ = ShutterClock(desc_.shutter);
    materials();
    shapes();
    motions();
    centre();
    place();
    lights();
    scene_->counts_.bytes.lights = lightBytes();
    scene_->counts_.bytes.textures = scene_->textures_.bytes();
    scene_->cameras_ = std::move(desc_.cameras);
    for (CameraDesc& c : scene_->cameras_) {
        c.toWorld = moved(c.toWorld, scene_->centre_);
        for (Affine& m : c.motion) m = moved(m, scene_->centre_);
    }
    scene_->hash_ = sceneHash(*scene_, scene_->geometries_, scene_->instances_, desc_);
    const Scene* self = scene_.get();
    scene_->accel_ = std::make_unique<Accel>(
        scene_->geometries_, top_, scene_->instances_, scene_->motions_, desc_.shutter,
        [self](const Hit& h) { return self->opacity(self->attributes(h)); }, isa, run_);
    scene_->counts_.bytes.hierarchy = scene_->accel_->bytes();
    scene_->isa_ = scene_->accel_->isa();
    if (makeTable) scene_->table_ = makeTable(*scene_);
    scene_->counts_.bytes.materials = heldBy(scene_->materials_) + (scene_->table_ ? scene_->table_->bytes() : 0);
    return std::move(scene_);
}

std::unique_ptr<const Scene> Scene::compile(SceneDesc desc, Diagnostics& notes, const std::string& isa, const Executor* run,
                                            MakeTable makeTable) {
    return SceneCompiler(std::move(desc), notes, run).run(isa, makeTable);
}

} // namespace chiaro
