// Masks and layers in pictures of the path tracer: the layers of a split sum to the picture, masks to the whole, each mask shows its paths.
#include "core/render/path_classes.h"
#include "scenes/builtin.h"
#include "tests/scene_kit.h"
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <functional>
#include <map>

using namespace chiaro;
using namespace chiaro::test;

namespace {

struct Stage {
    std::unique_ptr<const Scene> scene;
    CameraDesc camera;
};
Stage stage(std::string_view name) {
    std::unique_ptr<const Scene> scene = compiled(findBuiltin(name)->make());
    const CameraDesc camera = scene->cameras()[0];
    return {std::move(scene), camera};
}

PathQuery query(std::string paths, std::string split = {}) {
    PathQuery q;
    q.paths = std::move(paths);
    q.split = std::move(split);
    q.maxDepth = 12;
    return q;
}

std::unique_ptr<const Film> picture(const Stage& s, const PathQuery& q, Settings settings) {
    Bench bench(*s.scene, s.camera, settings);
    bench.classes = PathClasses::make(q);
    FilmLayout layout = bench.layout();
    layout.layers = bench.classes.layerNames();
    auto film = std::make_unique<Film>(layout);
    bench.render(*film);
    CHECK(film->dropped() == 0);
    return film;
}
Settings settings(uint32_t spp, uint64_t seed = 0) {
    Settings s;
    s.width = s.height = 64;
    s.spp = spp;
    s.seed = seed;
    return s;
}

using Value = std::function<Spectrum(Pixel)>;
// The largest difference of a channel of a pixel between two pictures, relative to the pixel's brightest channel.
double difference(const Film& like, const Value& a, const Value& b) {
    const Rect c = like.layout().crop;
    double most = 0;
    for (uint32_t y = c.y0; y < c.y1; ++y)
        for (uint32_t x = c.x0; x < c.x1; ++x) {
            const Spectrum va = a({x, y}), vb = b({x, y});
            for (int i = 0; i < 3; ++i)
                if (va[i] != vb[i])
                    most = std::max(most, std::abs(double(va[i]) - double(vb[i])) / std::max(maxComponent(va), maxComponent(vb)));
        }
    return most;
}
Value beauty(const Film& f) {
    return [&f](Pixel p) { return f.mean(p); };
}
Value layer(const Film& f, std::size_t which) {
    return [&f, which](Pixel p) { return f.mean(p, int(which)); };
}
Value layerSum(const Film& f) {
    return [&f](Pixel p) {
        Spectrum sum(0);
        for (std::size_t i = 0; i < f.layout().layers.size(); ++i) sum += f.mean(p, int(i));
        return sum;
    };
}
Spectrum total(const Film& f, const Value& v) {
    const Rect c = f.layout().crop;
    Spectrum sum(0);
    for (uint32_t y = c.y0; y < c.y1; ++y)
        for (uint32_t x = c.x0; x < c.x1; ++x) sum += v({x, y});
    return sum;
}
std::map<std::string, Spectrum> totals(const Film& f) {
    std::map<std::string, Spectrum> all;
    for (std::size_t i = 0; i < f.layout().layers.size(); ++i) all[f.layout().layers[i]] = total(f, layer(f, i));
    return all;
}

} // namespace

