// chiaro compare as a user runs it: what it writes, that its numbers are those of render and diff, its reference and the cache of it.
#include "diff_pictures.h"
#include <algorithm>
#include <set>

using namespace program;

namespace {

using Words = std::vector<std::string>;
// Small and without a clock: equal samples, a reference of eight times as many, kept beside the results.
Outcome compare(const Folder& folder, Words words, bool small = true) {
    words.insert(words.begin(), "compare");
    words.insert(words.end(), {"--progress", "none"});
    if (small) words.insert(words.end(), {"--size", "16x16", "--cache", "cache", "-o", "out"});
    return run(folder, words);
}
Json results(const Folder& folder, const std::string& out = "out") {
    const Json parsed = Json::parse(readAll(folder / out / "results.json"), nullptr, false);
    REQUIRE(parsed.is_object());
    return parsed;
}
std::vector<fs::path> cached(const Folder& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder / "cache")) files.push_back(entry.path());
    return files;
}
const Json& entry(const Json& j, const std::string& name) {
    for (const Json& e : j["entries"])
        if (e["name"] == name) return e;
    REQUIRE_MESSAGE(false, "no entry ", name);
    return j;
}
double value(const Json& e, const std::string& metric) { return e["metrics"][metric]["value"].get<double>(); }

// A line of CSV as fields.
Words fields(const std::string& line) {
    Words all{""};
    bool quoted = false;
    for (const char c : line) {
        if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            all.emplace_back();
        else
            all.back() += c;
    }
    return all;
}

} // namespace

