#include "io/picture.h"
#include "io/replace_file.h"
#include <cmath>
#include <csignal>
#include <cstring>
#include <doctest/doctest.h>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace chiaro;
namespace fs = std::filesystem;

namespace {

struct Folder {
    Folder() {
        std::string name = (fs::temp_directory_path() / "chiaro-picture-XXXXXX").string();
        path = mkdtemp(name.data());
    }
    ~Folder() { fs::remove_all(path); }
    fs::path path;
    std::string read(const char* name) const {
        std::ifstream in(path / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    }
};

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

Picture example() {
    Picture p{.width = 7, .height = 5, .window = {2, 1, 6, 4}, .names = {}, .planes = {}, .metadata = {}};
    float v = 0.1f;
    for (const char* name : {"R", "G", "B", "albedo.R", "normal.X", "Z", "samples", "layer10.R", "layer4.R"})
        for (float& x : p.add(name)) x = v *= 1.37f;
    p.planes[5][3] = std::numeric_limits<float>::infinity();
    p.planes[0][0] = 0x1.fffffep-120f;
    p.planes[1][0] = -0.098f;
    p.metadata = {{"chiaro:seed", std::string("18446744073709551615")}, {"chiaro:n", 3}, {"chiaro:exposure", -3.1}};
    return p;
}

const FilmLayout smallLayout{.width = 6, .height = 4, .crop = {1, 1, 5, 3}, .layers = {"direct", "indirect"}};

void fill(Film& film) {
    for (uint32_t s = 0; s < 2; ++s)
        for (uint32_t y = 1; y < 3; ++y)
            for (uint32_t x = 1; x < 5; ++x) {
                Outputs out(film.layout());
                out.add(1, Spectrum(float(x), 0.5f, 0.25f));
                out.add(2, Spectrum(1, 2, float(s)));
                out.aov(Aov::albedo, Spectrum(0.5f));
                out.aov(Aov::normal, Spectrum(0, 1, 0));
                film.add({x, y}, s, out);
            }
}

} // namespace

TEST_SUITE("picture") {

    TEST_CASE("EXR round trip is bit-exact, by channel name") {
        const Folder folder;
        const Picture p = example();
        writeExr(folder.path / "a.exr", p);
        const Picture q = readPicture(folder.path / "a.exr");
        CHECK(q.width == p.width);
        CHECK(q.height == p.height);
        CHECK(q.window == p.window);
        CHECK(q.names.size() == p.names.size());
        for (std::size_t c = 0; c < p.names.size(); ++c) {
            const std::vector<float>* plane = q.find(p.names[c]);
            REQUIRE(plane);
            CHECK_MESSAGE(sameBits(*plane, p.planes[c]), p.names[c]);
        }
        CHECK(!q.find("absent"));
    }

    TEST_CASE("EXR keeps the recipe, the colour space and no date") {
        const Folder folder;
        writeExr(folder.path / "a.exr", example());
        const Picture q = readPicture(folder.path / "a.exr");
        REQUIRE(q.attribute("chiaro:seed"));
        CHECK(std::get<std::string>(*q.attribute("chiaro:seed")) == "18446744073709551615");
        CHECK(std::get<int>(*q.attribute("chiaro:n")) == 3);
        CHECK(std::get<double>(*q.attribute("chiaro:exposure")) == -3.1);
        CHECK(std::get<std::string>(*q.attribute("chiaro:colorspace")) == "lin_rec709");
        CHECK(std::get<std::string>(*q.attribute("compression")) == "zip");
        CHECK(q.attribute("chromaticities"));
        CHECK(!q.attribute("DateTime"));
        writeExr(folder.path / "b.exr", example());
        CHECK(folder.read("a.exr") == folder.read("b.exr"));
    }

    TEST_CASE("layers of a film") {
        Film film(smallLayout);
        fill(film);
        const std::vector<float> depth(8, 2.5f);
        const Picture p = pictureOf(film, depth);
        CHECK(p.window == Rect{1, 1, 5, 3});
        for (const char* name :
             {"R",       "G",       "B",       "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y",   "normal.Z",   "Z",
              "error.R", "error.G", "error.B", "samples",  "direct.R", "direct.G", "direct.B", "indirect.R", "indirect.G", "indirect.B"})
            REQUIRE_MESSAGE(p.find(name), name);
        for (std::size_t i = 0; i < 8; ++i) {
            const float x = float(1 + i % 4);
            CHECK((*p.find("R"))[i] == x + 1);
            CHECK((*p.find("direct.R"))[i] == x);
            CHECK((*p.find("indirect.B"))[i] == 0.5f); // samples 0 and 1
            CHECK((*p.find("albedo.G"))[i] == 0.5f);
            CHECK((*p.find("normal.Y"))[i] == 1);
            CHECK((*p.find("Z"))[i] == 2.5f);
            CHECK((*p.find("samples"))[i] == 2);
            CHECK((*p.find("error.B"))[i] == 0.5f); // half the difference of the halves
            CHECK((*p.find("error.R"))[i] == 0);
        }
        CHECK(!pictureOf(film, {}).find("Z"));
    }

    TEST_CASE("PNG keeps bytes and text") {
        const Folder folder;
        const std::vector<uint8_t> rgb = {0, 118, 188, 255, 1, 2, 3, 4, 5, 6, 7, 8};
        writePng(folder.path / "a.png", 2, 2, rgb, {{"chiaro:exposure", -3.1}, {"chiaro:view", std::string("Standard")}}, true);
        const Picture q = readPicture(folder.path / "a.png");
        CHECK(q.width == 2);
        CHECK(std::lround((*q.find("G"))[0] * 255) == 118);
        CHECK(std::lround((*q.find("R"))[1] * 255) == 255);
        CHECK(std::lround((*q.find("B"))[3] * 255) == 8);
        CHECK(std::get<std::string>(*q.attribute("chiaro:exposure")) == "-3.1");
        CHECK(std::get<std::string>(*q.attribute("chiaro:view")) == "Standard");
    }

    TEST_CASE("reading what is no picture is an error of the file") {
        const Folder folder;
        std::ofstream(folder.path / "no.exr") << "nothing";
        for (const char* name : {"no.exr", "absent.exr"}) {
            try {
                readPicture(folder.path / name);
                FAIL("was read");
            } catch (const Error& e) { CHECK(e.code == Exit::file); }
        }
    }

    TEST_CASE("a file is replaced whole or not at all") {
        const Folder folder;
        const fs::path file = folder.path / "a.bin";
        replaceFile(file, std::as_bytes(std::span("one")));
        replaceFile(file, std::as_bytes(std::span("two")));
        CHECK(folder.read("a.bin") == std::string("two", 4));
        // The system refuses to write more than 16 bytes: as on a full disk, the old file stays and nothing lies beside it.
        struct rlimit old {};
        getrlimit(RLIMIT_FSIZE, &old);
        const auto handler = std::signal(SIGXFSZ, SIG_IGN);
        const struct rlimit few {
            16, old.rlim_max
        };
        setrlimit(RLIMIT_FSIZE, &few);
        const std::vector<std::byte> much(1000);
        Exit code = Exit::done;
        try {
            replaceFile(file, much);
        } catch (const Error& e) { code = e.code; }
        setrlimit(RLIMIT_FSIZE, &old);
        std::signal(SIGXFSZ, handler);
        CHECK(code == Exit::resources);
        CHECK(folder.read("a.bin") == std::string("two", 4));
        CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 1);
    }

