// --config FILE.json: an object whose keys are the long options, e.g. {"spp": 64, "size": "640x360", "output": ["a.exr", "a.png"]}.
#include "tools/cli/command.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using Json = nlohmann::json;

std::string asText(const Json& value, const std::string& place) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
    if (value.is_number_integer()) return value.dump();
    if (value.is_number_float()) return fmt::format("{}", value.get<double>());
    throw Error(Exit::usage, place + " must be a string, a number or true/false");
}

std::vector<std::string> asTexts(const OptionRow& row, const Json& value, const std::string& place) {
    if (row.metavar.empty() && !value.is_boolean()) throw Error(Exit::usage, place + " must be true or false");
    if (!value.is_array()) return {asText(value, place)};
    if (!row.repeatable || value.empty()) throw Error(Exit::usage, place + " takes one value, not a list");
    std::vector<std::string> all;
    for (const Json& v : value) all.push_back(asText(v, place));
    return all;
}

} // namespace

void applyConfig(Arguments& arguments, const std::string& file) {
    std::ifstream in(file);
    if (!in) throw Error(Exit::file, fmt::format("{}: no such configuration file, or not readable", file));
    Json config;
    try {
        config = Json::parse(in);
    } catch (const Json::parse_error& e) {
        const std::string why = e.what();
        throw Error(Exit::file,
                    fmt::format("{}: not valid JSON: {}", file, why.substr(why.find("] ") == std::string::npos ? 0 : why.find("] ") + 2)));
    }
    if (!config.is_object()) throw Error(Exit::file, fmt::format("{}: must be a JSON object of options, e.g. {{\"spp\": 64}}", file));
    for (const auto& [key, value] : config.items()) {
        const OptionRow* row = findOption(*arguments.command, key);
        if (!row || key == "config") {
            const std::string near = nearest(key, optionNames(*arguments.command));
            throw Error(Exit::usage, fmt::format("{}: unknown option \"{}\"{} (chiaro help {})", file, key,
                                                 near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near), arguments.command->name));
        }
        std::vector<std::string> texts = asTexts(*row, value, fmt::format("{}: \"{}\"", file, key));
        if (!arguments.given(key)) arguments.set(key, std::move(texts));
    }
}

} // namespace chiaro::cli
