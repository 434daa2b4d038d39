// Masks and layers in lanes: sample for sample those of the path tracer that follows its paths one by one.
#include "core/render/wide_classes.h"
#include "tests/render/path_wide.h"

using namespace chiaro;
using namespace chiaro::test;

namespace {

struct Query {
    const char *paths = "", *split = "";
    uint32_t maxDepth = unlimitedDepth;
    PathClasses classes() const { return asked(paths, split, maxDepth); }
};
// What users ask for, and every way in which an automaton can end, part or forget.
const Query queries[] = {{"L D* E"},
                         {"L .* S E"},
                         {"L (D|G) E"},
                         {"L G+ E"},
                         {"L . .+ E"},
                         {"L S* D E", "", 3},
                         {"La .* E"},
                         {"(Ld|Le) .* (DR|ST) E"},
                         {"L E"},
                         {"", "paths"},
                         {"", "bounces"},
                         {"", "direct,indirect", 4},
                         {"", "lamps=La .* E,spots=Ld .* E,sky=Le .* E"},
                         {"L .* (D|S) E", "paths"},
                         {"", "D=L .* D E,G=L .* G E,S=L .* S E", 5}};

std::unique_ptr<Film> filmOf(const Scene& scene, const Settings& s, const Query& query, const std::string& options = "") {
    Bench bench(scene, scene.cameras()[0], s);
    bench.classes = query.classes();
    FilmLayout layout = bench.layout();
    layout.layers = bench.classes.layerNames();
    auto film = std::make_unique<Film>(layout);
    bench.render(*film, options.empty() ? "path" : "path:" + options);
    CHECK(film->dropped() == 0);
    return film;
}
int layersOf(const Film& film) { return std::max(1, int(film.layout().layers.size())); }
template <class F> void eachPixel(const Film& film, F&& f) {
    const Rect c = film.layout().crop;
    for (uint32_t y = c.y0; y < c.y1; ++y)
        for (uint32_t x = c.x0; x < c.x1; ++x) f(Pixel{x, y});
}
// Share of pixels in which a layer differs by more than a thousandth; and by how much the layers' means do, over the picture's.
struct Difference {
    double share = 0, mean = 0, albedo = 0;
};
Difference difference(const Film& a, const Film& b) {
    Difference d;
    std::vector<double> sums(std::size_t(layersOf(a)), 0);
    double light = 0;
    eachPixel(a, [&](Pixel p) {
        bool differs = false;
        for (int layer = 0; layer < layersOf(a); ++layer) {
            const float x = luminance(a.mean(p, layer)), y = luminance(b.mean(p, layer));
            differs |= !(std::fabs(x - y) <= 1e-3f * (x + 1e-3f));
            sums[std::size_t(layer)] += double(y) - double(x);
            light += double(x);
        }
        d.share += differs;
        for (const Aov v : {Aov::albedo, Aov::normal})
            for (std::size_t c = 0; c < 3; ++c) d.albedo += std::fabs(double(a.aov(p, v)[c]) - double(b.aov(p, v)[c])) / 6;
    });
    for (const double sum : sums) d.mean = std::max(d.mean, std::fabs(sum));
    if (light > 0) d.mean /= light;
    const auto n = double(a.layout().crop.area());
    d.share /= n;
    d.albedo /= n;
    return d;
}
// One sample a pixel: what differs is a path, not an average.
void same(const Scene& scene, const Query& query, const std::string& options = "") {
    Settings s{64, 48, 1};
    s.filter = FilterKind::blackmanHarris;
    const auto a = filmOf(scene, s, query, "wide=off" + (options.empty() ? "" : "," + options)), b = filmOf(scene, s, query, options);
    const Difference d = difference(*a, *b);
    INFO("--paths \"" << query.paths << "\" --split \"" << query.split << "\" --max-depth " << query.maxDepth << " " << options);
    CHECK(d.share < 0.01);
    CHECK(d.mean < 2e-3);
    CHECK(d.albedo < 1e-5);
}
bool sameLayers(const Film& a, const Film& b) {
    bool same = samePicture(a, b);
    eachPixel(a, [&](Pixel p) {
        for (int layer = 0; layer < layersOf(a); ++layer) same = same && a.mean(p, layer) == b.mean(p, layer);
    });
    return same;
}

} // namespace

