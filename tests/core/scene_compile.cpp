// Compiling a scene: recentring, placement, mirrored nodes, instances against baked meshes, degenerate input.
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

// A bumpy piece of surface with every attribute, far from symmetrical.
PrimitiveDesc rich() {
    PrimitiveDesc p = shapes::sphere(1, 2);
    stats::Random u(5);
    for (std::size_t i = 0; i < p.positions.size(); ++i) {
        Vec3& v = p.positions[i];
        v = v * (1 + 0.1f * u());
        p.normals[i] = normalize(p.normals[i] + Vec3{u(), u(), u()} * 0.2f);
        const Frame f = Frame::about(p.normals[i]);
        p.tangents.push_back({f.x.x, f.x.y, f.x.z, i % 2 ? 1.f : -1.f});
        p.colors.push_back({u(), u(), u(), 1});
    }
    for (auto& uv : p.uv) {
        uv.clear();
        for (std::size_t i = 0; i < p.positions.size(); ++i) uv.push_back({p.positions[i].x, p.positions[i].y * 2});
    }
    return p;
}
MaterialDesc mapped(SceneDesc& scene) { // a normal map asks for tangents
    MaterialDesc m = shapes::diffuse("grey", Spectrum(0.5f));
    const uint8_t texels[] = {128, 128, 255};
    m.normalTexture.texture = addTexture(scene, 1, 1, 3, texels);
    return m;
}
// The mesh once (baked into world space) or under two equal nodes (instanced).
std::unique_ptr<const Scene> placed(const PrimitiveDesc& shape, const Affine& m, bool instanced) {
    SceneDesc desc;
    const int grey = shapes::add(desc, mapped(desc));
    const std::vector<Affine> places(instanced ? 2 : 1, m);
    addInstances(desc, shape, grey, places);
    return compiled(std::move(desc));
}
struct Difference {
    float distance = 0, position = 0, ng = 0, ns = 0, tangent = 0, uv = 0, color = 0;
    int missed = 0, sign = 0, compared = 0;
};
// The same places of the mesh in both scenes; where a mirroring node was baked, the winding and with it u and v are exchanged.
Difference compare(const Scene& baked, const Scene& instanced, bool mirrored) {
    Difference d;
    stats::Random u(9);
    const auto direction = [&] { return normalize(Vec3{u() - 0.5f, u() - 0.5f, u() - 0.5f}); };
    for (int i = 0; i < 4000; ++i) {
        const Vec3 out = direction();
        const Ray r = rayFrom(out * (3 * baked.radius()), -out + direction() * 0.05f);
        const Hit h = baked.intersect(r), other = instanced.intersect(r);
        d.missed += bool(h) != bool(other);
        if (!h) continue;
        Hit g = h;
        g.instance = other.instance;
        if (mirrored) std::swap(g.u, g.v);
        const SurfacePoint p = baked.point(h, r), q = instanced.point(g, r);
        ++d.compared;
        d.distance = std::max(d.distance, std::fabs(h.t - other.t) * absDot(r.d, p.ng) / baked.radius());
        d.position = std::max(d.position, maxAbs(p.p - q.p) / baked.radius());
        d.ng = std::max(d.ng, maxAbs(p.ng - q.ng));
        d.ns = std::max(d.ns, maxAbs(p.ns - q.ns));
        d.tangent = std::max(d.tangent, maxAbs(p.tangent - q.tangent) / length(p.tangent));
        d.uv = std::max({d.uv, std::fabs(p.uv[0].x - q.uv[0].x), std::fabs(p.uv[1].y - q.uv[1].y)});
        d.color = std::max({d.color, std::fabs(p.color.x - q.color.x), std::fabs(p.color.z - q.color.z)});
        d.sign += p.tangentSign != q.tangentSign;
    }
    return d;
}
struct Place {
    std::string name;
    Affine m;
};
std::vector<Place> places() {
    const Affine turn = rotation({1, 2, 3}, 1.1), move = shapes::translation({10, -20, 5});
    return {{"identity", {}},
            {"rotated", turn},
            {"moved", move * turn},
            {"scaled", move * turn * scaling(3, 3, 3)},
            {"not uniform", move * turn * scaling(1, 4, 0.25)},
            {"mirrored", move * turn * scaling(-1, 1, 1)},
            {"mirrored and not uniform", move * scaling(1, 2, -1) * turn},
            {"point reflection", scaling(-2, -2, -2)},
            {"small", scaling(1e-4, 1e-4, 2e-4) * turn},
            {"large", scaling(1e5, 1e5, 3e5) * turn}};
}

} // namespace

