// Who is on trial, and on which light paths: from the registry's traits.
#include "tools/cli/agree_settings.h"
#include "tools/cli/agree_stage.h"
#include "tools/judge/convergence.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

std::string either(const std::string& a, const std::string& b) { return a.empty() || a == b ? b : b.empty() ? a : a + " | " + b; }

PathQuery judgedPaths(const Traits& traits, const PathQuery& wanted) {
    const IntegratorChoice reference = chooseIntegrator(referenceName);
    PathQuery q = wanted;
    q.within = traits.covers;
    q.without = either(traits.misses, reference.entry->traits(reference.options).misses);
    return q;
}

std::string inWords(const PathQuery& q) {
    std::string text = q.paths.empty() ? q.within : q.paths;
    PathQuery covered;
    covered.paths = q.within;
    if (!q.paths.empty() && PathClasses::make(covered).hash() != PathClasses().hash()) text += " within " + q.within;
    if (!q.without.empty()) text += " without " + q.without;
    if (q.maxDepth != unlimitedDepth) text += fmt::format(", depth {} at most", q.maxDepth);
    return text;
}

// prepass: it is its field that converges; null: the integrator itself.
void addLevels(Subject& s, const PrepassChoice* prepass) {
    if (s.traits.unbiased || s.traits.convergesOver.empty()) return;
    const std::string& option = s.traits.convergesOver;
    const Options& chosen = prepass ? prepass->options : s.choice.options;
    const std::span<const OptionSpec> specs = prepass ? prepass->entry->options : s.choice.entry->options;
    double h = chosen.real(option);
    if (!(h > 0)) throw Error(Exit::usage, fmt::format("-i {}: {}={} must be above 0: agree looks at its limit", s.name, option, h));
    const auto spec = std::find_if(specs.begin(), specs.end(), [&](const OptionSpec& o) { return o.name == option; });
    s.levels.clear();
    for (std::size_t l = 0; l < s.traits.convergencePowers.size() + 2; ++l, h *= s.traits.convergenceStep) {
        const double value = spec->type == OptionType::integer ? std::round(h) : h;
        const std::string text = fmt::format("{}", value),
                          owner = fmt::format("agree -i {}, which also renders {}={:g}", s.name, option, value);
        s.levels.push_back(s.choice);
        if (prepass) s.fields.push_back(*prepass);
        (prepass ? s.fields.back().options : s.levels.back().options).set(option, text, owner);
        s.parameter.push_back(value);
    }
    s.weights = limitWeights(s.parameter, s.traits.convergencePowers);
}

} // namespace

std::vector<double> limitWeights(const std::vector<double>& h, const std::vector<double>& powers) {
    std::vector<double> exponents{0}, weights;
    exponents.insert(exponents.end(), powers.begin(), powers.end());
    for (std::size_t l = 0; l < h.size(); ++l) { // the fit is linear in y: its answer to a unit vector is one weight
        std::vector<judge::FitPoint> unit;
        for (std::size_t k = 0; k < h.size(); ++k) unit.push_back({h[k] / h[0], k == l ? 1.0 : 0.0, 1});
        const auto fit = judge::fitPowers(unit, exponents);
        if (!fit) throw Error(Exit::internal, "the convergence powers of an integrator cannot be told apart by its levels");
        weights.push_back(fit->coefficient[0]);
    }
    return weights;
}

std::vector<Subject> makeSubjects(const std::vector<IntegratorChoice>& choices, const PathQuery& query, bool limits,
                                  const PrepassChoice* prepass, bool kept) {
    std::vector<Subject> all;
    std::vector<uint64_t> hashes;
    const std::string reference = integratorRecipe(chooseIntegrator(referenceName));
    for (const IntegratorChoice& choice : choices) {
        Subject s{.choice = choice,
                  .traits = traitsWith(choice, prepass),
                  .name = nameWith(choice, prepass),
                  .judgedOn = {},
                  .classes = PathClasses(),
                  .levels = {},
                  .parameter = {},
                  .weights = {},
                  .fields = {},
                  .solvers = {},
                  .paired = false};
        const PathQuery judged = judgedPaths(s.traits, query);
        s.judgedOn = inWords(judged);
        try {
            s.classes = PathClasses::make(judged);
        } catch (const Error& e) { throw Error(e.code, fmt::format("-i {}: nothing to judge on {} ({})", s.name, s.judgedOn, e.what())); }
        const auto at = std::find(hashes.begin(), hashes.end(), s.classes.hash());
        s.reference = std::size_t(at - hashes.begin());
        if (at == hashes.end()) hashes.push_back(s.classes.hash());
        s.levels = {s.choice};
        s.weights = {1};
        const PrepassChoice* field = prepassFor(choice, prepass);
        if (limits && !(field && kept)) addLevels(s, field);
        s.paired = limits && !s.converging() && s.name != reference;
        all.push_back(std::move(s));
    }
    return all;
}

std::size_t referenceCount(const std::vector<Subject>& subjects) {
    std::size_t count = 0;
    for (const Subject& s : subjects) count = std::max(count, s.reference + 1);
    return count;
}

} // namespace chiaro::cli
