#include "core/render/options.h"
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace chiaro {
namespace {

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> parts;
    while (!text.empty()) {
        const std::size_t end = text.find(separator);
        parts.emplace_back(text.substr(0, end));
        text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    }
    return parts;
}

bool truth(std::string_view v) { return v == "on" || v == "true" || v == "1" || v == "yes"; }
bool falsehood(std::string_view v) { return v == "off" || v == "false" || v == "0" || v == "no"; }

[[noreturn]] void fail(std::string message) { throw Error(Exit::usage, std::move(message)); }

void checkNumber(const OptionSpec& spec, std::string_view value, std::string_view owner) {
    double v = 0;
    try {
        v = parseCount(value);
    } catch (const std::invalid_argument&) { fail(fmt::format("{}: {}={} is not a number", owner, spec.name, value)); }
    if (!(v >= spec.least && v <= spec.most))
        fail(fmt::format("{}: {}={} is out of range; give {} to {}", owner, spec.name, value, spec.least, spec.most));
    if (spec.type == OptionType::integer && v != std::floor(v))
        fail(fmt::format("{}: {}={} must be a whole number", owner, spec.name, value));
}

} // namespace

double parseCount(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string_view suffix(end, std::size_t(text.data() + text.size() - end));
    if (error != std::errc() || !std::isfinite(value)) throw std::invalid_argument("not a number");
    if (suffix.empty()) return value;
    if (suffix == "k" || suffix == "K") return value * 1e3;
    if (suffix == "M") return value * 1e6;
    if (suffix == "G") return value * 1e9;
    throw std::invalid_argument("not a number");
}

Options::Options(std::span<const OptionSpec> specs) : specs_(specs) {
    for (const OptionSpec& s : specs) values_.emplace(s.name, s.standard);
}

Options Options::parse(std::span<const OptionSpec> specs, std::string_view text, std::string_view owner) {
    Options options(specs);
    for (const std::string& piece : split(text, ',')) {
        const std::size_t equals = piece.find('=');
        if (equals == std::string::npos) fail(fmt::format("{}: \"{}\" is not key=value", owner, piece));
        options.set(std::string_view(piece).substr(0, equals), std::string_view(piece).substr(equals + 1), owner);
    }
    return options;
}

const OptionSpec& Options::spec(std::string_view key, std::string_view owner) const {
    std::vector<std::string> names;
    for (const OptionSpec& s : specs_) {
        if (s.name == key) return s;
        names.emplace_back(s.name);
    }
    const std::string near = nearest(std::string(key), names);
    fail(fmt::format("{} has no option \"{}\"; have {}{}", owner, key, names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")),
                     near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

void Options::set(std::string_view key, std::string_view value, std::string_view owner) {
    const OptionSpec& s = spec(key, owner);
    if (s.type == OptionType::boolean && !truth(value) && !falsehood(value))
        fail(fmt::format("{}: {}={} must be on or off", owner, key, value));
    if (s.type == OptionType::integer || s.type == OptionType::real) checkNumber(s, value, owner);
    if (s.type == OptionType::choice) {
        const std::vector<std::string> choices = split(s.choices, '|');
        if (std::find(choices.begin(), choices.end(), value) == choices.end())
            fail(fmt::format("{}: {}={} is none of {}", owner, key, value, fmt::join(choices, ", ")));
    }
    values_.insert_or_assign(std::string(key), std::string(value));
}

const std::string& Options::text(std::string_view key) const {
    const auto found = values_.find(key);
    if (found == values_.end()) throw Error(Exit::internal, fmt::format("option {} is read but not described", key));
    return found->second;
}
double Options::real(std::string_view key) const { return parseCount(text(key)); }
int64_t Options::integer(std::string_view key) const { return int64_t(real(key)); }
bool Options::boolean(std::string_view key) const { return truth(text(key)); }

std::string Options::recipe() const {
    std::string all;
    for (const OptionSpec& s : specs_)
        if (text(s.name) != s.standard) all += fmt::format("{}{}={}", all.empty() ? "" : ",", s.name, text(s.name));
    return all;
}

} // namespace chiaro
