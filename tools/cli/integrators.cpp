// chiaro integrators [NAME]: the registry as people and programs read it, pre-passes included.
#include "integrators/registry.h"
#include "tools/cli/command.h"
#include <algorithm>
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

Json optionsJson(std::span<const OptionSpec> specs) {
    Json options = Json::array();
    for (const OptionSpec& o : specs)
        options.push_back({{"name", o.name}, {"type", typeName(o.type)}, {"default", o.standard}, {"range", rangeOf(o)}, {"help", o.help}});
    return options;
}

Json asJson(const IntegratorEntry& e) {
    const Traits traits = e.traits(Options(e.options));
    return {{"name", e.name},
            {"summary", e.summary},
            {"lightTransport", traits.lightTransport},
            {"unbiased", traits.unbiased},
            {"covers", traits.lightTransport ? traits.covers : ""},
            {"misses", traits.misses},
            {"approximates", traits.lightTransport ? traits.approximates : ""},
            {"prepass", !traits.field.empty()},
            {"options", optionsJson(e.options)}};
}

Json asJson(const PrepassEntry& e) {
    return {{"name", e.name},
            {"kind", "prepass"},
            {"summary", e.summary},
            {"field", e.field(Options(e.options))},
            {"options", optionsJson(e.options)}};
}

void print(std::span<const OptionSpec> options) {
    for (const OptionSpec& o : options)
        fmt::print("{:<12}   {:<14} {} ({}, default {})\n", "", fmt::format("{}=", o.name), o.help, rangeOf(o), o.standard);
}

void print(const PrepassEntry& e) {
    fmt::print("--prepass {}\n{:<12}   {}\n{:<12}   its field: {}\n", e.name, "", e.summary, "", e.field(Options(e.options)));
    print(e.options);
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
    if (!traits.field.empty()) fmt::print("{:<12}   takes --prepass: its diffuse field, by {}\n", "", traits.field);
    print(e.options);
}

// One of them by name: an integrator, a pre-pass, or both where both are called that.
int describe(const std::string& name, bool json) {
    const auto all = prepasses();
    const auto prepass = std::find_if(all.begin(), all.end(), [&](const PrepassEntry& e) { return e.name == name; });
    const auto entries = integrators();
    if (prepass == all.end() || std::any_of(entries.begin(), entries.end(), [&](const IntegratorEntry& e) { return e.name == name; })) {
        const IntegratorEntry& e = *chooseIntegrator(name).entry;
        if (json)
            fmt::print("{}\n", asJson(e).dump(2));
        else
            print(e);
        if (json) return 0;
    }
    if (prepass == all.end()) return 0;
    if (json)
        fmt::print("{}\n", asJson(*prepass).dump(2));
    else
        print(*prepass);
    return 0;
}

} // namespace

int runIntegrators(const Arguments& arguments) {
    if (!arguments.operands.empty()) return describe(arguments.operands[0], arguments.on("json"));
    Json all = Json::array();
    for (const IntegratorEntry& e : integrators()) {
        if (arguments.on("json"))
            all.push_back(asJson(e));
        else
            print(e);
    }
    for (const PrepassEntry& e : prepasses()) {
        if (arguments.on("json"))
            all.push_back(asJson(e));
        else
            print(e);
    }
    if (arguments.on("json")) fmt::print("{}\n", all.dump(2));
    return 0;
}

} // namespace chiaro::cli
