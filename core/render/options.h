// One description of each option feeds the parser, the help, the validation and the image's metadata.
#pragma once
#include "core/render/error.h"
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace chiaro {

enum class OptionType : uint8_t { integer, real, boolean, choice };
struct OptionSpec {
    std::string_view name; // kebab-case
    OptionType type = OptionType::real;
    std::string_view standard;  // the default, as one would type it
    double least = 0, most = 0; // inclusive range of a number
    std::string_view choices;   // "a|b|c" of a choice
    std::string_view help;
};

// Values of a table of options: all present, all valid.
class Options {
public:
    explicit Options(std::span<const OptionSpec>);
    // "key=value,key=value". Throws Error(Exit::usage) that names owner, key, the nearest key, the range.
    static Options parse(std::span<const OptionSpec>, std::string_view text, std::string_view owner);
    void set(std::string_view key, std::string_view value, std::string_view owner);
    double real(std::string_view key) const;
    int64_t integer(std::string_view key) const; // 2M, 64k are understood
    bool boolean(std::string_view key) const;    // on|off, true|false, 1|0
    const std::string& text(std::string_view key) const;
    std::string recipe() const; // key=value of all that differ from the default

private:
    const OptionSpec& spec(std::string_view key, std::string_view owner) const;
    std::span<const OptionSpec> specs_;
    std::map<std::string, std::string, std::less<>> values_;
};
// 2M, 64k, 1.5G as numbers; throws std::invalid_argument.
double parseCount(std::string_view text);

} // namespace chiaro
