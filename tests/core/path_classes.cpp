// The automaton against every path of up to six scatterings, read by a matcher of its own (std::regex over one character a letter): from
// the light, from the eye, and joined at every vertex; masks, splits, depth limits, dead ends, dice.
#include "core/render/path_classes.h"
#include "core/render/error.h"
#include "core/render/path_classes_split.h"
#include <algorithm>
#include <doctest/doctest.h>
#include <functional>
#include <map>
#include <random>
#include <regex>
#include <set>

using namespace chiaro;

namespace {

// A path as text: x, y or z for the kind of light, a to f for the events from the light on, E.
constexpr char lights[] = "xyz", events[] = "abcdef";

std::regex matcher(const std::string& expression) {
    std::string r;
    for (const char c : expression) {
        const char before = r.empty() ? '\0' : r.back();
        switch (c) {
        case ' ': break;
        case 'L': r += "[xyz]"; break;
        case 'D': r += "[ab]"; break;
        case 'G': r += "[cd]"; break;
        case 'S': r += "[ef]"; break;
        case '.': r += "[abcdef]"; break;
        case 'a': r.replace(r.size() - 5, 5, "x"); break;
        case 'd': r.replace(r.size() - 5, 5, "y"); break;
        case 'e': r.replace(r.size() - 5, 5, "z"); break;
        case 'R':
        case 'T': {
            REQUIRE(before == ']');
            const std::size_t open = r.rfind('[');
            std::string side;
            for (std::size_t i = open + 1; i + 1 < r.size(); ++i)
                if (((r[i] - 'a') % 2 == 0) == (c == 'R')) side += r[i];
            r.replace(open, r.size(), "[" + side + "]");
            break;
        }
        default: r += c;
        }
    }
    return std::regex(r, std::regex::ECMAScript | std::regex::optimize);
}

void everyPath(std::size_t most, const std::function<void(const std::string& path)>& f) {
    std::string path;
    const std::function<void()> grow = [&] {
        f(path + 'E');
        if (path.size() > most) return;
        for (int e = 0; e < eventCount; ++e) {
            path += events[e];
            grow();
            path.pop_back();
        }
    };
    for (int k = 0; k < lightKindCount; ++k) {
        path = lights[k];
        grow();
    }
}
std::size_t scatterings(const std::string& path) { return path.size() - 2; }
LightKind kindOf(const std::string& path) { return LightKind(path[0] - 'x'); }
Event eventAt(const std::string& path, std::size_t i) { return Event(path[i + 1] - 'a'); } // from the light

struct Walk {
    std::vector<PathState> light, eye; // after 0, 1, ... scatterings from either end
    Walk(const PathClasses& c, const std::string& path) : light{c.light(kindOf(path))}, eye{c.eye()} {
        const std::size_t n = scatterings(path);
        for (std::size_t i = 0; i < n; ++i) {
            light.push_back(c.light(light.back(), eventAt(path, i)));
            eye.push_back(c.eye(eye.back(), eventAt(path, n - 1 - i)));
        }
    }
};

// How often what the automaton says of a path, read from either end or joined anywhere, is not its layer.
std::size_t wrong(const PathClasses& c, const std::string& path, Layer layer) {
    const Walk w(c, path);
    const std::size_t n = scatterings(path);
    std::size_t bad = c.reached(w.eye[n], kindOf(path)) != layer;
    for (std::size_t i = 0; i <= n; ++i) bad += c.meet(w.light[i], w.eye[n - i]) != layer;
    return bad;
}

PathQuery query(std::string paths, std::string split = {}, uint32_t maxDepth = unlimitedDepth) {
    return {std::move(paths), std::move(split), maxDepth, {}, {}};
}

// The layer by the definition: the first class that matches, of the paths that the mask lets through.
struct Reference {
    std::vector<std::regex> classes; // empty: one layer
    std::regex mask;
    std::size_t maxDepth;
    Reference(const std::vector<std::string>& expressions, const std::string& paths, std::size_t depth)
        : mask(matcher(paths.empty() ? "L .* E" : paths)), maxDepth(depth) {
        for (const std::string& e : expressions) classes.push_back(matcher(e));
    }
    Layer layer(const std::string& path) const {
        if (scatterings(path) > maxDepth || !std::regex_match(path, mask)) return 0;
        if (classes.empty()) return 1;
        for (std::size_t i = 0; i < classes.size(); ++i)
            if (std::regex_match(path, classes[i])) return Layer(i + 2);
        return 0;
    }
};
std::vector<std::string> defaultExpressions() {
    std::vector<std::string> all;
    for (const NamedPaths& c : defaultPathClasses()) all.emplace_back(c.paths);
    all.emplace_back("L .* E");
    return all;
}

struct Case {
    std::string paths, split;
    uint32_t maxDepth;
    std::vector<std::string> classes;
};
const Case cases[] = {
    {"", "", unlimitedDepth, {}},
    {"", "", 4, {}},
    {"L E", "", unlimitedDepth, {}},
    {"L D E", "", unlimitedDepth, {}},
    {"L D D+ E", "", unlimitedDepth, {}},
    {"L S+ D E", "", unlimitedDepth, {}},
    {"La (DR|ST)* GT? E | Ld .T+ E | Le E", "", 5, {}},
    {"(La|Le) (D S{1,2} | G{2} .){0,2} .R{2,} E", "", unlimitedDepth, {}},
    {"L (D*)* (S|G S?)+ E", "", 3, {}},
    {"", "paths", unlimitedDepth, defaultExpressions()},
    {"L . .* DR E", "paths", 4, defaultExpressions()},
    {"", "bounces", unlimitedDepth, {"L E", "L.E", "L..E", "L...E", "L....E", "L.....E", "L......E"}},
    {"L D* E", "bounces", 3, {"L E", "L.E", "L..E", "L...E"}},
    {"", "direct,indirect", unlimitedDepth, {"L.?E", "L..+E"}},
    {"", "mine=L .{0,2} S E, L D* E, caustics", unlimitedDepth, {"L .{0,2} S E", "L D* E", "L S+ D E", "L.*E"}},
};

} // namespace