    TEST_CASE("what a killed program left beside a file goes with the next writing, what others write stays") {
        const Folder folder;
        char host[256] = {};
        gethostname(host, sizeof host - 1);
        const std::string stem = std::string(".a.bin.") + host + "-";
        const pid_t child = fork();
        if (child == 0) _exit(0);
        waitpid(child, nullptr, 0); // a number that belongs to nobody
        for (const std::string& name : {stem + std::to_string(child) + ".tmp", stem + "1.tmp", std::string(".a.bin.elsewhere-7.tmp"),
                                        std::string(".b.bin.") + host + "-" + std::to_string(child) + ".tmp"})
            std::ofstream(folder.path / name) << "half";
        replaceFile(folder.path / "a.bin", std::as_bytes(std::span("one")));
        CHECK(!fs::exists(folder.path / (stem + std::to_string(child) + ".tmp")));
        CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 4);
    }

    TEST_CASE("permissions and links survive") {
        const Folder folder;
        const fs::path file = folder.path / "a.bin", link = folder.path / "link.bin";
        replaceFile(file, std::as_bytes(std::span("one")));
        fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
        fs::create_symlink("a.bin", link);
        replaceFile(link, std::as_bytes(std::span("two")));
        CHECK(fs::is_symlink(link));
        CHECK(folder.read("a.bin") == std::string("two", 4));
        CHECK(fs::status(file).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
    }

    TEST_CASE("whether a file can be written is known before") {
        const Folder folder;
        checkWritable(folder.path / "new.exr");
        CHECK(fs::is_empty(folder.path));
        const auto message = [](const fs::path& file) -> std::string {
            try {
                checkWritable(file);
            } catch (const Error& e) {
                CHECK(e.code == Exit::file);
                return e.what();
            }
            return "";
        };
        CHECK(message(folder.path).find("is a directory") != std::string::npos);
        CHECK(message(folder.path / "no" / "a.exr").find("mkdir -p") != std::string::npos);
        std::ofstream(folder.path / "file") << "x";
        CHECK(message(folder.path / "file" / "a.exr").find("not a directory") != std::string::npos);
        CHECK(!message("/proc/a.exr").empty());
    }

} // TEST_SUITE