TEST_SUITE("compile") {

    TEST_CASE("the middle of the bounds becomes the origin, for geometry, lights and cameras") {
        SceneDesc desc;
        const int grey = shapes::add(desc, shapes::diffuse("grey", Spectrum(0.5f)));
        shapes::add(desc, "box", shapes::box({1, 2, 3}), grey, shapes::translation({1e5, -2e5, 3e5}));
        shapes::addCamera(desc, "main", 1, shapes::translation({1e5, -2e5, 3e5 + 10}));
        PunctualDesc lamp;
        lamp.toWorld = shapes::translation({1e5, -2e5 + 5, 3e5});
        desc.lights.push_back(lamp);
        const auto scene = compiled(std::move(desc));
        CHECK(scene->centre() == Vec3d{1e5, -2e5, 3e5});
        CHECK(scene->radius() == doctest::Approx(std::sqrt(14.0)));
        CHECK(Camera(scene->cameras()[0], 1, 1).position() == Vec3{0, 0, 10});
        const auto s = scene->lights().sampleTowards(receiver(*scene, {1e5, -2e5, 3e5}, {0, 1, 0}), 0.5, {0.5f, 0.5f});
        REQUIRE(s);
        CHECK(s->wi == Vec3{0, 1, 0});
        CHECK(s->radiance[0] == doctest::Approx(1 / 25.0));
        const Hit h = scene->intersect(rayFrom({0, 0, 10}, {0, 0, -1}));
        CHECK(h.t == doctest::Approx(7).epsilon(1e-6));
    }

    TEST_CASE("a mesh under several nodes is the mesh baked at each: position, normals, UVs, tangents") {
        for (const Place& k : places()) {
            CAPTURE(k.name);
            const PrimitiveDesc shape = rich();
            const auto baked = placed(shape, k.m, false), instanced = placed(shape, k.m, true);
            CHECK(baked->counts().triangles == instanced->counts().triangles);
            CHECK(2 * baked->counts().trianglesDrawn == instanced->counts().trianglesDrawn);
            const Difference d = compare(*baked, *instanced, k.m.determinant() < 0);
            CHECK(d.compared > 1500);
            CHECK(d.missed <= 2); // rays along the silhouette
            CHECK(d.distance < 4e-6f);
            CHECK(d.position < 1e-6f);
            CHECK(d.ng < 1e-5f);
            CHECK(d.ns < 1e-5f);
            CHECK(d.tangent < 1e-5f);
            CHECK(d.uv < 1e-6f);
            CHECK(d.color < 1e-6f);
            CHECK(d.sign == 0);
        }
    }

    TEST_CASE("under any node the front stays the front and normals stand on their surface") {
        for (const Place& k : places())
            for (const bool instanced : {false, true}) {
                CAPTURE(k.name);
                CAPTURE(instanced);
                const auto scene = placed(shapes::sphere(1, 4), k.m, instanced);
                stats::Random u(3);
                int checked = 0, inward = 0, off = 0;
                for (int i = 0; i < 1000; ++i) {
                    const Vec3 d = normalize(Vec3{u() - 0.5f, u() - 0.5f, u() - 0.5f});
                    const Ray r = rayFrom(d * (-3 * scene->radius()), d);
                    const Hit h = scene->intersect(r);
                    REQUIRE(h);
                    const SurfacePoint s = scene->point(h, r);
                    ++checked;
                    inward += !(dot(s.ng, s.p) > 0) || !(dot(s.ns, s.p) > 0); // an ellipsoid about the origin: outside is away from it
                    // Its exact normal at p is M^-T M^-1 p; the cofactors of M are det M^-T.
                    off += !(dot(s.ns, s.ng) > 0.98f) || std::fabs(length(s.ns) - 1) > 1e-5f || std::fabs(length(s.ng) - 1) > 1e-5f;
                }
                CHECK(checked == 1000);
                CHECK(inward == 0);
                CHECK(off == 0);
            }
    }

    TEST_CASE("a mirrored mesh is the mirror image: normals, tangent frames") {
        const PrimitiveDesc shape = rich();
        const Affine mirror = scaling(-1, 1, 1);
        const auto reflect = [](const Vec3& v) { return Vec3{-v.x, v.y, v.z}; };
        for (const bool instanced : {false, true}) {
            CAPTURE(instanced);
            const auto plain = placed(shape, {}, instanced), mirrored = placed(shape, mirror, instanced);
            stats::Random u(4);
            float ng = 0, ns = 0, tangent = 0, bitangent = 0;
            for (int i = 0; i < 1000; ++i) {
                const Vec3 d = normalize(Vec3{u() - 0.5f, u() - 0.5f, u() - 0.5f});
                const Ray r = rayFrom(d * -3.f, d), m = rayFrom(reflect(r.o), reflect(d));
                const Hit h = plain->intersect(r), g = mirrored->intersect(m);
                REQUIRE((h && g));
                const SurfacePoint p = plain->point(h, r), q = mirrored->point(g, m);
                if (length(reflect(p.ng) - q.ng) > 1e-3f) continue;
                ng = std::max(ng, length(reflect(p.ng) - q.ng));
                ns = std::max(ns, length(reflect(p.ns) - q.ns));
                tangent = std::max(tangent, length(reflect(p.tangent) - q.tangent));
                bitangent =
                    std::max(bitangent, length(reflect(cross(p.ns, p.tangent) * p.tangentSign) - cross(q.ns, q.tangent) * q.tangentSign));
            }
            CHECK(ng < 1e-5f);
            CHECK(ns < 1e-5f);
            CHECK(tangent < 1e-5f);
            CHECK(bitangent < 1e-5f);
        }
    }

    TEST_CASE("without tangents the derivatives by UV speak") {
        for (const bool instanced : {false, true}) {
            SceneDesc desc;
            const int grey = shapes::add(desc, mapped(desc));
            PrimitiveDesc flat = square(1);
            for (Point2& uv : flat.uv[0]) uv = {uv.x * 2, uv.y * 4};
            const std::vector<Affine> at(instanced ? 2 : 1, shapes::translation({3, 3, 3}) * scaling(5, 1, 1));
            addInstances(desc, flat, grey, at);
            const auto scene = compiled(std::move(desc));
            const Ray r = rayFrom({0.3f, 0.2f, 2}, {0, 0, -1});
            const SurfacePoint s = scene->point(scene->intersect(r), r);
            CHECK(lengthSquared(s.tangent) == 0);
            CHECK(std::fabs(s.dpdu.x) == doctest::Approx(5)); // 10 m a unit of the square, 2 units of u
            CHECK(std::fabs(s.dpdv.y) == doctest::Approx(0.5));
            CHECK(std::fabs(s.dpdu.y) < 1e-6f);
        }
    }

    TEST_CASE("an empty scene answers with the background and says so") {
        Diagnostics notes;
        SceneDesc desc;
        desc.name = "void.glb";
        desc.environment = uniformSky(2);
        const auto scene = Scene::compile(std::move(desc), notes);
        REQUIRE(notes.warnings().size() == 1);
        CHECK(notes.warnings()[0].find("no triangles") != std::string::npos);
        const Ray r = rayFrom({1, 2, 3}, {0, 1, 0});
        CHECK(!scene->intersect(r));
        CHECK(!scene->occluded(r));
        CHECK(scene->lights().miss(r, nullptr).radiance == Spectrum(2));
        CHECK(scene->radius() == 1);
        CHECK(scene->counts().triangles == 0);
        const auto black = compiled(SceneDesc{});
        CHECK(!black->lights().sampleTowards(receiver(*black, {}, {0, 1, 0}), 0.5, {0.5f, 0.5f}));
        CHECK(!black->lights().miss(r, nullptr));
        CHECK(black->lights().power() == 0);
    }

    TEST_CASE("degenerate triangles, flat nodes and unused meshes do no harm") {
        for (const bool instanced : {false, true}) {
            SceneDesc desc;
            const int lamp = shapes::add(desc, shapes::lamp("lamp", Spectrum(3)));
            PrimitiveDesc p = shapes::joined(triangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0}), triangle({1, 1, 0}, {1, 1, 0}, {1, 1, 0}));
            p = shapes::joined(p, square(1));
            const std::vector<Affine> at(instanced ? 2 : 1);
            addInstances(desc, p, lamp, at);
            const std::vector<Affine> flat(2, scaling(1, 0, 1)), point(2, scaling(0, 0, 0));
            addInstances(desc, shapes::sphere(1, 1), lamp, flat);
            addInstances(desc, shapes::sphere(1, 1), lamp, point);
            shapes::add(desc, "flat", shapes::sphere(1, 1), lamp, shapes::translation({0, 0, -3}) * scaling(1, 1, 0));
            desc.meshes.push_back({"unused", {square(1)}});
            desc.meshes.push_back({"empty", {}});
            desc.instances.push_back({int(desc.meshes.size()) - 1, {}, "empty"});
            const auto scene = compiled(std::move(desc));
            const SurfacePoint at0 = receiver(*scene, {0.1, 0.2, 2}, {0, 0, -1});
            stats::Random u(1);
            int bad = 0;
            for (int i = 0; i < 2000; ++i) {
                const Ray r = rayFrom(Vec3{u() - 0.5f, u() - 0.5f, u() * 4 - 2} * 3.f, Vec3{u() - 0.5f, u() - 0.5f, u() - 0.5f});
                if (const Hit h = scene->intersect(r)) {
                    const SurfacePoint s = scene->point(h, r);
                    bad += !finite(s.p) || !finite(s.ng) || !finite(s.ns) || !std::isfinite(s.error);
                    bad += !finite(scene->lights().hit(s, -r.d, &at0).radiance);
                }
                const double pick = double(u());
                const float v = u();
                if (const auto s = scene->lights().sampleTowards(at0, pick, {v, u()}))
                    bad += !finite(s->radiance) || !finite(s->wi) || !(s->pdfW > 0) || !std::isfinite(s->pdfW);
            }
            CHECK(bad == 0);
        }
    }

    TEST_CASE("a scene too wide for floats is refused with its size") {
        SceneDesc desc;
        shapes::add(desc, "far", square(1), shapes::add(desc, shapes::diffuse("grey", Spectrum(0.5f))), scaling(1e16, 1e16, 1));
        desc.name = "huge.glb";
        try {
            compiled(std::move(desc));
            FAIL("compiled");
        } catch (const Error& e) {
            CHECK(e.code == Exit::unsupported);
            CHECK(std::string(e.what()).find("huge.glb") != std::string::npos);
            CHECK(std::string(e.what()).find("scale it down") != std::string::npos);
        }
    }
}