TEST_SUITE("path_classes") {
    TEST_CASE("every path of up to six scatterings, from either end and joined at every vertex") {
        for (const Case& c : cases) {
            CAPTURE(c.paths);
            CAPTURE(c.split);
            const PathClasses classes = PathClasses::make(query(c.paths, c.split, c.maxDepth));
            const Reference reference(c.classes, c.paths, c.maxDepth);
            std::size_t bad = 0, wanted = 0;
            everyPath(6, [&](const std::string& path) {
                const Layer layer = reference.layer(path);
                wanted += layer != 0;
                const std::size_t b = wrong(classes, path, layer);
                if (b > 0 && bad == 0) MESSAGE("first wrong path " << path << ", layer " << int(layer));
                bad += b;
            });
            CHECK(bad == 0);
            CHECK(wanted > 0);
        }
    }

    TEST_CASE("dead ends, last events and dice are known exactly: nothing more is followed, nothing less") {
        for (const Case& c : cases) {
            const uint32_t depth = std::min(c.maxDepth, 4u);
            CAPTURE(c.paths);
            CAPTURE(c.split);
            const PathClasses classes = PathClasses::make(query(c.paths, c.split, depth));
            const Reference reference(c.classes, c.paths, depth);
            std::map<std::string, Layer> layers;
            std::set<std::string> begins, ends; // of wanted paths: from the light without E, to the eye without L
            everyPath(depth, [&](const std::string& path) {
                const Layer layer = layers[path] = reference.layer(path);
                if (layer == 0) return;
                for (std::size_t i = 1; i < path.size(); ++i) begins.insert(path.substr(0, i)), ends.insert(path.substr(i));
            });
            std::map<std::string, std::set<std::string>> parts; // ends before which D and G of one side part
            for (const auto& [path, layer] : layers)
                for (std::size_t i = 1; i + 1 < path.size(); ++i) {
                    if (path[i] != 'a' && path[i] != 'b') continue;
                    std::string other = path;
                    other[i] = char(path[i] + 2);
                    if (layers.at(other) != layer) parts[path.substr(i + 1)].insert("eye"), parts[path.substr(0, i)].insert("light");
                }
            std::size_t bad = 0;
            const auto follows = [](const std::set<std::string>& all, const std::string& end) {
                for (const char e : std::string(events))
                    if (all.count(e + end)) return true;
                return false;
            };
            const auto precedes = [](const std::set<std::string>& all, const std::string& begin) {
                for (const char e : std::string(events))
                    if (all.count(begin + e)) return true;
                return false;
            };
            for (const auto& [path, layer] : layers) {
                const Walk w(classes, path);
                const std::size_t n = scatterings(path);
                const std::string begin = path.substr(0, n + 1), end = path.substr(1);
                bad += (w.light[n] != 0) != (begins.count(begin) > 0);
                bad += (w.eye[n] != 0) != (ends.count(end) > 0);
                bad += classes.continues(w.eye[n]) != follows(ends, end);
                bad += classes.continues(w.light[n]) != precedes(begins, begin);
                bad += classes.sorts(w.eye[n]) != (parts.count(end) > 0);
                bad += classes.sorts(w.light[n]) != (parts.count(begin) > 0);
            }
            CHECK(bad == 0);
        }
    }

    TEST_CASE("without classes there is nothing to sort and a depth costs one state") {
        const PathClasses plain;
        CHECK(plain.states() == 2);
        CHECK(plain.maxDepth() == unlimitedDepth);
        CHECK(plain.layerNames().empty());
        CHECK(!plain.sorts(plain.eye()));
        for (const uint32_t depth : {0u, 1u, 2u, 1000u, unlimitedDepth - 1}) {
            CAPTURE(depth);
            const PathClasses classes(depth);
            CHECK(classes.states() == depth + 2);
            PathState eye = classes.eye(), half = classes.light(LightKind::delta);
            uint32_t steps = 0;
            for (; classes.continues(eye); eye = classes.eye(eye, Event(steps % eventCount))) {
                if (steps++ < depth / 2) half = classes.light(half, Event::DR);
                if (classes.reached(eye, LightKind::area) != 1) steps = unlimitedDepth;
            }
            CHECK(steps == depth);
            CHECK(classes.eye(eye, Event::DR) == 0);
            // What the light has left over the eye may use, and no more.
            PathState rest = classes.eye();
            for (uint32_t i = 0; i < depth - depth / 2; ++i) rest = classes.eye(rest, Event::GT);
            CHECK(classes.meet(half, rest) == 1);
            if (depth > 1) CHECK(classes.meet(classes.light(half, Event::DR), rest) == 0);
        }
    }

    TEST_CASE("a depth beyond 16 bits is refused with one that fits") {
        CHECK_NOTHROW(PathClasses::make(query("", "paths", 1000)));
        CHECK_NOTHROW(PathClasses::make(query("", "bounces", 10000)));
        CHECK_NOTHROW(PathClasses::make(query("L D{0,9} E", "", 60000))); // no path is that long: no counter
        CHECK(PathClasses::make(query("L D{0,9} E", "", 60000)).states() < 30);
        try {
            PathClasses::make(query("", "paths", 60000));
            FAIL("60,000 scatterings of ten classes in 65,535 states");
        } catch (const Error& e) {
            CHECK(e.code == Exit::usage);
            const std::string text = e.what(), before = "; use --max-depth ";
            CAPTURE(text);
            const std::size_t at = text.find(before);
            REQUIRE(at != text.npos);
            const unsigned long fits = std::stoul(text.substr(at + before.size()));
            CHECK(fits > 1000);
            CHECK(PathClasses::make(query("", "paths", uint32_t(fits))).states() <= 65536);
        }
    }

    TEST_CASE("the default classes are disjoint, and each set of layers holds every path once") {
        std::vector<std::regex> classes;
        for (const NamedPaths& c : defaultPathClasses()) classes.push_back(matcher(std::string(c.paths)));
        std::size_t twice = 0;
        everyPath(5, [&](const std::string& path) {
            int holders = 0;
            for (const std::regex& c : classes) holders += std::regex_match(path, c);
            twice += holders > 1;
        });
        CHECK(twice == 0);
        for (const std::string split : {"paths", "bounces", "direct,indirect", "caustic=L S+ D E,rest", "L D E,L . E,L .* D E"}) {
            CAPTURE(split);
            const PathClasses c = PathClasses::make(query("", split));
            std::size_t lost = 0;
            std::set<int> used;
            everyPath(6, [&](const std::string& path) {
                const Layer layer = c.reached(Walk(c, path).eye[scatterings(path)], kindOf(path));
                lost += layer < 2 || layer > c.layerNames().size();
                used.insert(layer);
            });
            CHECK(lost == 0);
            CHECK(used.size() >= c.layerNames().size() - 3); // bounces-7 and bounces-8+ are longer
        }
    }

    TEST_CASE("names of the layers") {
        const auto names = [](const std::string& split, uint32_t depth = unlimitedDepth, const std::string& paths = "") {
            return PathClasses::make(query(paths, split, depth)).layerNames();
        };
        using Names = std::vector<std::string>;
        CHECK(names("paths") == Names{"other", "emission", "specular", "direct-diffuse", "direct-glossy", "caustics", "glossy-caustics",
                                      "colour-bleeding", "reflections", "indirect-glossy", "rest"});
        CHECK(names("bounces", 2) == Names{"other", "bounces-0", "bounces-1", "bounces-2"});
        CHECK(names("bounces").size() == 10);
        CHECK(names("bounces").back() == "bounces-8+");
        CHECK(names("direct,indirect") == Names{"other", "direct", "indirect"});
        CHECK(names("caustic=L S+ D E, rest") == Names{"other", "caustic", "rest"});
        CHECK(names("caustic=L S+ D E") == Names{"other", "caustic", "rest"});
        CHECK(names("caustic=L S+ D E", unlimitedDepth, "L S* D E") == Names{"other", "caustic", "rest"});
        CHECK(names("caustic=L S+ D E", unlimitedDepth, "L S+ D E") == Names{"other", "caustic"}); // no rest under this mask
        CHECK(names("L.{1,2}E,(L E|L S E)") == Names{"other", "Lany{1,2}E", "(L E|L S E)", "rest"});
    }

    TEST_CASE("splits and masks that say nothing are refused") {
        const auto message = [](const PathQuery& q) -> std::string {
            try {
                PathClasses::make(q);
            } catch (const Error& e) {
                CHECK(e.code == Exit::usage);
                return e.what();
            }
            return "no error";
        };
        CHECK(message(query("", "caustic")).find("did you mean caustics?") != std::string::npos);
        CHECK(message(query("", "rest,caustics")).find("put rest last") != std::string::npos);
        CHECK(message(query("", "caustics,caustics")).find("two classes named \"caustics\"") != std::string::npos);
        CHECK(message(query("", "paths,caustics")).find("paths stands alone") != std::string::npos);
        CHECK(message(query("", "direct,,indirect")).find("empty class") != std::string::npos);
        CHECK(message(query("", "a.b=L E")).find("is no name for a layer") != std::string::npos);
        CHECK(message(query("", "other=L E")).find("choose another name") != std::string::npos);
        CHECK(message(query("", "rest=L E")).find("choose another name") != std::string::npos);
        CHECK(message(query("", "a=L D")).find("--split \"L D\": path does not reach the eye at 4") != std::string::npos);
        std::string many = "a0=L E";
        for (int i = 1; i < 32; ++i) many += ",a" + std::to_string(i) + "=L E";
        CHECK(message(query("", many)).find("more than 31 classes") != std::string::npos);
        CHECK(message(query("L D D+ E", "", 1)) ==
              "--paths \"L D D+ E\": such paths scatter 2 times or more; use --max-depth 2 instead of 1");
        PathQuery none = query("L S E");
        none.within = "L D* E";
        CHECK(message(none).find("can show none of these paths, it covers \"L D* E\"") != std::string::npos);
        CHECK(message(query("L .* D .{14} E")).find("shorten repetitions") != std::string::npos); // 2^15 states from the light
    }

    TEST_CASE("within and without restrict a mask to what an integrator sees") {
        PathQuery q = query("L .* D E");
        q.within = "L (D|S)* E";
        q.without = "Ld S+ .* E";
        const PathClasses c = PathClasses::make(q);
        const std::regex paths = matcher(q.paths), within = matcher(q.within), without = matcher(q.without);
        std::size_t bad = 0;
        everyPath(5, [&](const std::string& path) {
            bad += wrong(c, path, std::regex_match(path, paths) && std::regex_match(path, within) && !std::regex_match(path, without));
        });
        CHECK(bad == 0);
    }

    TEST_CASE("the hash knows what is asked, not how it is written") {
        const auto hash = [](const PathQuery& q) { return PathClasses::make(q).hash(); };
        CHECK(hash(query("L D D* E")) == hash(query("(La|Ld|Le) (DR|DT)+ E | L D E")));
        CHECK(hash(query("", "a=L D{1,} E|L E", 7)) == hash(query("L .* E", "a=L D* E,rest", 7)));
        CHECK(hash(query("")) == PathClasses().hash());
        std::set<uint64_t> all;
        const PathQuery different[] = {
            query(""),       query("", "", 5),   query("", "", 6),     query("L D+ E"),       query("La D+ E"),
            query("L D* E"), query("", "paths"), query("", "bounces"), query("", "a=L D+ E"), query("", "b=L D+ E")};
        for (const PathQuery& q : different) all.insert(hash(q));
        CHECK(all.size() == std::size(different));
    }

    TEST_CASE("a million random queries: long paths read the same from either end and joined anywhere") {
        std::mt19937 random(7);
        for (const PathQuery& q : {query("", "paths"), query("", "paths", 30), query("L .* (S|G)+ D .* E", "bounces", 20)}) {
            const PathClasses c = PathClasses::make(q);
            std::size_t bad = 0, wanted = 0;
            for (int i = 0; i < 10000; ++i) {
                std::string path(1, lights[random() % 3]);
                const std::size_t n = random() % 40;
                for (std::size_t j = 0; j < n; ++j) path += events[random() % eventCount];
                path += 'E';
                const Walk w(c, path);
                const Layer layer = c.reached(w.eye[n], kindOf(path));
                if (n > c.maxDepth() && layer != 0) ++bad;
                wanted += layer != 0;
                bad += wrong(c, path, layer);
            }
            CHECK(bad == 0);
            CHECK(wanted > 1000);
        }
    }
} // TEST_SUITE
