#include "core/scene/accel.h"
#include "core/math/sampler.h"
#include "core/render/error.h"
#include "core/render/in_parallel.h"
#include "core/scene/accel_lanes.h"
#include "core/scene/accel_record.h"
#include <bit>
#include <cstring>
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <map>

namespace chiaro {
namespace {

constexpr std::size_t width = RayPacket::size;
constexpr std::size_t instanceBlock = 1024; // instances that one task attaches

struct DeviceDeleter {
    void operator()(RTCDevice d) const noexcept { rtcReleaseDevice(d); }
};
struct SceneDeleter {
    void operator()(RTCScene s) const noexcept { rtcReleaseScene(s); }
};
struct GeometryDeleter {
    void operator()(RTCGeometry g) const noexcept { rtcReleaseGeometry(g); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceDeleter>;
using SceneHandle = std::unique_ptr<RTCSceneTy, SceneDeleter>;
using GeometryHandle = std::unique_ptr<RTCGeometryTy, GeometryDeleter>;

void check(RTCDevice device) {
    const RTCError e = rtcGetDeviceError(device);
    if (e == RTC_ERROR_NONE) return;
    if (e == RTC_ERROR_OUT_OF_MEMORY)
        throw Error(Exit::resources, "the ray-tracing hierarchy does not fit into memory; use a smaller scene or more instances");
    throw Error(Exit::internal, fmt::format("Embree reports error {}", int(e)));
}

std::string bestIsa() {
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw"))
        return "avx512";
    if (__builtin_cpu_supports("avx2")) return "avx2";
    if (__builtin_cpu_supports("avx")) return "avx";
    return __builtin_cpu_supports("sse4.2") ? "sse4.2" : "sse2";
}

std::string chooseIsa(const std::string& wanted) {
    static const std::vector<std::string> known = {"sse2", "sse4.2", "avx", "avx2", "avx512"};
    const std::string best = bestIsa();
    if (wanted.empty()) return best;
    const auto rank = [](const std::string& isa) { return std::find(known.begin(), known.end(), isa) - known.begin(); };
    if (rank(wanted) == std::ssize(known))
        throw Error(Exit::usage, fmt::format("no instruction set \"{}\"; have {}", wanted, fmt::join(known, ", ")));
    if (rank(wanted) > rank(best)) throw Error(Exit::unsupported, fmt::format("this machine has no {}; its best is {}", wanted, best));
    return wanted;
}

// Embree aborts the process on a ray that is not finite.
bool usable(const Ray& r) noexcept {
    constexpr float far = 1e18f;
    return maxAbs(r.o) < far && maxAbs(r.d) <= 1.001f && r.tnear >= 0 && r.tnear < infinity && r.tnear <= r.tfar && finite(r.d) &&
           finite(r.o) && std::isfinite(r.time);
}

constexpr uint32_t noLot = ~0u; // in the place of an identity: the ray stops at everything that is there at all

uint32_t identity(const Ray& r) noexcept {
    const auto pair = [](float a, float b) { return uint64_t(std::bit_cast<uint32_t>(a)) << 32 | std::bit_cast<uint32_t>(b); };
    const uint32_t id =
        uint32_t(hashCombine(hashCombine(pair(r.o.x, r.o.y), pair(r.o.z, r.time)), hashCombine(pair(r.d.x, r.d.y), pair(r.d.z, 0))));
    return id == noLot ? 0 : id;
}

// The keys as Embree wants them: as decompositions, so that it turns along the great arc as Motion does.
void setMotion(RTCGeometry instance, const Motion& motion) {
    const std::span<const Motion::Key> keys = motion.keys();
    rtcSetGeometryTimeStepCount(instance, unsigned(keys.size()));
    for (unsigned i = 0; i < keys.size(); ++i) {
        const Motion::Key& k = keys[i];
        const auto stretch = [&k](int row, int column) { return float(k.stretch[row][column]); };
        RTCQuaternionDecomposition d;
        rtcInitQuaternionDecomposition(&d);
        rtcQuaternionDecompositionSetScale(&d, stretch(0, 0), stretch(1, 1), stretch(2, 2));
        rtcQuaternionDecompositionSetSkew(&d, stretch(0, 1), stretch(0, 2), stretch(1, 2));
        rtcQuaternionDecompositionSetQuaternion(&d, float(k.rotation[0]), float(k.rotation[1]), float(k.rotation[2]), float(k.rotation[3]));
        rtcQuaternionDecompositionSetTranslation(&d, float(k.translation.x), float(k.translation.y), float(k.translation.z));
        rtcSetGeometryTransformQuaternion(instance, i, &d);
        if (!fault(Fault::motionByMatrix)) continue;
        const Affine whole = Motion::compose(k);
        float m[12];
        for (int j = 0; j < 12; ++j) m[j] = float(whole.m[j / 4][j % 4]);
        rtcSetGeometryTransform(instance, i, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, m);
    }
}

bool countBytes(void* sum, ssize_t bytes, bool) { // Embree's way of telling what it takes and gives back
    static_cast<std::atomic<std::ptrdiff_t>*>(sum)->fetch_add(bytes, std::memory_order_relaxed);
    return true;
}

struct CutOut { // user data of a cut-out geometry
    const OpacityAt* opacity;
    uint32_t geometry;
};

void filterCutOut(const RTCFilterFunctionNArguments* a) {
    const auto& cut = *static_cast<const CutOut*>(a->geometryUserPtr);
    for (unsigned i = 0; i < a->N; ++i) {
        if (a->valid[i] == 0) continue;
        Hit hit;
        hit.geometry = cut.geometry;
        hit.triangle = RTCHitN_primID(a->hit, a->N, i);
        hit.u = RTCHitN_u(a->hit, a->N, i);
        hit.v = RTCHitN_v(a->hit, a->N, i);
        const float opacity = (*cut.opacity)(hit);
        const uint32_t id = RTCRayN_id(a->ray, a->N, i);
        if (opacity >= 1 || (id == noLot && opacity > 0)) continue;
        const uint64_t place = uint64_t(RTCHitN_instID(a->hit, a->N, i, 0)) << 32 | cut.geometry;
        const uint64_t h = hashCombine(hashCombine(id, place), hit.triangle);
        if (id == noLot || float(h >> 40) * 0x1p-24f >= opacity) a->valid[i] = 0;
    }
}

} // namespace

struct Accel::Impl {
    std::atomic<std::ptrdiff_t> bytes{0}; // outlives the device, which counts into it
    Device device;
    OpacityAt opacity;
    std::vector<CutOut> cutOuts; // stable: sized before the geometries point into it
    std::map<uint32_t, SceneHandle> meshes;
    SceneHandle top;
    uint32_t topCount = 0;
    std::vector<uint32_t> firstGeometry; // of each instance

