// A full disk: whatever could not be written, all that was there is whole, and nothing lies beside it.
#include "tests/cli/resume_kit.h"
#include <functional>
#include <sys/mount.h>
#include <sys/resource.h>

using namespace program;

namespace {

// A file system of so many bytes; nothing where the machine does not let us.
class SmallDisk {
public:
    SmallDisk(const fs::path& at, std::size_t bytes) : at_(at) {
        fs::create_directory(at);
        mounted_ = mount("chiaro-test", at.c_str(), "tmpfs", 0, ("size=" + std::to_string(bytes)).c_str()) == 0;
    }
    ~SmallDisk() {
        if (mounted_) umount(at_.c_str());
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;
    explicit operator bool() const { return mounted_; }

private:
    fs::path at_;
    bool mounted_;
};

std::vector<std::string> namesIn(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

// Small files are written, then larger ones over them that do not fit.
void checkFull(const Folder& folder, const std::string& at, const std::function<Outcome(const std::vector<std::string>&)>& full) {
    const std::vector<std::string> outputs = {"-o", at + "a.exr", "-o", at + "a.png", "-o", at + "a.chk"};
    std::vector<std::string> small = {"render", "@cornell", "--size", "8x8", "--spp", "2", "-q"};
    small.insert(small.end(), outputs.begin(), outputs.end());
    REQUIRE(run(folder, small).code == 0);
    std::vector<std::string> before;
    for (const char* name : {"a.exr", "a.png", "a.chk"}) before.push_back(readAll(folder / (at + name)));
    for (const bool pictures : {true, false}) {
        std::vector<std::string> large = {"render", "@cornell", "--size", "256x256", "--spp", "2"};
        if (pictures)
            large.insert(large.end(), {"-o", at + "a.exr"});
        else
            large.insert(large.end(), {"--checkpoint-every", "1ms", "-o", "elsewhere.png", "-o", at + "a.chk"});
        const Outcome o = full(large);
        CAPTURE(o.err);
        CHECK(o.code == 6);
        CHECK(contains(o.err, "cannot write " + at + (pictures ? "a.exr" : "a.chk") + " ("));
        CHECK(contains(o.err, "the file that was there is untouched"));
        int i = 0;
        for (const char* name : {"a.exr", "a.png", "a.chk"}) CHECK(readAll(folder / (at + name)) == before[std::size_t(i++)]);
        CHECK(namesIn((folder / (at + "a.exr")).parent_path()).size() == (at.empty() ? namesIn(folder.path()).size() : 3));
        for (const std::string& name : namesIn((folder / (at + "a.exr")).parent_path())) CHECK(!contains(name, ".tmp"));
    }
}

} // namespace

TEST_SUITE("full_disk") {

    TEST_CASE("a small tmpfs that is full loses nothing") {
        if (absent()) return;
        const Folder folder;
        const SmallDisk disk(folder / "disk", 256 * 1024);
        if (!disk) {
            std::cout << "SKIPPED: this user may not mount a tmpfs\n";
            return;
        }
        checkFull(folder, "disk/", [&](const std::vector<std::string>& words) { return run(folder, words); });
    }

    TEST_CASE("a limit on the size of files is answered alike") {
        if (absent()) return;
        const Folder folder;
        checkFull(folder, "", [&](const std::vector<std::string>& words) {
            struct rlimit old {};
            getrlimit(RLIMIT_FSIZE, &old);
            const struct rlimit few {
                200 * 1024, old.rlim_max
            };
            setrlimit(RLIMIT_FSIZE, &few); // inherited by the program
            const Outcome o = run(folder, words);
            setrlimit(RLIMIT_FSIZE, &old);
            return o;
        });
    }

} // TEST_SUITE
