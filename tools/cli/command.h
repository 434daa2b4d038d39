// The command line as data: one table of subcommands, each with one table of options. The parser, `chiaro help`, the suggestions for
// typing errors, --config and the replay line of a dropped sample all read these tables.
#pragma once
#include "core/render/error.h"
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro::cli {

struct OptionRow {
    std::string_view name = {};    // long, without its dashes
    char letter = 0;               // short form; 0: none
    std::string_view metavar = {}; // empty: a switch
    std::string_view help = {};
    std::string_view standard = {}; // the default as one would type it; empty: none
    std::string_view group = {};
    bool repeatable = false;
    bool sample = false; // the value of a single sample depends on it
};

class Arguments;
struct Command {
    std::string_view name, operands, summary;
    std::span<const OptionRow> options;
    int (*run)(const Arguments&);
    std::size_t leastOperands = 0, mostOperands = 0;
    std::string (*notes)() = nullptr; // what `chiaro help` adds below the options
};
std::span<const Command> commands();

// What was asked for: command line before --config before default.
class Arguments {
public:
    const Command* command = nullptr;
    std::vector<std::string> operands;
    std::string line; // as typed, quoted for a shell

    bool given(std::string_view option) const { return values_.find(option) != values_.end(); }
    bool on(std::string_view option) const;          // a switch
    std::string text(std::string_view option) const; // the last one given, else the default
    std::vector<std::string> all(std::string_view option) const;
    void set(std::string_view option, std::vector<std::string> values) { values_[std::string(option)] = std::move(values); }

private:
    std::map<std::string, std::vector<std::string>, std::less<>> values_;
};

const OptionRow* findOption(const Command&, std::string_view name);
std::vector<std::string> optionNames(const Command&);

// words: after the name of the command. Throws Error(Exit::usage).
Arguments parseArguments(const Command&, const std::vector<std::string>& words);
// Values of a JSON object for the options that the command line left open.
void applyConfig(Arguments&, const std::string& file);
std::string shellQuoted(std::string_view word);

// Subcommands, one file each.
int runRender(const Arguments&);
int runInfo(const Arguments&);
int runFormFactors(const Arguments&);
int runCompare(const Arguments&);
int runDiff(const Arguments&);
int runAgree(const Arguments&);
int runTrace(const Arguments&);
int runBake(const Arguments&);
int runScenes(const Arguments&);
int runIntegrators(const Arguments&);
int runBench(const Arguments&);
int runMerge(const Arguments&);
int runDoctor(const Arguments&);
int runHelp(const Arguments&);
std::span<const OptionRow> renderOptions();
std::span<const OptionRow> infoOptions();
std::string diffNotes();
std::string agreeNotes();
std::string benchNotes();
std::string mergeNotes();
std::string compareNotes();

std::string commandHelp(const Command&);
std::string overview();

} // namespace chiaro::cli
