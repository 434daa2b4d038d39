#include "tools/cli/prepass_settings.h"
#include "io/solution_file.h"
#include "tools/cli/settings.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::cli {
namespace {

// What the file holds, where it is there and readable.
std::string storedRecipe(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return {};
    return valueOf(readSolutions(file).front().key, "prepass");
}

std::vector<std::string> takers() {
    std::vector<std::string> names;
    for (const IntegratorEntry& e : integrators())
        if (takesPrepass({&e, Options(e.options)})) names.emplace_back(e.name);
    return names;
}

// What is left in the limit of the integrator's own option is the error of the field. A field that an integrator shows as well comes near
// over the same option by the same powers.
void convergeAs(const PrepassChoice& prepass, Traits& t) {
    t.convergesOver.clear();
    const auto all = integrators();
    const auto shown = std::find_if(all.begin(), all.end(), [&](const IntegratorEntry& e) { return e.name == prepass.entry->name; });
    if (shown == all.end()) return;
    Options same(shown->options);
    const auto has = [](std::span<const OptionSpec> options, std::string_view name) {
        return std::any_of(options.begin(), options.end(), [&](const OptionSpec& o) { return o.name == name; });
    };
    for (const OptionSpec& o : prepass.entry->options)
        if (has(shown->options, o.name)) same.set(o.name, prepass.options.text(o.name), prepass.entry->name);
    const Traits field = shown->traits(same);
    if (field.unbiased || !has(prepass.entry->options, field.convergesOver)) return;
    t.convergesOver = field.convergesOver;
    t.convergencePowers = field.convergencePowers;
    t.convergenceStep = field.convergenceStep;
}

} // namespace

PrepassSettings readPrepass(const Arguments& a) {
    PrepassSettings s;
    if (a.given("prepass-file")) {
        s.file = a.text("prepass-file");
        if (s.file.empty() || s.file == "-") throw Error(Exit::usage, "--prepass-file: give the name of a file");
    }
    std::string text = a.text("prepass");
    if (!a.given("prepass") && !s.file.empty()) {
        text = storedRecipe(s.file);
        if (text.empty())
            throw Error(Exit::usage, fmt::format("--prepass-file {}: there is nothing in it yet; say what is to be solved and kept there: "
                                                 "--prepass NAME (chiaro help integrators)",
                                                 s.file.string()));
    }
    if (a.given("prepass") || !text.empty()) s.choice = choosePrepass(text);
    return s;
}

std::string prepassRecipe(const PrepassChoice& choice) {
    const std::string options = choice.options.recipe();
    return fmt::format("{}{}{}", choice.entry->name, options.empty() ? "" : ":", options);
}

bool takesPrepass(const IntegratorChoice& choice) { return !choice.entry->traits(choice.options).field.empty(); }

const PrepassChoice* prepassFor(const IntegratorChoice& choice, const PrepassChoice* prepass) {
    return prepass && takesPrepass(choice) ? prepass : nullptr;
}

void requireTaker(const PrepassSettings& s, const std::vector<IntegratorChoice>& choices) {
    if (!s.choice || std::any_of(choices.begin(), choices.end(), takesPrepass)) return;
    std::vector<std::string> names;
    for (const IntegratorChoice& c : choices) names.push_back(integratorRecipe(c));
    throw Error(Exit::unsupported,
                fmt::format("--prepass {}: {} {} no pre-pass; its diffuse field has a place in {}. Leave it out, or try -i {}",
                            prepassRecipe(*s.choice), fmt::join(names, ", "), names.size() == 1 ? "takes" : "take",
                            fmt::join(takers(), " and "), takers().empty() ? "path" : takers().front()));
}

std::string takersText(const std::vector<IntegratorChoice>& choices) {
    std::string with, without;
    uint32_t left = 0;
    for (const IntegratorChoice& c : choices) {
        const bool takes = takesPrepass(c);
        std::string& to = takes ? with : without;
        to += (to.empty() ? "" : ", ") + integratorRecipe(c);
        left += !takes;
    }
    return without.empty() ? with : fmt::format("{}; {} {} none", with, without, left == 1 ? "takes" : "take");
}

Traits traitsWith(const IntegratorChoice& choice, const PrepassChoice* prepass) {
    Traits t = choice.entry->traits(choice.options);
    if (!prepass || t.field.empty()) return t;
    t.covers = coveredWith(t, prepass);
    t.unbiased = false;
    convergeAs(*prepass, t);
    return t;
}

std::string nameWith(const IntegratorChoice& choice, const PrepassChoice* prepass) {
    return integratorRecipe(choice) + (prepassFor(choice, prepass) ? " + " + prepassRecipe(*prepass) : "");
}

} // namespace chiaro::cli
