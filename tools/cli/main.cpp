// chiaro: picks the subcommand, and turns every failure into one line and an exit code.
#include "core/render/error.h"
#include "tools/cli/command.h"
#include "tools/cli/console.h"
#include "tools/cli/memory.h"
#include "tools/cli/version.h"
#include <csignal>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <new>
#ifdef __SSE__
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

namespace chiaro::cli {
namespace {

// Before anything starts a thread: oneTBB's workers take the mode of the thread that uses oneTBB first.
void flushDenormals() {
#ifdef __SSE__
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
#endif
}

const Command& findCommand(const std::string& name) {
    std::vector<std::string> names;
    for (const Command& c : commands()) {
        if (c.name == name) return c;
        names.emplace_back(c.name);
    }
    const std::string near = nearest(name, names);
    throw Error(Exit::usage,
                fmt::format("unknown command \"{}\"{} (chiaro help)", name, near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

int dispatch(const std::vector<std::string>& words) {
    if (words.empty()) {
        fmt::print(stderr, "{}", overview());
        return int(Exit::usage);
    }
    if (words[0] == "--version" || words[0] == "version") {
        fmt::print("chiaro {}\n", version);
        return 0;
    }
    if (words[0] == "--help" || words[0] == "-h") {
        fmt::print("{}", overview());
        return 0;
    }
    if (words[0][0] == '-')
        throw Error(Exit::usage,
                    fmt::format("unknown option {}; a command comes first: chiaro render SCENE {} ... (chiaro help)", words[0], words[0]));
    const Command& command = findCommand(words[0]);
    const std::vector<std::string> rest(words.begin() + 1, words.end());
    for (const std::string& word : rest)
        if (word == "--help" || word == "-h") {
            fmt::print("{}", commandHelp(command));
            return 0;
        }
    return command.run(parseArguments(command, rest));
}

int guarded(const std::vector<std::string>& words) {
    try {
        const int code = dispatch(words);
        if (std::fflush(stdout) != 0) throw Error(Exit::file, "cannot write the results to standard output");
        return code;
    } catch (const Error& e) {
        printError(e.what());
        return int(e.code);
    } catch (const std::bad_alloc&) {
        printError(outOfMemory);
        return int(Exit::resources);
    } catch (const std::exception& e) {
        printError(fmt::format("internal: {}. This is a fault of chiaro; please report it with the command line.", e.what()));
        return int(Exit::internal);
    } catch (...) {
        printError("internal: unknown exception. This is a fault of chiaro; please report it with the command line.");
        return int(Exit::internal);
    }
}

} // namespace
} // namespace chiaro::cli

int main(int argc, char** argv) {
    chiaro::cli::flushDenormals();
    chiaro::cli::exitOnOutOfMemory();
    std::signal(SIGXFSZ, SIG_IGN); // a limit on file sizes is answered like a full disk: by an error, not by the end
    return chiaro::cli::guarded({argv + 1, argv + (argc > 0 ? argc : 1)});
}
