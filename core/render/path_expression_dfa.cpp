#include "core/render/path_expression_dfa.h"
#include "core/render/error.h"
#include <algorithm>
#include <functional>
#include <map>

namespace chiaro {
namespace {

constexpr std::size_t mostStates = 20000;

// All expressions side by side as one nondeterministic automaton.
struct Union {
    std::vector<PathExpression::Node> nodes;
    std::vector<int> owner;
    std::vector<int> starts;

    explicit Union(std::span<const PathExpression> expressions) {
        for (std::size_t i = 0; i < expressions.size(); ++i) {
            const int offset = int(nodes.size());
            for (PathExpression::Node n : expressions[i].nodes()) {
                for (int& to : n.to)
                    if (to >= 0) to += offset;
                nodes.push_back(n);
                owner.push_back(int(i));
            }
            starts.push_back(expressions[i].start() + offset);
        }
    }
    // The reading nodes that can be reached from these without reading, in order.
    std::vector<int> closure(std::vector<int> open) const {
        std::vector<bool> seen(nodes.size());
        std::vector<int> reading;
        while (!open.empty()) {
            const int n = open.back();
            open.pop_back();
            if (n < 0 || seen[std::size_t(n)]) continue;
            seen[std::size_t(n)] = true;
            const PathExpression::Node& node = nodes[std::size_t(n)];
            if (node.letters)
                reading.push_back(n);
            else
                open.insert(open.end(), {node.to[0], node.to[1]});
        }
        std::sort(reading.begin(), reading.end());
        return reading;
    }
    std::vector<int> read(const std::vector<int>& from, LetterSet letter) const {
        std::vector<int> to;
        for (const int n : from)
            if (nodes[std::size_t(n)].letters & letter) to.push_back(nodes[std::size_t(n)].to[0]);
        return closure(std::move(to));
    }
    uint64_t accepts(const std::vector<int>& at) const {
        uint64_t which = 0;
        for (const int n : at)
            if (nodes[std::size_t(n)].letters & eyeLetter) which |= uint64_t(1) << owner[std::size_t(n)];
        return which;
    }
};

using Wanted = std::function<bool(uint64_t accepts)>;

// A shortest word of letters, each a set of letters every choice of which is wanted.
class Search {
public:
    Search(const PathDfa& dfa, const Wanted& wanted, const PathsPresent& present) : dfa_(dfa), wanted_(wanted), present_(present) {}

    std::optional<std::string> first() const {
        std::vector<LetterSet> word;
        if (!shortest(word)) return std::nullopt;
        std::string text;
        for (LetterSet& l : word) {
            const LetterSet one = l;
            if (&l == word.data()) {
                if (LetterSet(present_.letters & anyLight) == anyLight) widen(word, l, anyLight);
                text = l == anyLight ? "L" : l & letter(LightKind::area) ? "La" : l & letter(LightKind::delta) ? "Ld" : "Le";
                continue;
            }
            const LetterSet pair = LetterSet(pairOf(one) & present_.letters);
            widen(word, l, pair);
            text += ' ';
            text += "DGS"[indexOf(one) / 2];
            if (l != pair) text += "RT"[indexOf(one) % 2];
        }
        return text + " E";
    }

private:
    static int indexOf(LetterSet event) noexcept { return __builtin_ctz(event) - lightKindCount; }
    static LetterSet pairOf(LetterSet event) noexcept { return LetterSet(3u << (lightKindCount + indexOf(event) / 2 * 2)); }