    SceneHandle newScene() const {
        SceneHandle scene(rtcNewScene(device.get()));
        rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST); // without it 1 random ray in 500,000 leaks through an edge
        return scene;
    }
    void attach(RTCScene scene, const Geometry& g, uint32_t index, uint32_t id) {
        if (g.indices.empty()) return;
        const GeometryHandle handle(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
        rtcSetGeometryTimeStepCount(handle.get(), unsigned(1 + g.steps.size()));
        for (unsigned step = 0; step <= g.steps.size(); ++step)
            rtcSetSharedGeometryBuffer(handle.get(), RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3, g.positionsAt(step).data(), 0,
                                       sizeof(Vec3), g.positions.size() - 1);
        rtcSetSharedGeometryBuffer(handle.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, g.indices.data(), 0, 3 * sizeof(uint32_t),
                                   g.triangles());
        if (g.cutOut) {
            cutOuts[index] = {&opacity, index};
            rtcSetGeometryUserData(handle.get(), &cutOuts[index]);
            rtcSetGeometryIntersectFilterFunction(handle.get(), filterCutOut);
            rtcSetGeometryOccludedFilterFunction(handle.get(), filterCutOut);
        }
        rtcCommitGeometry(handle.get());
        rtcAttachGeometryByID(scene, handle.get(), id);
    }
    // The hierarchies of instanced meshes, side by side.
    void buildMeshes(std::span<const Geometry> geometries, std::span<const Instance> instances, const Executor* run) {
        std::vector<const Instance*> first; // of each mesh
        for (const Instance& i : instances)
            if (meshes.try_emplace(i.firstGeometry).second) first.push_back(&i);
        inParallel(run, first.size(), [&](uint64_t m) {
            const Instance& i = *first[m];
            SceneHandle& mesh = meshes.find(i.firstGeometry)->second;
            mesh = newScene();
            for (uint32_t k = 0; k < i.geometryCount; ++k) attach(mesh.get(), geometries[i.firstGeometry + k], i.firstGeometry + k, k);
            rtcCommitScene(mesh.get());
            check(device.get());
        });
    }
    void attach(const Instance& instance, const Motion* motion, uint32_t id) {
        const GeometryHandle handle(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(handle.get(), meshes.at(instance.firstGeometry).get());
        if (motion) {
            setMotion(handle.get(), *motion);
        } else {
            rtcSetGeometryTimeStepCount(handle.get(), 1);
            rtcSetGeometryTransform(handle.get(), 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, instance.toWorld.m);
        }
        rtcCommitGeometry(handle.get());
        rtcAttachGeometryByID(top.get(), handle.get(), id);
    }
    uint32_t rayId(const Ray& r) const noexcept { return cutOuts.empty() ? 0 : identity(r); }
    // Makes a packet ready for Embree, and how it is to be asked.
    RTCIntersectContext ready(TracePacket& p, uint32_t count, bool coherent) const noexcept {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        readyForEmbree(p, count);
        if (!cutOuts.empty())
            for (uint32_t k = 0; k < count; ++k) p.id[k] = identity(p.rays.ray(k));
        return context;
    }
    Hit nearest(const Ray& r, float time, uint32_t id) const noexcept {
        if (!usable(r)) return {};
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit q;
        q.ray = {r.o.x, r.o.y, r.o.z, r.tnear, r.d.x, r.d.y, r.d.z, time, r.tfar, ~0u, id, 0};
        q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(top.get(), &context, &q);
        return decode(q.hit.geomID, q.hit.primID, q.hit.instID[0], q.hit.u, q.hit.v, q.ray.tfar);
    }
    Hit decode(uint32_t geomId, uint32_t primId, uint32_t instId, float u, float v, float t) const noexcept {
        if (geomId == RTC_INVALID_GEOMETRY_ID) return {};
        if (instId == RTC_INVALID_GEOMETRY_ID) return {geomId, primId, Hit::none, u, v, t};
        const uint32_t instance = instId - topCount;
        return {firstGeometry[instance] + geomId, primId, instance, u, v, t};
    }
};

Accel::Accel(std::span<const Geometry> geometries, std::size_t top, std::span<const Instance> instances, std::span<const Motion> motions,
             Interval shutter, OpacityAt opacity, const std::string& isa, const Executor* run)
    : impl_(std::make_unique<Impl>()), isa_(chooseIsa(isa)), clock_(shutter) {
    impl_->device.reset(rtcNewDevice(fmt::format("isa={}", isa_).c_str()));
    if (!impl_->device) check(nullptr);
    rtcSetDeviceMemoryMonitorFunction(impl_->device.get(), countBytes, &impl_->bytes);
    impl_->opacity = std::move(opacity);
    impl_->topCount = uint32_t(top);
    moves_ = std::any_of(geometries.begin(), geometries.end(), [](const Geometry& g) { return g.deforms(); }) ||
             std::any_of(instances.begin(), instances.end(), [](const Instance& i) { return i.motion != Hit::none; });
    if (std::any_of(geometries.begin(), geometries.end(), [](const Geometry& g) { return g.cutOut; }))
        impl_->cutOuts.resize(geometries.size());
    impl_->buildMeshes(geometries, instances, run);
    impl_->top = impl_->newScene();
    for (uint32_t i = 0; i < top; ++i) impl_->attach(impl_->top.get(), geometries[i], i, i);
    impl_->firstGeometry.resize(instances.size());
    inParallel(run, (instances.size() + instanceBlock - 1) / instanceBlock, [&](uint64_t b) {
        for (std::size_t i = b * instanceBlock; i < std::min<std::size_t>((b + 1) * instanceBlock, instances.size()); ++i) {
            const Instance& instance = instances[i];
            impl_->firstGeometry[i] = instance.firstGeometry;
            impl_->attach(instance, instance.motion == Hit::none ? nullptr : &motions[instance.motion], uint32_t(top + i));
        }
        check(impl_->device.get()); // Embree keeps an error for the thread that made it
    });
    rtcCommitScene(impl_->top.get());
    check(impl_->device.get());
}
Accel::~Accel() = default;

std::size_t Accel::bytes() const noexcept { return std::size_t(std::max<std::ptrdiff_t>(0, impl_->bytes)); }

std::string Accel::version() { return RTC_VERSION_STRING; }

namespace {

SingleRay recorded(const Ray& r, float time, uint32_t id) noexcept {
    return {r.o.x, r.o.y, r.o.z, r.tnear, r.d.x, r.d.y, r.d.z, r.tfar, time, id};
}

} // namespace

Hit Accel::single(RayCall call, const Ray& r, uint32_t id) const noexcept {
    const float time = clock_.share(r.time);
    const Hit hit = impl_->nearest(r, time, id);
    if (RayRecord::on() && usable(r)) [[unlikely]]
        RayRecord::add(this, call, recorded(r, time, id), bool(hit), hit.t);
    return hit;
}
Hit Accel::intersect(const Ray& r) const noexcept { return single(RayCall::single, r, impl_->rayId(r)); }
Hit Accel::firstSurface(const Ray& r) const noexcept { return single(RayCall::surface, r, noLot); }

bool Accel::occluded(const Ray& r) const noexcept {
    if (!usable(r)) return true;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay q{r.o.x, r.o.y, r.o.z, r.tnear, r.d.x, r.d.y, r.d.z, clock_.share(r.time), r.tfar, ~0u, impl_->rayId(r), 0};
    rtcOccluded1(impl_->top.get(), &context, &q);
    if (RayRecord::on()) [[unlikely]]
        RayRecord::add(this, RayCall::shadowSingle, recorded(r, q.time, q.id), q.tfar < 0, 0);
    return q.tfar < 0;
}

namespace {

void copy(auto (&to)[width], const auto (&from)[width]) noexcept { std::memcpy(to, from, sizeof to); }

// While Embree looks at a packet, its times are shares of the shutter.
class InShares {
public:
    InShares(float (&time)[width], const ShutterClock& clock, bool moves) noexcept : time_(time), moves_(moves) {
        if (!moves) return;
        copy(seconds_, time);
        for (float& t : time_) t = clock.share(t);
    }
    ~InShares() {
        if (moves_) copy(time_, seconds_);
    }
    InShares(const InShares&) = delete;
    InShares& operator=(const InShares&) = delete;

private:
    float (&time_)[width];
    float seconds_[width];
    bool moves_;
};

} // namespace

void Accel::trace(TracePacket& p, uint32_t count, bool coherent) const noexcept {
    RTCIntersectContext context = impl_->ready(p, count, coherent);
    RTCRayHit16& q = reinterpret_cast<RTCRayHit16&>(p);
    {
        const InShares times(p.rays.time, clock_, moves_);
        if (RayRecord::on()) [[unlikely]] {
            const RayPacket before = p.rays;
            rtcIntersect16(p.asked, impl_->top.get(), &context, &q);
            recordClosest(this, coherent ? RayCall::coherent : RayCall::wide, q, before, p.asked);
        } else {
            rtcIntersect16(p.asked, impl_->top.get(), &context, &q);
        }
    }
    copy(p.hits.t, p.rays.tfar);
    if (impl_->firstGeometry.empty()) return;
    for (std::size_t k = 0; k < width; ++k) {
        if (p.hits.instance[k] == RTC_INVALID_GEOMETRY_ID) continue;
        p.hits.instance[k] -= impl_->topCount;
        p.hits.geometry[k] += impl_->firstGeometry[p.hits.instance[k]];
    }
}

uint32_t Accel::stopped(TracePacket& p, uint32_t count) const noexcept {
    RTCIntersectContext context = impl_->ready(p, count, false);
    RTCRay16& q = reinterpret_cast<RTCRay16&>(p);
    const InShares times(p.rays.time, clock_, moves_);
    if (RayRecord::on()) [[unlikely]] {
        const RayPacket before = p.rays;
        rtcOccluded16(p.asked, impl_->top.get(), &context, &q);
        recordShadow(this, q, before, p.asked);
    } else {
        rtcOccluded16(p.asked, impl_->top.get(), &context, &q);
    }
    return stoppedRays(p) & ((1u << count) - 1);
}

void Accel::intersect(const RayPacket& rays, HitPacket& hits, uint32_t count, bool coherent) const noexcept {
    TracePacket p;
    p.rays = rays;
    trace(p, count, coherent);
    hits = p.hits;
}
uint32_t Accel::occluded(const RayPacket& rays, uint32_t count) const noexcept {
    TracePacket p;
    p.rays = rays;
    return stopped(p, count);
}

void Accel::intersect(const RayPacket& rays, std::span<Hit> hits, bool coherent) const noexcept {
    HitPacket packet;
    intersect(rays, packet, uint32_t(hits.size()), coherent);
    for (std::size_t k = 0; k < hits.size(); ++k) hits[k] = packet.geometry[k] == Hit::none ? Hit{} : packet.hit(k);
}

void Accel::intersect(std::span<const Ray> rays, std::span<Hit> hits, bool coherent) const noexcept {
    for (std::size_t first = 0; first < rays.size(); first += width) {
        const std::size_t n = std::min(width, rays.size() - first);
        RayPacket packet{};
        for (std::size_t k = 0; k < n; ++k) packet.set(k, rays[first + k]);
        intersect(packet, hits.subspan(first, n), coherent);
    }
}

void Accel::occluded(const RayPacket& rays, std::span<uint8_t> answers) const noexcept {
    const uint32_t stopped = occluded(rays, uint32_t(answers.size()));
    for (std::size_t k = 0; k < answers.size(); ++k) answers[k] = stopped >> k & 1;
}

void Accel::occluded(std::span<const Ray> rays, std::span<uint8_t> answers) const noexcept {
    for (std::size_t first = 0; first < rays.size(); first += width) {
        const std::size_t n = std::min(width, rays.size() - first);
        RayPacket packet{};
        for (std::size_t k = 0; k < n; ++k) packet.set(k, rays[first + k]);
        occluded(packet, answers.subspan(first, n));
    }
}

RayAnswers Accel::replay(const RayBlock& block) noexcept { return traceAgain(block, block.accel->impl_->top.get()); }
RayAnswers Accel::readThrough(const RayBlock& block) noexcept { return traceAgain(block, nullptr); }

} // namespace chiaro
