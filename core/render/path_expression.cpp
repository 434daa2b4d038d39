#include "core/render/path_expression.h"
#include "core/render/error.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro {
namespace {

constexpr int unbounded = -1;
constexpr double mostLetters = 2000; // with repetitions written out
constexpr int deepestNesting = 100;
constexpr std::string_view alphabet = "write L La Ld Le, D G S . with R or T behind, E, ? * + {n,m} | ( )";

struct Tree {
    enum class Kind : uint8_t { letter, sequence, choice, repeat } kind = Kind::letter;
    LetterSet letters = 0;
    int least = 1, most = 1;
    std::size_t begin = 0, end = 0; // in the text
    std::vector<Tree> parts;
};

class Parser {
public:
    Parser(std::string_view text, std::string_view option) : text_(text), option_(option) {}

    Tree parse() {
        Tree tree = choice(0);
        if (at_ < text_.size()) fail(at_, "unmatched )", "remove it or open it with (");
        checkPlaces(tree);
        if (written(tree) > mostLetters)
            fail(0, "repetitions write out to more than 2000 letters", "use * or +, or limit the length of paths with --max-depth");
        return tree;
    }

private:
    [[noreturn]] void fail(std::size_t at, std::string_view what, std::string_view fix) const {
        std::string shown(text_.substr(0, 200));
        for (char& c : shown)
            if (c == '\t' || c == '\n' || c == '\r') c = ' ';
        throw Error(Exit::usage,
                    fmt::format("{} \"{}{}\": {} at {}; {}", option_, shown, text_.size() > shown.size() ? "..." : "", what, at + 1, fix));
    }
    char peek() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r')) ++at_;
        return at_ < text_.size() ? text_[at_] : '\0';
    }
    bool take(char c) {
        if (peek() != c) return false;
        ++at_;
        return true;
    }

