// --aperture, --focus, --blades: what is told, what is kept in the picture, what is refused; light rays that need an opening.
#include "tools/cli/lens.h"
#include "program.h"
#include "tests/scene_kit.h"

using namespace program;

namespace {

std::vector<std::string> render(std::vector<std::string> more) {
    std::vector<std::string> words{"render", "@cornell", "--size", "16x16", "--spp", "2", "-o", "p.exr"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}
void refused(const Folder& folder, const std::vector<std::string>& more, int code, const std::string& message) {
    const Outcome o = run(folder, render(more));
    CAPTURE(message);
    CAPTURE(o.err);
    CHECK(o.code == code);
    CHECK(contains(o.err, "error: "));
    CHECK(contains(o.err, message));
    CHECK_FALSE(fs::exists(folder / "p.exr"));
}

} // namespace

TEST_SUITE("lens") {

    TEST_CASE("a lens is told with the option that keeps its focus, and is in the picture's recipe") {
        if (absent()) return;
        const Folder folder;
        const Outcome fstop = run(folder, render({"--aperture", "f/2"}));
        CHECK(fstop.code == 0);
        CHECK(contains(fstop.err, "(f/2), focus "));
        CHECK(contains(fstop.err, "(auto)      keep it with: --focus "));
        const Outcome pixel = run(folder, render({"--aperture", "0.3", "--focus", "4,10", "--blades", "6:15"}));
        CHECK(contains(pixel.err, "lens     300 mm, 6 blades, focus "));
        CHECK(contains(pixel.err, "(pixel 4,10)"));
        CHECK(contains(pixel.err, "--aperture 0.3 --focus 4,10 --blades 6:15")); // of the line that names the next command
        const Outcome told = run(folder, {"info", "p.exr"});
        CHECK(contains(told.out, "chiaro:aperture"));
        CHECK(contains(told.out, "chiaro:focus"));
        CHECK(contains(told.out, "6:15"));
        const Outcome metres = run(folder, render({"--aperture", "0.3", "--focus", "2.5"}));
        CHECK(contains(metres.err, "focus 2.5 m\n"));
        CHECK_FALSE(contains(run(folder, render({})).err, "lens "));
    }

    TEST_CASE("a camera that moves is sharp where it stands in the middle of the shutter") {
        using namespace chiaro;
        SceneDesc s;
        shapes::add(s, "floor", test::square(9), shapes::add(s, shapes::diffuse("grey", Spectrum(0.5f))));
        s.shutter = {0, 1};
        shapes::addCamera(s, "eye", 0.5, shapes::translation({0, 0, 2}));
        s.cameras[0].motion = {shapes::translation({0, 0, 2}), shapes::translation({0, 0, 6})};
        const auto scene = test::compiled(std::move(s));
        cli::LensRequest request;
        request.diameter = 0.1;
        for (const char* focus : {"auto", "1,1"}) {
            request.focus = focus;
            CHECK(cli::chooseLens(request, scene->cameras()[0], *scene, {16, 12}).focus == doctest::Approx(4));
        }
        CameraDesc still = scene->cameras()[0];
        still.motion.clear();
        CHECK(cli::chooseLens(request, still, *scene, {16, 12}).focus == doctest::Approx(2));
    }

    TEST_CASE("what makes no sense is refused in one line") {
        if (absent()) return;
        const Folder folder;
        refused(folder, {"--focus", "2"}, 64, "add --aperture");
        refused(folder, {"--blades", "5"}, 64, "add --aperture");
        refused(folder, {"--aperture", "f/x"}, 64, "\"x\" is not a number");
        refused(folder, {"--aperture", "-1"}, 64, "--aperture");
        refused(folder, {"--aperture", "0.1", "--focus", "0"}, 64, "--focus");
        refused(folder, {"--aperture", "0.1", "--focus", "500,3"}, 64, "not inside the picture of 16x16");
        refused(folder, {"--aperture", "0.1", "--blades", "2"}, 64, "from 3 to 64");
        refused(folder, {"-i", "light:connect=off"}, 64, "no light ray meets a pinhole");
    }

    TEST_CASE("unaimed light tracing tells how many rays landed") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = run(folder, render({"-i", "light:connect=off", "--aperture", "1"}));
        CHECK(o.code == 0);
        CHECK(contains(o.err, "of the first 256 light paths"));
    }
}