    bool shortest(std::vector<LetterSet>& word) const {
        struct Step {
            uint32_t state, depth;
            std::size_t from;
            LetterSet letter;
        };
        std::vector<Step> steps;
        std::vector<bool> seen(dfa_.next.size());
        seen[0] = true;
        const auto visit = [&](uint32_t state, uint32_t depth, std::size_t from, LetterSet l) {
            if (!(present_.letters & l) || seen[state] || depth > present_.maxDepth) return;
            seen[state] = true;
            steps.push_back({state, depth, from, l});
        };
        for (int k = 0; k < lightKindCount; ++k) visit(dfa_.start[std::size_t(k)], 0, ~std::size_t(0), letter(LightKind(k)));
        for (std::size_t i = 0; i < steps.size(); ++i) {
            const Step step = steps[i];
            if (wanted_(dfa_.accepts[step.state])) {
                for (std::size_t j = i; j != ~std::size_t(0); j = steps[j].from) word.insert(word.begin(), steps[j].letter);
                return true;
            }
            for (int e = 0; e < eventCount; ++e) visit(dfa_.next[step.state][std::size_t(e)], step.depth + 1, i, letter(Event(e)));
        }
        return false;
    }
    void widen(std::vector<LetterSet>& word, LetterSet& l, LetterSet to) const {
        const LetterSet narrow = l;
        l = to;
        if (!allWanted(word)) l = narrow;
    }
    bool allWanted(const std::vector<LetterSet>& word) const {
        std::vector<uint32_t> at, to;
        for (int k = 0; k < lightKindCount; ++k)
            if (word[0] & letter(LightKind(k))) at.push_back(dfa_.start[std::size_t(k)]);
        for (std::size_t i = 1; i < word.size(); ++i) {
            to.clear();
            for (const uint32_t s : at)
                for (int e = 0; e < eventCount; ++e)
                    if (word[i] & letter(Event(e))) to.push_back(dfa_.next[s][std::size_t(e)]);
            std::sort(to.begin(), to.end());
            to.erase(std::unique(to.begin(), to.end()), to.end());
            at.swap(to);
        }
        return std::all_of(at.begin(), at.end(), [&](uint32_t s) { return wanted_(dfa_.accepts[s]); });
    }

    const PathDfa& dfa_;
    const Wanted& wanted_;
    const PathsPresent& present_;
};

bool blank(std::string_view text) { return text.find_first_not_of(" \t\r\n") == text.npos; }

// In all of the first, in none of the second.
std::optional<std::string> search(std::initializer_list<std::string_view> in, std::string_view without, const PathsPresent& present) {
    std::vector<PathExpression> all;
    for (const std::string_view one : in) all.push_back(blank(one) ? PathExpression::all() : PathExpression::parse(one));
    const uint64_t mask = (uint64_t(1) << in.size()) - 1;
    if (!blank(without)) all.push_back(PathExpression::parse(without));
    const PathDfa dfa = determinise(all);
    const Wanted wanted = [mask](uint64_t accepts) { return accepts == mask; };
    return Search(dfa, wanted, present).first();
}

} // namespace

PathDfa determinise(std::span<const PathExpression> expressions) {
    const Union all(expressions);
    PathDfa dfa;
    std::map<std::vector<int>, uint32_t> ids;
    std::vector<const std::vector<int>*> subsets;
    const auto id = [&](std::vector<int> subset) {
        const auto [place, fresh] = ids.emplace(std::move(subset), uint32_t(subsets.size()));
        if (fresh) {
            if (subsets.size() >= mostStates)
                throw Error(Exit::usage, "light paths: the expressions together need more than 20000 states; shorten repetitions such as "
                                         "{n,m}, or limit the length of paths with --max-depth");
            subsets.push_back(&place->first);
            dfa.accepts.push_back(all.accepts(place->first));
        }
        return place->second;
    };
    id({});
    const std::vector<int> begin = all.closure(all.starts);
    for (int k = 0; k < lightKindCount; ++k) dfa.start[std::size_t(k)] = id(all.read(begin, letter(LightKind(k))));
    for (std::size_t s = 0; s < subsets.size(); ++s) {
        std::array<uint32_t, eventCount> row{};
        for (int e = 0; e < eventCount; ++e) row[std::size_t(e)] = id(all.read(*subsets[s], letter(Event(e))));
        dfa.next.push_back(row);
    }
    return dfa;
}

std::optional<std::string> firstMissing(std::string_view wanted, std::string_view covered, const PathsPresent& present) {
    return search({wanted}, covered, present);
}
std::optional<std::string> firstCommon(std::string_view a, std::string_view b, const PathsPresent& present) {
    return firstCommon(a, b, {}, present);
}
std::optional<std::string> firstCommon(std::string_view a, std::string_view b, std::string_view without, const PathsPresent& present) {
    return blank(b) ? std::nullopt : search({a, b}, without, present);
}

} // namespace chiaro