    Tree choice(int nesting) {
        if (nesting > deepestNesting) fail(at_, "too many nested (", "write it flatter");
        Tree tree = sequence(nesting);
        if (peek() != '|') return tree;
        Tree all{.kind = Tree::Kind::choice, .begin = tree.begin, .parts = {}};
        all.parts.push_back(std::move(tree));
        while (take('|')) all.parts.push_back(sequence(nesting));
        all.end = all.parts.back().end;
        return all;
    }
    Tree sequence(int nesting) {
        peek();
        Tree tree{.kind = Tree::Kind::sequence, .begin = at_, .parts = {}};
        for (char c = peek(); at_ < text_.size() && c != '|' && c != ')'; c = peek()) tree.parts.push_back(repeated(nesting));
        tree.end = at_;
        if (tree.parts.empty())
            fail(at_, text_.find_first_not_of(" \t\r\n") == text_.npos ? "empty expression" : "empty alternative",
                 "write a path such as L D E; ? makes a part optional");
        return tree;
    }
    Tree repeated(int nesting) {
        Tree tree = atom(nesting);
        for (;;) {
            int least = 0, most = unbounded;
            if (take('?'))
                most = 1;
            else if (take('+'))
                least = 1;
            else if (peek() == '{')
                counts(least, most);
            else if (!take('*'))
                return tree;
            Tree around{.kind = Tree::Kind::repeat, .least = least, .most = most, .begin = tree.begin, .end = at_, .parts = {}};
            around.parts.push_back(std::move(tree));
            if (++nesting > deepestNesting) fail(at_, "too many repetition signs in a row", "one is enough");
            tree = std::move(around);
        }
    }
    void counts(int& least, int& most) {
        const std::size_t open = at_;
        ++at_;
        least = most = number(open);
        if (take(',')) most = peek() == '}' ? unbounded : number(open);
        if (!take('}')) fail(at_, "missing }", fmt::format("close the {{ at {}", open + 1));
        if (most != unbounded && most < least) fail(open, "repetition counts down", "write the smaller number first");
    }
    int number(std::size_t open) {
        if (peek() < '0' || peek() > '9') fail(at_, "missing number", fmt::format("write {{n}}, {{n,m}} or {{n,}} at {}", open + 1));
        int n = 0;
        for (; at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9'; ++at_) n = std::min(n * 10 + (text_[at_] - '0'), 1000000);
        return n;
    }
    Tree atom(int nesting) {
        const std::size_t begin = at_;
        if (!take('(')) return oneLetter();
        Tree tree = choice(nesting + 1);
        if (!take(')')) fail(text_.size(), "missing )", fmt::format("close the ( at {}", begin + 1));
        tree.begin = begin;
        tree.end = at_;
        return tree;
    }
    Tree oneLetter() {
        const std::size_t begin = at_;
        const char c = peek();
        ++at_;
        LetterSet letters = 0;
        switch (c) {
        case 'L': letters = light(); break;
        case 'E': letters = eyeLetter; break;
        case 'D': letters = sided(letter(Event::DR), letter(Event::DT)); break;
        case 'G': letters = sided(letter(Event::GR), letter(Event::GT)); break;
        case 'S': letters = sided(letter(Event::SR), letter(Event::ST)); break;
        case '.':
            letters =
                sided(letter(Event::DR) | letter(Event::GR) | letter(Event::SR), letter(Event::DT) | letter(Event::GT) | letter(Event::ST));
            break;
        default: failLetter(begin, c);
        }
        return {.kind = Tree::Kind::letter, .letters = letters, .begin = begin, .end = at_, .parts = {}};
    }
    [[noreturn]] void failLetter(std::size_t at, char c) const {
        if (c == '?' || c == '*' || c == '+' || c == '{') fail(at, fmt::format("nothing before {}", c), "write what it repeats");
        if (c == 'R' || c == 'T') fail(at, fmt::format("lone {}", c), fmt::format("write it behind D, G, S or . as in S{}", c));
        if (c == 'l' || c == 'd' || c == 'g' || c == 's' || c == 'e')
            fail(at, fmt::format("unknown letter {}", c), fmt::format("did you mean {}?", char(c - 'a' + 'A')));
        const bool printable = c > ' ' && c < 127;
        fail(at, printable ? fmt::format("unknown letter {}", c) : std::string("unknown character"), alphabet);
    }
    LetterSet light() {
        if (take('a')) return letter(LightKind::area);
        if (take('d')) return letter(LightKind::delta);
        if (take('e')) return letter(LightKind::environment);
        return anyLight;
    }
    LetterSet sided(int reflected, int transmitted) {
        if (take('R')) return LetterSet(reflected);
        if (take('T')) return LetterSet(transmitted);
        return LetterSet(reflected | transmitted);
    }

    // How far along a path one may be, as bits: before the light, among the events, behind the eye.
    static constexpr int before = 1, amid = 2, behind = 4;
    int places(const Tree& tree, int from) const {
        switch (tree.kind) {
        case Tree::Kind::letter: {
            if (from & behind) fail(tree.begin, "something follows the eye", "end the path with E");
            if (tree.letters & anyLight) {
                if (from & amid) fail(tree.begin, "light inside a path", "a light stands only at the beginning");
                return amid;
            }
            if (from & before) fail(tree.begin, "path without a light", "begin with L, La, Ld or Le");
            return tree.letters == eyeLetter ? behind : amid;
        }
        case Tree::Kind::sequence:
            for (const Tree& part : tree.parts) from = places(part, from);
            return from;
        case Tree::Kind::choice: {
            int to = 0;
            for (const Tree& part : tree.parts) to |= places(part, from);
            return to;
        }
        case Tree::Kind::repeat: break;
        }
        if (tree.most == 0) return from;
        const int once = places(tree.parts[0], from);
        if (tree.most != 1) places(tree.parts[0], once); // letters in a repetition are events, or this throws
        return tree.least == 0 ? from | once : once;
    }
    void checkPlaces(const Tree& tree) const {
        const bool many = tree.kind == Tree::Kind::choice;
        for (std::size_t i = 0; i < (many ? tree.parts.size() : 1); ++i) {
            const Tree& path = many ? tree.parts[i] : tree;
            if (places(path, before) == behind) continue;
            const std::size_t last = text_.find_last_not_of(" \t\r\n", path.end - 1);
            fail(last + 1, "path does not reach the eye", "end every alternative with E");
        }
    }
    static double written(const Tree& tree) {
        double letters = tree.kind == Tree::Kind::letter ? 1 : 0;
        for (const Tree& part : tree.parts) letters += written(part);
        return tree.kind == Tree::Kind::repeat ? std::max(1, std::max(tree.least, tree.most)) * std::max(1.0, letters) : letters;
    }

    std::string_view text_, option_;
    std::size_t at_ = 0;
};

// The node where reading `tree` begins, if reading goes on at `next` behind it.
int build(const Tree& tree, int next, std::vector<PathExpression::Node>& nodes) {
    const auto add = [&](PathExpression::Node n) {
        nodes.push_back(n);
        return int(nodes.size()) - 1;
    };
    switch (tree.kind) {
    case Tree::Kind::letter: return add({tree.letters, {next, -1}});
    case Tree::Kind::sequence:
        for (auto part = tree.parts.rbegin(); part != tree.parts.rend(); ++part) next = build(*part, next, nodes);
        return next;
    case Tree::Kind::choice: {
        int entry = build(tree.parts.back(), next, nodes);
        for (std::size_t i = tree.parts.size() - 1; i-- > 0;) entry = add({0, {build(tree.parts[i], next, nodes), entry}});
        return entry;
    }
    case Tree::Kind::repeat: break;
    }
    int entry = next;
    if (tree.most == unbounded) {
        entry = add({0, {-1, next}});
        const int body = build(tree.parts[0], entry, nodes);
        nodes[std::size_t(entry)].to[0] = body;
    } else {
        for (int i = tree.least; i < tree.most; ++i) entry = add({0, {build(tree.parts[0], entry, nodes), next}});
    }
    for (int i = 0; i < tree.least; ++i) entry = build(tree.parts[0], entry, nodes);
    return entry;
}

} // namespace

PathExpression PathExpression::parse(std::string_view text, std::string_view option) {
    const Tree tree = Parser(text, option).parse();
    PathExpression e;
    e.nodes_.push_back({}); // behind the eye
    e.start_ = build(tree, 0, e.nodes_);
    return e;
}

} // namespace chiaro
