// chiaro integrators [NAME]: the registry as people and programs read it.
#include "integrators/registry.h"
#include "tools/cli/command.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string rangeOf(const OptionSpec& o) {
    switch (o.type) {
    case OptionType::boolean: return "on|off";
    case OptionType::choice: return std::string(o.choices);
    default: return fmt::format("{:g} to {:g}", o.least, o.most);
    }
}

const char* typeName(OptionType type) {
    switch (type) {
    case OptionType::integer: return "integer";
    case OptionType::real: return "number";
    case OptionType::boolean: return "switch";
    default: return "choice";
    }
}

Json asJson(const IntegratorEntry& e) {
    const Traits traits = e.traits(Options(e.options));
    Json options = Json::array();
    for (const OptionSpec& o : e.options)
        options.push_back({{"name", o.name}, {"type", typeName(o.type)}, {"default", o.standard}, {"range", rangeOf(o)}, {"help", o.help}});
    return {{"name", e.name},
            {"summary", e.summary},
            {"lightTransport", traits.lightTransport},
            {"unbiased", traits.unbiased},
            {"covers", traits.lightTransport ? traits.covers : ""},
            {"misses", traits.misses},
            {"approximates", traits.lightTransport ? traits.approximates : ""},
            {"options", std::move(options)}};
}

void print(const IntegratorEntry& e) {
    const Traits traits = e.traits(Options(e.options));
    fmt::print("{:<12} {}\n", e.name, e.summary);
    if (traits.lightTransport) {
        fmt::print("{:<12}   covers {}{}", "", traits.covers, traits.unbiased ? "" : " (biased)");
        fmt::print("{}", traits.misses.empty() ? "" : "; cannot find " + traits.misses);
        fmt::print("{}\n", traits.approximates.empty() ? "" : "; approximates " + traits.approximates);
    } else {
        fmt::print("{:<12}   a debug view: no light paths\n", "");
    }
    for (const OptionSpec& o : e.options)
        fmt::print("{:<12}   {:<14} {} ({}, default {})\n", "", fmt::format("{}=", o.name), o.help, rangeOf(o), o.standard);
}

} // namespace

int runIntegrators(const Arguments& arguments) {
    if (!arguments.operands.empty()) {
        const IntegratorEntry& e = *chooseIntegrator(arguments.operands[0]).entry;
        if (arguments.on("json"))
            fmt::print("{}\n", asJson(e).dump(2));
        else
            print(e);
        return 0;
    }
    Json all = Json::array();
    for (const IntegratorEntry& e : integrators()) {
        if (arguments.on("json"))
            all.push_back(asJson(e));
        else
            print(e);
    }
    if (arguments.on("json")) fmt::print("{}\n", all.dump(2));
    return 0;
}

} // namespace chiaro::cli
