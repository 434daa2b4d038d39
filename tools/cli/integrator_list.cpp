#include "tools/cli/integrator_list.h"
#include "tools/cli/settings.h"
#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t"), end = text.find_last_not_of(" \t");
    return begin == std::string_view::npos ? std::string_view() : text.substr(begin, end - begin + 1);
}

bool isOption(std::string_view piece) {
    const std::size_t equals = piece.find('=');
    return equals != std::string_view::npos && equals < piece.find(':');
}

} // namespace

std::vector<std::string> splitIntegrators(std::string_view list) {
    std::vector<std::string> all;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const std::string_view piece = trimmed(list.substr(begin, end - begin));
        begin = end + 1;
        if (piece.empty())
            throw Error(Exit::usage, fmt::format("-i \"{}\": a name is missing; write -i NAME[:key=value,...],NAME,...", list));
        if (!isOption(piece)) {
            all.emplace_back(piece);
            continue;
        }
        if (all.empty())
            throw Error(Exit::usage,
                        fmt::format("-i \"{}\": \"{}\" is an option; the name of its integrator comes first, NAME:{}", list, piece, piece));
        std::string& owner = all.back();
        owner += (owner.find(':') == std::string::npos ? ":" : ",") + std::string(piece);
    }
    return all;
}

std::vector<IntegratorChoice> chooseIntegrators(std::string_view list) {
    std::vector<IntegratorChoice> all;
    std::vector<std::string> recipes;
    for (const std::string& text : splitIntegrators(list)) {
        all.push_back(chooseIntegrator(text));
        recipes.push_back(integratorRecipe(all.back()));
        if (std::find(recipes.begin(), recipes.end() - 1, recipes.back()) != recipes.end() - 1)
            throw Error(Exit::usage, fmt::format("-i: {} is named twice; leave one out or give it other options", recipes.back()));
    }
    return all;
}

std::vector<IntegratorChoice> allLightTransport() {
    std::vector<IntegratorChoice> all;
    for (const IntegratorEntry& e : integrators())
        if (e.traits(Options(e.options)).lightTransport) all.push_back({&e, Options(e.options)});
    return all;
}

std::string fileName(const IntegratorChoice& choice, const PrepassChoice* prepass) {
    const auto plain = [](std::string name) {
        for (char& c : name)
            if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '_') c = '-';
        return name;
    };
    return plain(integratorRecipe(choice)) + (prepass ? "+" + plain(prepassRecipe(*prepass)) : "");
}

} // namespace chiaro::cli
