// chiaro bake with a pre-pass: the same solution as for a picture, in the same file, and the light of the path tracer where the field is
// all that an integrator lacks.
#include "materials/bsdf.h"
#include "program.h"
#include "scenes/builtin.h"
#include "tests/scene_kit.h"
#include "tools/bake/site_field.h"
#include <cmath>
#include <nlohmann/json.hpp>

using namespace program;
using nlohmann::json;

namespace {

Outcome bake(const Folder& folder, std::vector<std::string> more) {
    std::vector<std::string> words{"bake", "@cornell", "--size", "48", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run(folder, words);
}
double irradiance(const Outcome& o) { return json::parse(o.out)["meanIrradiance"][1]; }

// Remembers in which state it was asked.
struct Listener final : chiaro::Prepass {
    void solve(const chiaro::Work&) override {}
    void addIndirect(const chiaro::PathClasses&, const chiaro::Hit&, const chiaro::SurfacePoint&, const chiaro::Bsdf&,
                     chiaro::PathState eye, const chiaro::Spectrum&, chiaro::Outputs&) const noexcept override {
        heard = eye;
    }
    void save(chiaro::Writer&) const override {}
    void load(const chiaro::Work&, chiaro::Reader&) override {}
    mutable chiaro::PathState heard = 0;
};

} // namespace

TEST_SUITE("bake-prepass") {
    TEST_CASE("one solution for pictures and bakes") {
        if (absent()) return;
        const Folder folder;
        const std::vector<std::string> field{"-i", "distributed", "--prepass", "radiosity:patches=400", "--prepass-file", "room.prepass"};
        std::vector<std::string> words{"render", "@cornell", "--size", "32x32", "--spp", "1", "-o", "a.exr", "-q"};
        words.insert(words.end(), field.begin(), field.end());
        REQUIRE(run(folder, words).code == 0);
        const std::string stored = readAll(folder / "room.prepass");
        std::vector<std::string> again = field;
        again.insert(again.end(), {"--spp", "4", "-o", "kept.glb"});
        const Outcome loaded = bake(folder, again);
        INFO(loaded.err);
        REQUIRE(loaded.code == 0);
        CHECK(contains(loaded.err, "loaded from room.prepass"));
        CHECK(readAll(folder / "room.prepass") == stored); // nothing was added
        const Outcome solved =
            bake(folder, {"-i", "distributed", "--prepass", "radiosity:patches=400", "--spp", "4", "-o", "solved.glb", "-q"});
        REQUIRE(solved.code == 0);
        CHECK(readAll(folder / "kept.irradiance.exr").size() > 0);
        CHECK(irradiance(loaded) == irradiance(solved));
        // The file alone says which pre-pass; other depths are other solutions, kept beside it.
        REQUIRE(bake(folder, {"-i", "whitted", "--prepass-file", "room.prepass", "--spp", "1", "-q", "-o", "w.glb"}).code == 0);
        CHECK(readAll(folder / "room.prepass") == stored);
        REQUIRE(bake(folder, {"-i", "distributed", "--prepass-file", "room.prepass", "--max-depth", "3", "--spp", "1", "-q"}).code == 0);
        CHECK(readAll(folder / "room.prepass").size() > stored.size());
    }

    TEST_CASE("a bake's file serves pictures; what does not belong to it is refused") {
        if (absent()) return;
        const Folder folder;
        REQUIRE(
            bake(folder, {"-i", "distributed", "--prepass", "photon:count=20k", "--prepass-file", "p.prepass", "--spp", "1", "-q"}).code ==
            0);
        const Outcome render = run(folder, {"render", "@cornell", "-i", "distributed", "--prepass-file", "p.prepass", "--size", "16x16",
                                            "--spp", "1", "-o", "a.exr"});
        INFO(render.err);
        CHECK(render.code == 0);
        CHECK(contains(render.err, "loaded from p.prepass"));
        const Outcome other = run(folder, {"bake", "@furnace", "-i", "distributed", "--prepass-file", "p.prepass", "-q"});
        CHECK(other.code == 3);
        CHECK(contains(other.err, "another scene"));
        const Outcome none = bake(folder, {"-i", "path", "--prepass", "radiosity", "-q"});
        CHECK(none.code == 3);
        CHECK(contains(none.err, "take"));
        folder.write("bad.prepass", "not a solution");
        CHECK(bake(folder, {"-i", "distributed", "--prepass-file", "bad.prepass", "-q"}).code == 4);
    }

    TEST_CASE("with the field of a pre-pass the classics bake the light of the path tracer") {
        if (absent()) return;
        const Folder folder;
        const auto mean = [&](std::vector<std::string> how) {
            how.insert(how.end(), {"--spp", "64", "-q", "-o", "x.glb"});
            const Outcome o = bake(folder, how);
            INFO(o.err);
            REQUIRE(o.code == 0);
            return irradiance(o);
        };
        const double path = mean({"-i", "path"}), alone = mean({"-i", "distributed", "--light", "all"}),
                     radiosity = mean({"-i", "distributed", "--prepass", "radiosity"}),
                     photon = mean({"-i", "distributed", "--prepass", "photon:count=200k"});
        CAPTURE(path);
        CAPTURE(radiosity);
        CAPTURE(photon);
        CHECK(std::fabs(radiosity / path - 1) < 0.01);
        CHECK(std::fabs(photon / path - 1) < 0.02);
        CHECK(std::fabs(alone / path - 1) > 0.05); // without it they lack it
        // Up to a depth: the site is the last scattering, for the field too.
        const double pathTwo = mean({"-i", "path", "--max-depth", "3"}),
                     fieldTwo = mean({"-i", "distributed", "--prepass", "radiosity", "--max-depth", "3"});
        CAPTURE(pathTwo);
        CAPTURE(fieldTwo);
        CHECK(pathTwo < path);
        CHECK(std::fabs(fieldTwo / pathTwo - 1) < 0.01);
    }

    TEST_CASE("the states of a bake's rays are those of the eye behind the site") {
        using namespace chiaro;
        const auto scene = test::compiled(findBuiltin("@cornell")->make());
        for (const uint32_t depth : {unlimitedDepth, 2u, 5u}) {
            PathQuery rays, picture;
            picture.maxDepth = depth;
            rays.within = "L .+ E";
            rays.maxDepth = depth == unlimitedDepth ? depth : depth - 1;
            const PathClasses baker = PathClasses::make(rays), solved = PathClasses::make(picture);
            const auto listener = std::make_shared<Listener>();
            for (const bool behind : {true, false}) {
                if (!behind && depth != unlimitedDepth) continue; // then both depths would be the same
                const bake::SiteField field(listener, baker, solved, behind);
                PathState a = baker.eye(), b = behind ? solved.eye(solved.eye(), Event::DR) : solved.eye();
                const Ray ray{{0, 0, 0}, 0, {0, 0, -1}, infinity, 0};
                const Hit hit = scene->intersect(ray);
                REQUIRE(hit);
                const SurfacePoint at = scene->point(hit, ray);
                Wavelengths lambda;
                const Bsdf bsdf = shade(*scene, at, -ray.d, {}, lambda);
                Outputs out{FilmLayout{}};
                for (const Event e : {Event::SR, Event::GR, Event::DR, Event::DT}) {
                    listener->heard = 0;
                    field.addIndirect(baker, hit, at, bsdf, a, Spectrum(1), out);
                    CHECK(listener->heard == b);
                    a = baker.eye(a, e);
                    b = solved.eye(b, e);
                    if (a == 0 || b == 0) break;
                }
            }
        }
    }
}