TEST_SUITE("path_classes") {
    TEST_CASE("without dice a split changes no sample: layers sum to the picture without a split") {
        const Stage s = stage("@cornell-spheres"); // matt, mirror and clear glass: D and G never share a vertex
        const auto wholeFilm = picture(s, query(""), settings(64));
        const Film& whole = *wholeFilm;
        for (const std::string split : {"paths", "bounces", "direct,indirect", "caustic=L S+ D E,rest"}) {
            CAPTURE(split);
            const auto partsFilm = picture(s, query("", split), settings(64));
            const Film& parts = *partsFilm;
            CHECK(difference(whole, beauty(whole), beauty(parts)) < 1e-5);
            CHECK(difference(whole, beauty(parts), layerSum(parts)) < 1e-5);
            CHECK(total(parts, layer(parts, 0)) == Spectrum(0)); // no light path is "other"
        }
    }

    TEST_CASE("a layer is the picture of its mask, bit by bit where no dice are thrown") {
        const Stage s = stage("@cornell-spheres");
        const auto bouncesFilm = picture(s, query("", "bounces"), settings(16));
        const Film& bounces = *bouncesFilm;
        for (const std::size_t depth : {0u, 1u, 2u, 5u}) {
            CAPTURE(depth);
            const auto aloneFilm = picture(s, query("L .{" + std::to_string(depth) + "} E"), settings(16));
            const Film& alone = *aloneFilm;
            CHECK(difference(bounces, layer(bounces, depth + 1), beauty(alone)) == 0);
        }
        const auto deepFilm = picture(s, query("L .{8,} E"), settings(16));
        const Film& deep = *deepFilm;
        CHECK(difference(bounces, layer(bounces, 9), beauty(deep)) < 1e-5);
    }

    TEST_CASE("emission, direct light, colour bleeding, caustics and the rest are the full picture") {
        const Stage s = stage("@cornell-spheres");
        const auto wholeFilm = picture(s, query(""), settings(64));
        const Film& whole = *wholeFilm;
        const std::string masks[] = {"L E", "L D E", "L D D+ E", "L S+ D E"};
        std::vector<std::unique_ptr<const Film>> films;
        std::string all;
        for (const std::string& m : masks) {
            films.push_back(picture(s, query(m), settings(64)));
            CHECK(luminance(total(*films.back(), beauty(*films.back()))) > 0);
            all += (all.empty() ? "" : "|") + m;
        }
        PathQuery rest = query("");
        rest.without = all;
        films.push_back(picture(s, rest, settings(64)));
        const Value sum = [&films](Pixel p) {
            Spectrum v(0);
            for (const auto& f : films) v += f->mean(p);
            return v;
        };
        CHECK(difference(whole, beauty(whole), sum) < 1e-5);
    }

    TEST_CASE("each class shows where its light goes") {
        const Stage s = stage("@cornell-spheres");
        const auto partsFilm = picture(s, query("", "paths"), settings(64));
        const Film& parts = *partsFilm;
        std::map<std::string, Spectrum> of = totals(parts);
        for (const char* lit : {"emission", "specular", "direct-diffuse", "caustics", "colour-bleeding", "reflections", "rest"}) {
            CAPTURE(lit);
            CHECK(luminance(of.at(lit)) > 0);
        }
        for (const char* dark : {"direct-glossy", "glossy-caustics", "indirect-glossy"}) {
            CAPTURE(dark);
            CHECK(of.at(dark) == Spectrum(0));
        }
        CHECK(luminance(of.at("direct-diffuse")) > luminance(of.at("caustics")));
    }

    TEST_CASE("with dice the layers still sum to their picture, and that to the picture without a split within the noise") {
        const Stage s = stage("@veach-mis"); // glossy plates with a matt part
        const auto wholeFilm = picture(s, query(""), settings(64, 1));
        const Film& whole = *wholeFilm;
        const auto partsFilm = picture(s, query("", "paths"), settings(64, 2));
        const Film& parts = *partsFilm;
        CHECK(difference(parts, beauty(parts), layerSum(parts)) < 1e-5);
        const Film::Mean a = whole.meanLuminance(), b = parts.meanLuminance();
        CAPTURE(a.value);
        CAPTURE(b.value);
        CAPTURE(a.error);
        CAPTURE(b.error);
        CHECK(std::abs(a.value - b.value) < 4 * std::hypot(a.error, b.error));
        // Disjoint masks, other dice in each.
        double sum = 0, variance = 0;
        for (const char* mask : {"L .* D E", "L .* G E", "L (.* S)? E"}) {
            const auto fFilm = picture(s, query(mask), settings(64, 3));
            const Film& f = *fFilm;
            const Film::Mean m = f.meanLuminance();
            sum += m.value;
            variance += m.error * m.error;
        }
        CAPTURE(sum);
        CHECK(std::abs(sum - a.value) < 4 * std::sqrt(variance + a.error * a.error));
    }
} // TEST_SUITE
