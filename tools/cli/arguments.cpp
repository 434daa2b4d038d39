// The only file that knows CLI11: words in, Arguments out.
#include "tools/cli/command.h"
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

std::string where(const Command& command) { return fmt::format(" (chiaro help {})", command.name); }

[[noreturn]] void unknownOption(const Command& command, const std::string& word) {
    const std::string bare = word.substr(std::min(word.find_first_not_of('-'), word.size()));
    const std::string name = bare.substr(0, bare.find('='));
    const std::string near = nearest(name, optionNames(command));
    throw Error(Exit::usage, fmt::format("unknown option {}{}{}", word.substr(0, word.find('=')),
                                         near.empty() ? "" : fmt::format("; did you mean --{}?", near), where(command)));
}

void checkOperands(const Command& command, const std::vector<std::string>& operands) {
    if (operands.size() < command.leastOperands)
        throw Error(Exit::usage, fmt::format("{} needs {}{}", command.name, command.operands, where(command)));
    if (operands.size() > command.mostOperands)
        throw Error(Exit::usage, fmt::format("unexpected argument \"{}\"{}", operands[command.mostOperands], where(command)));
}

// Every option as a list of strings; meaning and range are checked where the value is used.
struct Parser {
    CLI::App app;
    std::map<std::string_view, std::vector<std::string>> texts;
    std::map<std::string_view, bool> switches;
    std::vector<std::string> operands;

    explicit Parser(const Command& command) {
        app.set_help_flag();
        app.allow_extras();
        for (const OptionRow& o : command.options) {
            const std::string names = o.letter ? fmt::format("-{},--{}", o.letter, o.name) : fmt::format("--{}", o.name);
            if (o.metavar.empty())
                app.add_flag(names, switches[o.name]);
            else
                app.add_option(names, texts[o.name])
                    ->expected(1)
                    ->allow_extra_args(false)
                    ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        }
        app.add_option("operands", operands);
    }
};

} // namespace

const OptionRow* findOption(const Command& command, std::string_view name) {
    const auto at = std::find_if(command.options.begin(), command.options.end(), [&](const OptionRow& o) { return o.name == name; });
    return at == command.options.end() ? nullptr : &*at;
}

std::vector<std::string> optionNames(const Command& command) {
    std::vector<std::string> names;
    for (const OptionRow& o : command.options) names.emplace_back(o.name);
    return names;
}

bool Arguments::on(std::string_view option) const {
    const auto at = values_.find(option);
    return at != values_.end() && at->second.back() != "false";
}

std::string Arguments::text(std::string_view option) const {
    const auto at = values_.find(option);
    if (at != values_.end() && !at->second.empty()) return at->second.back();
    const OptionRow* row = findOption(*command, option);
    return row ? std::string(row->standard) : std::string();
}

std::vector<std::string> Arguments::all(std::string_view option) const {
    const auto at = values_.find(option);
    return at == values_.end() ? std::vector<std::string>() : at->second;
}

std::string shellQuoted(std::string_view word) {
    const auto plain = [](unsigned char c) {
        return std::isalnum(c) || std::string_view("@%_+=:,./-").find(char(c)) != std::string_view::npos;
    };
    if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return std::string(word);
    std::string quoted = "'";
    for (char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

Arguments parseArguments(const Command& command, const std::vector<std::string>& words) {
    Parser parser(command);
    std::vector<std::string> reversed(words.rbegin(), words.rend()); // CLI11 takes them from the back
    try {
        parser.app.parse(reversed);
    } catch (const CLI::ParseError& e) { // a value is missing, or a switch was given one that it cannot take
        const std::string why = e.what(), option = why.substr(0, why.find(':'));
        const std::string name = option.substr(std::min(option.find_last_of('-') == 0 ? 1 : option.find("--") + 2, option.size()));
        const OptionRow* row = findOption(command, name);
        throw Error(Exit::usage, row && !row->metavar.empty() ? fmt::format("--{} needs a value {}{}", name, row->metavar, where(command))
                                                              : fmt::format("{}{}", why, where(command)));
    }
    for (const std::string& word : parser.app.remaining())
        if (word.size() > 1 && word[0] == '-') unknownOption(command, word);

    Arguments arguments;
    arguments.command = &command;
    arguments.operands = std::move(parser.operands);
    for (const std::string& word : parser.app.remaining()) arguments.operands.push_back(word);
    arguments.line = fmt::format("chiaro {}", command.name);
    for (const std::string& word : words) arguments.line += " " + shellQuoted(word);
    for (auto& [name, values] : parser.texts)
        if (!values.empty()) arguments.set(name, std::move(values));
    for (const auto& [name, value] : parser.switches)
        if (parser.app.count("--" + std::string(name)) > 0) arguments.set(name, {value ? "true" : "false"});
    checkOperands(command, arguments.operands);
    if (findOption(command, "config") && arguments.given("config")) applyConfig(arguments, arguments.text("config"));
    return arguments;
}

} // namespace chiaro::cli