TEST_SUITE("compare") {

    TEST_CASE("a scene: every file, the schema, the verdicts") {
        if (absent()) return;
        const Folder folder;
        const Outcome o =
            compare(folder, {"@furnace", "-i", "path,path:mis=off,normals", "--spp", "64", "--seeds", "8", "--split", "direct,indirect"});
        CAPTURE(o.out);
        CAPTURE(o.err);
        REQUIRE(o.code == 0);
        for (const char* file :
             {"report.html", "sheet.png", "results.csv", "results.json", "path.exr", "path-mis-off.exr", "normals.exr", "reference.exr"})
            CHECK(fs::exists(folder / "out" / file));
        const Json j = results(folder);
        CHECK(j["equal"] == "spp");
        CHECK(j["seeds"] == 8);
        CHECK(j["exitCode"] == 0);
        CHECK(j["reference"]["replicas"].get<int>() >= 4);
        CHECK(j["reference"]["replicas"].get<double>() * j["reference"]["spp"].get<double>() >= 8 * 64);
        CHECK(j["settings"]["size"] == "16x16");
        REQUIRE(j["entries"].size() == 4);
        const Json& path = entry(j, "path");
        CHECK(path["source"] == "integrator");
        CHECK(path["spp"] == 64.0);
        CHECK(path["seeds"] == 8);
        CHECK((path["standing"] == "agrees" || path["standing"] == "cannot tell yet"));
        CHECK(path["covers"].get<std::string>().starts_with("L (D|G|S)* E"));
        CHECK(path["layers"].size() >= 2);
        CHECK(path["seconds"].get<double>() > 0);
        for (const char* metric : {"mean", "relative bias", "relMSE", "RMSE", "FLIP"}) CHECK(path["metrics"][metric]["value"].is_number());
        CHECK(path["metrics"]["mean"]["error"].get<double>() > 0);
        CHECK(entry(j, "normals")["standing"] == "debug view");
        CHECK(!entry(j, "normals")["metrics"].contains("relMSE"));
        CHECK(entry(j, "reference")["standing"] == "reference");
        REQUIRE(j["curves"].size() == 2);
        const Json& points = j["curves"][0]["points"];
        REQUIRE(points.size() == 4); // 1, 2, 4 and 8 samples of a seed
        CHECK(points[0]["spp"] == 1.0);
        CHECK(points[3]["spp"] == 8.0);
        CHECK(points[0]["low"].get<double>() <= points[0]["error"].get<double>());
        CHECK(points[0]["high"].get<double>() >= points[0]["error"].get<double>());
        CHECK(j["curves"][0]["slope"].get<double>() < -0.2);
        CHECK(!j["timeToError"].empty());
        const std::string csv = readAll(folder / "out" / "results.csv");
        CHECK(std::count(csv.begin(), csv.end(), '\n') == 5);
        const Words head = fields(csv.substr(0, csv.find('\n')));
        for (const char* column : {"name", "standing", "verdict", "seconds", "spp", "relMSE", "relMSE_error", "FLIP", "slope", "file"})
            CHECK(std::find(head.begin(), head.end(), column) != head.end());
        CHECK(contains(o.out, "picture"));
        CHECK(contains(o.out, "normals a debug view"));
        CHECK(contains(o.err, "keep it with: --exposure"));
        const chiaro::Picture reference = chiaro::readPicture(folder / "out" / "reference.exr");
        REQUIRE(reference.find("error.G"));
        CHECK((*reference.find("error.G"))[100] >= 0);
        const chiaro::Picture picture = chiaro::readPicture(folder / "out" / "path.exr");
        for (const char* channel : {"R", "error.R", "samples", "Z", "direct.R", "albedo.G"}) CHECK(picture.find(channel));
        CHECK(picture.attribute("chiaro:seeds"));
    }

    TEST_CASE("equal samples of one seed are the picture of render, bit for bit; several merge") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = compare(
            folder, {"@cornell", "-i", "path,albedo", "--equal", "spp", "--spp", "5", "--seeds", "1", "--seed", "3", "--ref", "none"});
        CAPTURE(o.err);
        REQUIRE(o.code == 0);
        for (const std::string name : {"path", "albedo"}) {
            REQUIRE(
                run(folder, {"render", "@cornell", "-i", name, "--size", "16x16", "--spp", "5", "--seed", "3", "-o", "r.exr", "-q"}).code ==
                0);
            const chiaro::Picture a = chiaro::readPicture(folder / "out" / (name + ".exr")), b = chiaro::readPicture(folder / "r.exr");
            CHECK(a.names == b.names);
            CHECK(a.planes == b.planes);
        }
        CHECK(results(folder)["reference"].is_null());
        CHECK(entry(results(folder), "path")["standing"] == "not judged");
        CHECK(!fs::exists(folder / "cache"));

        REQUIRE(compare(folder, {"@cornell", "-i", "path", "--spp", "5", "--seeds", "2", "--ref", "none"}).code == 0);
        const chiaro::Picture merged = chiaro::readPicture(folder / "out" / "path.exr");
        REQUIRE(run(folder, {"render", "@cornell", "--size", "16x16", "--spp", "3", "--seed", "0", "-o", "a.exr", "-q"}).code == 0);
        REQUIRE(run(folder, {"render", "@cornell", "--size", "16x16", "--spp", "2", "--seed", "1", "-o", "b.exr", "-q"}).code == 0);
        const chiaro::Picture a = chiaro::readPicture(folder / "a.exr"), b = chiaro::readPicture(folder / "b.exr");
        for (std::size_t i = 0; i < 256; ++i)
            CHECK(near((*merged.find("R"))[i], (3 * (*a.find("R"))[i] + 2 * (*b.find("R"))[i]) / 5.0, 1e-5));
    }

    TEST_CASE("its metrics are those of diff") {
        if (absent()) return;
        const Folder folder;
        REQUIRE(compare(folder, {"@cornell", "-i", "path", "--spp", "4", "--seeds", "2"}).code == 0);
        const Json path = entry(results(folder), "path");
        const Json d = json(run(folder, {"diff", "out/path.exr", "out/reference.exr", "--json", "-"}));
        CHECK(near(value(path, "relMSE"), metric(d, "relmse-net"), 1e-5));
        CHECK(near(value(path, "relative bias"), metric(d, "relbias", "Y"), 1e-4));
        CHECK(near(value(path, "FLIP"), metric(d, "flip-hdr"), 1e-5));
    }

    TEST_CASE("the reference is kept, used again, topped up, and rendered again where its file is damaged") {
        if (absent()) return;
        const Folder folder;
        const Words words{"@cornell", "-i", "path", "--spp", "4", "--seeds", "2"};
        REQUIRE(compare(folder, words).code == 0);
        CHECK(results(folder)["reference"]["fromCache"] == false);
        REQUIRE(cached(folder).size() == 1);
        const std::string first = readAll(folder / "out" / "reference.exr");
        const fs::path file = cached(folder)[0];
        const Outcome again = compare(folder, words);
        CHECK(results(folder)["reference"]["fromCache"] == true);
        CHECK(contains(again.err, "kept from before"));
        CHECK(readAll(folder / "out" / "reference.exr") == first);

        const std::string stored = readAll(file); // more is asked for: more replicas of the same
        REQUIRE(compare(folder, {"@cornell", "-i", "path", "--spp", "8", "--seeds", "2"}).code == 0);
        CHECK(results(folder)["reference"]["replicas"].get<double>() * results(folder)["reference"]["spp"].get<double>() >= 64);
        CHECK(cached(folder).size() == 1);
        CHECK(readAll(file) != stored);

        REQUIRE(compare(folder, {"@cornell", "-i", "path", "--spp", "4", "--seeds", "2", "--max-depth", "2"}).code ==
                0); // others have files of their own
        CHECK(cached(folder).size() == 2);

        for (const std::string& damage : {stored.substr(0, stored.size() / 2),
                                          std::string(stored).replace(stored.size() / 2, 1, "\x55\x66"), std::string("x"), std::string()}) {
            folder.write("damaged", damage);
            fs::copy_file(folder / "damaged", file, fs::copy_options::overwrite_existing);
            const Outcome o = compare(folder, words);
            CAPTURE(o.err);
            CHECK(o.code == 0);
            CHECK(contains(o.err, "the reference is rendered again"));
            CHECK(results(folder)["reference"]["fromCache"] == false);
        }
        folder.write("nofolder", "");
        const Outcome o = compare(
            folder, {"@cornell", "-i", "path", "--spp", "4", "--seeds", "2", "--cache", "nofolder/x", "--size", "16x16", "-o", "out2"},
            false);
        CHECK(o.code == 0);
        CHECK(contains(o.err, "warning: the reference could not be kept"));
    }

    TEST_CASE("equal time is equal, with a reference of its own budget") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = compare(folder, {"@furnace", "-i", "path,normals", "--time", "1s", "--ref-time", "0.5s"});
        CAPTURE(o.err);
        REQUIRE(o.code == 0);
        const Json j = results(folder);
        CHECK(j["equal"] == "time");
        CHECK(entry(j, "path")["spp"].get<double>() > 1);
        CHECK(entry(j, "path")["metrics"]["efficiency"]["value"].get<double>() > 0);
        CHECK(contains(o.err, "keep it with: --ref-time"));
    }

    TEST_CASE("equal noise renders until it is reached, a black picture does not for ever") {
        if (absent()) return;
        const Folder folder;
        REQUIRE(compare(folder, {"@cornell", "-i", "path", "--noise", "20", "--seeds", "2"}).code == 0);
        CHECK(entry(results(folder), "path")["spp"].get<double>() > 4);
        folder.write("dark.gltf", triangle());
        const Outcome o = compare(folder, {"dark.gltf", "-i", "path", "--noise", "1", "--seeds", "2", "--env", "none"});
        CAPTURE(o.err);
        CHECK(o.code == 0);
        CHECK(entry(results(folder), "path")["spp"].get<double>() <= 16);
    }

    TEST_CASE("what an integrator does not cover is said, and the rest is judged by a reference of its own") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = compare(folder, {"@cornell", "-i", "path,whitted", "--spp", "32", "--seeds", "4"});
        CAPTURE(o.out);
        CAPTURE(o.err);
        REQUIRE(o.code == 0);
        const Json j = results(folder);
        CHECK(entry(j, "path")["missing"].is_null());
        CHECK(entry(j, "path")["layers"].empty());
        const Json& whitted = entry(j, "whitted");
        CHECK(whitted["missing"].get<std::string>().starts_with("La D"));
        CHECK(whitted["missingShare"].get<double>() > 0.2);
        CHECK(whitted["missingShare"].get<double>() < 0.8);
        CHECK(contains(whitted["verdict"].get<std::string>(), "different by definition: leaves out La D"));
        CHECK(contains(whitted["verdict"].get<std::string>(), " and adds approximated light of its own: "));
        CHECK(contains(whitted["verdict"].get<std::string>(), "; on what it covers: "));
        CHECK(whitted["ownShare"].get<double>() > 0.1);
        // Of both sides the light on the paths covered alone: whole picture = covered + own.
        const double reference = value(entry(j, "reference"), "mean"), covered = reference * (1 - whitted["missingShare"].get<double>());
        CHECK(near(value(whitted, "mean"), covered + reference * whitted["ownShare"].get<double>(), 0.1));
        CHECK(std::abs(whitted["judged"]["bias"].get<double>()) < 0.3);
        CHECK(whitted["layers"].dump().find("covered") != std::string::npos);
        CHECK(!whitted["judged"].is_null());
        CHECK(cached(folder).size() == 2);
        for (const Json& row : j["timeToError"]) // its error stays: no number of samples mends what is missing
            CHECK(!row["seconds"][1]["extrapolated"].get<bool>());
        const Outcome split = compare(folder, {"@cornell", "-i", "whitted", "--spp", "8", "--seeds", "4", "--split", "bounces"});
        CHECK(contains(split.out, "not judged there: the layer of these paths has no room"));
    }

    TEST_CASE("seldom seen lamps: the bias is that of the paths covered, for every integrator that leaves paths out") {
        if (absent()) return;
        for (const std::string scene : {"@cornell", "@cornell-spheres", "@playground"}) {
            const Folder folder;
            const Outcome o = compare(folder, {scene, "-i", "raycast,raycast:shadows=ray,whitted,whitted:area=sample,distributed", "--spp",
                                               "64", "--seeds", "8"});
            CAPTURE(scene);
            CAPTURE(o.out);
            REQUIRE(o.code == 0);
            for (const Json& e : results(folder)["entries"]) {
                if (e["judged"].is_null()) continue;
                CHECK(e["standing"] != "biased");
                CHECK(e["judged"]["low"].get<double>() < 0.01);
                CHECK(e["judged"]["high"].get<double>() > -0.01);
            }
        }
    }

    TEST_CASE("Ctrl-C writes what there is") {
        if (absent()) return;
        const Folder folder;
        Running running(folder, {"compare", "@cornell", "-i", "path", "--time", "60s", "--ref-time", "0.3s", "--size", "32x32", "--cache",
                                 "none", "-o", "out", "--progress", "json"});
        REQUIRE(running.awaitStderr("ref      path"));
        REQUIRE(running.awaitStderr("\"progress\":"));
        running.send(SIGINT);
        const Outcome o = running.wait();
        CAPTURE(o.err);
        CHECK(o.code == 5);
        CHECK(fs::exists(folder / "out" / "path.exr"));
        CHECK(results(folder)["stopped"] == true);
    }
}
