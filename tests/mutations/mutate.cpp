#include "tests/mutations/mutate.h"
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

namespace chiaro::test {

using nlohmann::json;

namespace {

// A file as its JSON and, of a .glb, what comes after the JSON chunk.
struct Parts {
    json document;
    std::string rest;
    bool binary = false;
};

uint32_t u32At(const std::string& s, std::size_t at) {
    uint32_t v = 0;
    if (at + 4 <= s.size()) std::memcpy(&v, &s[at], 4);
    return v;
}
std::string u32Text(std::size_t v) {
    const uint32_t value = uint32_t(v);
    return {reinterpret_cast<const char*>(&value), 4};
}

Parts taken(const std::string& whole) {
    Parts p;
    p.binary = whole.starts_with("glTF") && whole.size() >= 20;
    const std::size_t size = p.binary ? std::min<std::size_t>(u32At(whole, 12), whole.size() - 20) : whole.size();
    const std::string text = whole.substr(p.binary ? 20 : 0, size);
    p.document = json::parse(text, nullptr, false);
    if (p.binary) p.rest = whole.substr(20 + size);
    return p;
}
std::string joined(const Parts& p) {
    std::string text = p.document.dump(-1, ' ', false, json::error_handler_t::replace);
    if (!p.binary) return text;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return "glTF" + u32Text(2) + u32Text(20 + text.size() + p.rest.size()) + u32Text(text.size()) + "JSON" + text + p.rest;
}

// All values below the root, by where they are.
void collect(json& value, std::vector<json*>& all) {
    if (!value.is_structured()) return;
    for (auto& member : value) {
        all.push_back(&member);
        collect(member, all);
    }
}

json wild(Dice& dice) {
    const json values[] = {0,
                           1,
                           2,
                           -1,
                           255,
                           65535,
                           1000000,
                           2147483647,
                           4294967295u,
                           9007199254740993ull,
                           18446744073709551615ull,
                           0.5,
                           -0.0,
                           1e-40,
                           -1e38,
                           1e300,
                           nullptr,
                           true,
                           "",
                           "\xc3\xbc../../\x01",
                           "SCALAR",
                           "VEC3",
                           "data:;base64,AAAA",
                           json::array(),
                           json::object(),
                           json::array({0, 0, 0}),
                           json::array({1e30, -1e30, 1e30, 1e30}),
                           json::array({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})};
    return values[dice.below(std::size(values))];
}

// A number that is still one: what is of the wrong type is found at once.
json otherNumber(const json& value, Dice& dice) {
    if (value.is_number_integer() && value.get<int64_t>() > -1000000 && value.get<int64_t>() < 1000000 && dice.below(4) != 0)
        return value.get<int64_t>() * int64_t(dice.below(3)) + int64_t(dice.below(5)) - 2;
    constexpr double factors[] = {0, -1, 0.5, 2, 1e-10, 1e5, 1e18, 1e37};
    return value.get<double>() * factors[dice.below(std::size(factors))];
}

void disturb(json& value, std::vector<json*>& all, Dice& dice) {
    if (value.is_number() && dice.below(4) != 0) {
        value = otherNumber(value, dice);
        return;
    }
    switch (dice.below(5)) {
    case 1: value = json(*all[dice.below(all.size())]); return;
    case 2:
        if (value.is_array() && !value.empty()) {
            const json more = value[dice.below(value.size())];
            for (std::size_t n = std::size_t(1) << dice.below(10); n > 0; --n) value.push_back(more);
            return;
        }
        break;
    case 3:
        if (value.is_structured() && !value.empty()) {
            auto gone = value.begin();
            std::advance(gone, std::ptrdiff_t(dice.below(value.size())));
            value.erase(gone);
            return;
        }
        break;
    default: break;
    }
    value = wild(dice);
}

} // namespace

std::string withWildValue(const std::string& whole, Dice& dice) {
    Parts parts = taken(whole);
    if (parts.document.is_discarded()) return whole;
    std::vector<json*> all;
    collect(parts.document, all);
    if (all.empty()) return whole;
    disturb(*all[dice.below(all.size())], all, dice);
    return joined(parts);
}

std::string mutated(const std::string& whole, uint64_t seed) {
    Dice dice(seed);
    std::string out = whole;
    switch (dice.below(8)) {
    case 0: out.resize(dice.below(out.size())); return out;
    case 1:
        for (std::size_t n = 1 + dice.below(16); n > 0; --n) out[dice.below(out.size())] = char(dice.next());
        return out;
    case 2: // in the buffers and pictures alone, where there are some
    case 3: {
        const std::size_t first = out.starts_with("glTF") ? std::min<std::size_t>(out.size() - 1, 28 + u32At(out, 12)) : 0;
        for (std::size_t n = 1 + dice.below(16); n > 0; --n) out[first + dice.below(out.size() - first)] = char(dice.next());
        return out;
    }
    case 4: { // in the JSON, or what stands in its place
        const std::size_t most = std::min<std::size_t>(out.size(), out.starts_with("glTF") ? 20 + u32At(out, 12) : out.size());
        for (std::size_t n = 1 + dice.below(4); n > 0; --n) out[dice.below(most)] = "0123456789-[]{},\":e."[dice.below(20)];
        return out;
    }
    default:
        for (std::size_t n = 1 + dice.below(3); n > 0; --n) out = withWildValue(out, dice);
        return out;
    }
}

} // namespace chiaro::test
