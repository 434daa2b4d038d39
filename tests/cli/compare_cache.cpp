// The folder of kept references has a bound: what was used longest ago goes first.
#include "core/render/error.h"
#include "program.h"
#include "tools/cli/compare_reference.h"

using namespace program;
using namespace chiaro::cli;

namespace {

void add(const Folder& folder, const std::string& name, std::size_t bytes, int hoursAgo) {
    folder.write(name, std::string(bytes, 'x'));
    fs::last_write_time(folder / name, fs::file_time_type::clock::now() - std::chrono::hours(hoursAgo));
}

} // namespace

TEST_SUITE("compare_cache") {

    TEST_CASE("least recently used first, never what was just written, nothing that is no reference") {
        const Folder folder;
        add(folder, "old.reference", 100, 9);
        add(folder, "used.reference", 100, 8);
        add(folder, "middle.reference", 100, 5);
        add(folder, "new.reference", 100, 1);
        add(folder, "notes.txt", 1000, 99);
        boundCache(folder.path(), 400, folder / "new.reference");
        CHECK(fs::exists(folder / "old.reference")); // there is room for all
        markUsed(folder / "used.reference");
        boundCache(folder.path(), 250, folder / "new.reference");
        CHECK_FALSE(fs::exists(folder / "old.reference"));
        CHECK_FALSE(fs::exists(folder / "middle.reference"));
        CHECK(fs::exists(folder / "used.reference"));
        CHECK(fs::exists(folder / "new.reference"));
        boundCache(folder.path(), 0, folder / "new.reference"); // larger than the bound alone
        CHECK_FALSE(fs::exists(folder / "used.reference"));
        CHECK(fs::exists(folder / "new.reference"));
        CHECK(fs::exists(folder / "notes.txt"));
        boundCache(folder / "absent", 0, folder / "absent" / "x.reference");
        markUsed(folder / "absent");
    }
}
