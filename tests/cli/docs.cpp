// The pages: every picture that they show is there, and is made by a command in a block of the same page that tools/docs.sh runs; every
// subcommand has its page; links lead somewhere.
#include "tests/cli/program.h"
#include "tools/cli/command.h"
#include <regex>
#include <set>

using namespace program;

namespace {

struct Page {
    fs::path file;
    std::string text, commands; // commands: of its "```sh picture" blocks
};

std::vector<Page> pages() {
    std::vector<fs::path> files = {"README.md"};
    for (const auto& entry : fs::directory_iterator("docs"))
        if (entry.path().extension() == ".md") files.push_back(entry.path());
    std::vector<Page> all;
    static const std::regex block("(^|\n)```sh picture\n([^`]*)```");
    for (const fs::path& file : files) {
        Page page{file, readAll(file), {}};
        for (std::sregex_iterator i(page.text.begin(), page.text.end(), block), end; i != end; ++i) page.commands += (*i)[2];
        all.push_back(std::move(page));
    }
    return all;
}

// Targets of "![...](target)" or "[...](target)".
std::set<std::string> targets(const std::string& text, bool pictures) {
    static const std::regex link(R"((!?)\[[^\]]*\]\(([^)#\s]+)[^)]*\))");
    std::set<std::string> found;
    for (std::sregex_iterator i(text.begin(), text.end(), link), end; i != end; ++i)
        if (((*i)[1].length() > 0) == pictures && !(*i)[2].str().starts_with("http")) found.insert((*i)[2]);
    return found;
}

} // namespace

TEST_SUITE("docs") {
    TEST_CASE("every picture of the pages is there and made by a command printed on its page") {
        std::size_t pictures = 0;
        for (const Page& page : pages()) {
            CAPTURE(page.file);
            for (const std::string& target : targets(page.text, true)) {
                CAPTURE(target);
                const fs::path picture = (page.file.parent_path() / target).lexically_normal();
                CHECK(fs::exists(picture));
                CHECK(contains(page.commands, picture.string()));
                ++pictures;
            }
        }
        CHECK(pictures > 0);
    }
    TEST_CASE("links between the pages lead somewhere") {
        for (const Page& page : pages())
            for (const std::string& target : targets(page.text, false)) {
                CAPTURE(page.file);
                CAPTURE(target);
                CHECK(fs::exists((page.file.parent_path() / target).lexically_normal()));
            }
    }
    TEST_CASE("every subcommand has a page, and the index names it") {
        const std::string index = readAll("docs/README.md");
        for (const chiaro::cli::Command& command : chiaro::cli::commands()) {
            const std::string name = std::string(command.name) + ".md";
            CAPTURE(name);
            CHECK(fs::exists(fs::path("docs") / name));
            CHECK(contains(index, "(" + name + ")"));
        }
    }
    TEST_CASE("no stored picture is left over") {
        std::string commands;
        for (const Page& page : pages()) commands += page.commands;
        for (const auto& entry : fs::recursive_directory_iterator("docs/pictures"))
            if (entry.is_regular_file()) {
                CAPTURE(entry.path());
                CHECK(contains(commands, entry.path().string()));
            }
    }
} // TEST_SUITE