TEST_SUITE("path-wide-classes") {

    TEST_CASE("a row says what the automaton says, and a depth alone needs no states") {
        for (const Query& query : queries) {
            const PathClasses classes = query.classes();
            const WideClasses wide(classes);
            CHECK(!wide.onlyDepth());
            bool sorts = false, right = true;
            for (std::size_t s = 0; s < classes.states(); ++s) {
                const auto state = PathState(s);
                const WideClass& row = wide.rows()[s];
                for (int e = 0; e < eventCount; ++e) right = right && row.next[e] == classes.eye(state, Event(e));
                for (int k = 0; k < lightKindCount; ++k)
                    right = right && (row.reached >> (8 * k) & 0xff) == classes.reached(state, LightKind(k));
                right = right && ((row.reached & WideClass::continues) != 0) == classes.continues(state);
                right = right && ((row.reached & WideClass::sorts) != 0) == classes.sorts(state);
                sorts = sorts || classes.sorts(state);
            }
            CHECK(right);
            CHECK(wide.sorts() == sorts);
        }
        for (const uint32_t depth : {0u, 1u, 7u, unlimitedDepth}) {
            CHECK(WideClasses(PathClasses(depth)).onlyDepth());
            CHECK(!WideClasses(asked("L . .* E", "", std::max(depth, 1u))).onlyDepth());
        }
    }

    TEST_CASE("every mask and every split, on every kind of surface and of light") {
        const auto all = compiled(everything(true)), sky = compiled(underSky(TextureFilter::linear)),
                   metal = compiled(builtin("@veach-mis"));
        for (const Query& query : queries)
            for (const Scene* scene : {all.get(), sky.get(), metal.get()}) same(*scene, query);
    }

    TEST_CASE("in the built-in scenes, without light samples, without weights, with roulette from the start") {
        for (const char* name : {"@cornell", "@cornell-spheres", "@caustic", "@playground"}) {
            CAPTURE(std::string(name));
            const auto scene = compiled(builtin(name));
            for (const Query& query : {Query{"", "paths"}, Query{"L .* G E"}}) same(*scene, query);
        }
        const auto scene = compiled(everything(false));
        for (const char* options : {"nee=off", "mis=off", "rr-depth=0", "stream=32"}) same(*scene, {"", "paths", 12}, options);
    }

    TEST_CASE("lanes take every job but for costs, photons and independent numbers") {
        const auto scene = compiled(builtin("@cornell"));
        if (scene->isa() != "avx2" && scene->isa() != "avx512") {
            MESSAGE("SKIPPED: no lanes on this machine");
            return;
        }
        for (const Query& query : queries) {
            Bench bench(*scene, scene->cameras()[0], {16, 16, 1});
            bench.classes = query.classes();
            FilmLayout layout = bench.layout();
            layout.layers = bench.classes.layerNames();
            const auto made = chooseIntegrator("path").entry->make(chooseIntegrator("path").options);
            made->prepare(bench.job);
            const auto& path = dynamic_cast<const CameraIntegrator&>(*made);
            CHECK(path.streams(bench.job, layout));
            layout.costs = true;
            CHECK(!path.streams(bench.job, layout));
        }
    }

    TEST_CASE("in either instruction set, as far as this machine has them") {
        for (const char* isa : {"avx2", "avx512"}) {
            CAPTURE(std::string(isa));
            try {
                for (const Query& query : {Query{"", "paths"}, Query{"L .* (D|S) E"}}) same(*compiled(everything(true), isa), query);
            } catch (const Error&) { MESSAGE("not on this machine: ", isa); }
        }
    }

    TEST_CASE("layers that no class is drawn for sum to the picture that has none") {
        for (const char* name : {"@cornell-spheres", "@cornell"}) {
            const auto scene = compiled(builtin(name));
            const Settings s{64, 48, 2};
            const auto whole = filmOf(*scene, s, {});
            for (const char* split : {"bounces", "direct,indirect", "lamps=La .* E"}) {
                CAPTURE(std::string(split));
                const auto parted = filmOf(*scene, s, {"", split});
                double share = 0;
                eachPixel(*whole, [&](Pixel p) {
                    const float x = luminance(whole->mean(p)), y = luminance(parted->mean(p));
                    share += !(std::fabs(x - y) <= 1e-4f * (x + 1e-4f));
                });
                CHECK(share / double(s.width * s.height) < 0.002);
            }
        }
    }

    TEST_CASE("any number of paths under way, any number of threads and any cut into passes: the same bits in every layer") {
        const auto scene = compiled(everything(true));
        for (const Query& query : {Query{"", "paths"}, Query{"L .* (D|S) E"}}) {
            Settings s{40, 24, 6};
            s.filter = FilterKind::gauss;
            const auto a = filmOf(*scene, s, query, "stream=32");
            for (const char* stream : {"stream=48", "stream=512", "stream=4096"}) CHECK(sameLayers(*a, *filmOf(*scene, s, query, stream)));
            for (const unsigned threads : {2u, 5u}) {
                s.threads = threads;
                CHECK(sameLayers(*a, *filmOf(*scene, s, query)));
            }
            Bench bench(*scene, scene->cameras()[0], s);
            bench.classes = query.classes();
            FilmLayout layout = bench.layout();
            layout.layers = bench.classes.layerNames();
            Film parts(layout);
            const auto made = chooseIntegrator("path").entry->make(chooseIntegrator("path").options);
            made->prepare(bench.job);
            for (const auto& [begin, end] : {std::pair{0u, 1u}, std::pair{1u, 4u}, std::pair{4u, 6u}})
                made->render(bench.job, {begin, end, nullptr}, parts);
            CHECK(sameLayers(*a, parts));
        }
    }

    TEST_CASE("light of two lobes that takes turns between two layers: the same bits, whatever waits beside a shadow ray") {
        SceneDesc d;
        shapes::add(d, "room", shapes::insideOut(shapes::box({2, 2, 2})), shapes::add(d, plain("coated", Spectrum(0.9f), 0.3f)));
        shapes::add(d, "lamp", square(0.5), shapes::add(d, shapes::lamp("lamp", Spectrum(4))), shapes::translation({0, 0, -0.9}));
        shapes::addCamera(d, "main", 0.9, shapes::translation({0.3, 0.2, 0.9}));
        const auto scene = compiled(std::move(d));
        const Query turns{"", "A=L D (..)* E|L G .(..)* E,B=L G (..)* E|L D .(..)* E"};
        const Settings s{24, 16, 8};
        const auto a = filmOf(*scene, s, turns, "stream=32");
        for (const char* stream : {"stream=64", "stream=512", "stream=4096"}) CHECK(sameLayers(*a, *filmOf(*scene, s, turns, stream)));
        same(*scene, turns);
    }

    TEST_CASE("a film with one layer of a split that has many, and one with many for paths that know only one") {
        const auto scene = compiled(builtin("@cornell-spheres"));
        const Settings s{32, 24, 2};
        for (const bool split : {false, true}) {
            Bench bench(*scene, scene->cameras()[0], s);
            if (split) bench.classes = asked("", "bounces");
            FilmLayout layout = bench.layout();
            if (!split) layout.layers = {"other", "more", "rest"};
            Film film(layout);
            bench.render(film);
            const auto whole = filmOf(*scene, s, {});
            double share = 0;
            eachPixel(film, [&](Pixel p) { share += std::fabs(luminance(film.mean(p)) - luminance(whole->mean(p))) > 1e-4f; });
            CHECK(share == 0);
        }
    }
}
