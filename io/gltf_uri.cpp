#include "io/gltf_file.h"
#include <array>
#include <fmt/format.h>

namespace chiaro::gltf {

namespace fs = std::filesystem;

namespace {

int hexDigit(char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

// RFC 3986, 2.1; a % that begins no escape stays as it is.
std::string percentDecode(std::string_view uri) {
    std::string out;
    for (size_t i = 0; i < uri.size(); ++i) {
        const bool escape = uri[i] == '%' && i + 2 < uri.size() && hexDigit(uri[i + 1]) >= 0 && hexDigit(uri[i + 2]) >= 0;
        out += escape ? char(hexDigit(uri[i + 1]) * 16 + hexDigit(uri[i + 2])) : uri[i];
        if (escape) i += 2;
    }
    return out;
}

// RFC 4648, both alphabets; white space and missing padding are tolerated.
std::optional<std::vector<std::byte>> decodeBase64(std::string_view text) {
    static const std::array<int8_t, 256> values = [] {
        std::array<int8_t, 256> v;
        v.fill(-1);
        const std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (size_t i = 0; i < letters.size(); ++i) v[static_cast<unsigned char>(letters[i])] = int8_t(i);
        v['-'] = 62;
        v['_'] = 63;
        return v;
    }();
    std::vector<std::byte> out;
    out.reserve(text.size() / 4 * 3 + 3);
    uint32_t bits = 0;
    int held = 0, letters = 0;
    bool padding = false;
    for (const char c : text) {
        if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
        padding |= c == '=';
        if (c == '=') continue;
        const int value = values[static_cast<unsigned char>(c)];
        if (value < 0 || padding) return {};
        bits = bits << 6 | uint32_t(value);
        held += 6;
        ++letters;
        if (held >= 8) out.push_back(std::byte(bits >> (held -= 8) & 0xff));
    }
    if (letters % 4 == 1) return {};
    return out;
}

bool leavesFolder(const fs::path& relative) {
    const fs::path normal = relative.lexically_normal();
    return relative.is_absolute() || normal.empty() || *normal.begin() == "..";
}

} // namespace

bool isDataUri(std::string_view uri) { return uri.starts_with("data:"); }

std::optional<std::vector<std::byte>> decodeDataUri(std::string_view uri) {
    const size_t comma = uri.find(',');
    if (!isDataUri(uri) || comma == uri.npos) return {};
    const std::string_view header = uri.substr(0, comma), body = uri.substr(comma + 1);
    if (header.ends_with(";base64")) return decodeBase64(body.find('%') == body.npos ? body : std::string_view(percentDecode(body)));
    const std::string plain = percentDecode(body);
    const auto* begin = reinterpret_cast<const std::byte*>(plain.data());
    return std::vector<std::byte>(begin, begin + plain.size());
}

fs::path resolveUri(const GltfFile& file, const std::string& place, const std::string& uri) {
    const size_t colon = uri.find(':');
    if (colon != uri.npos && colon < uri.find('/'))
        file.fail(place, fmt::format("{} is no relative path. Put the file beside the scene and name it without a scheme.", shown(uri)));
    std::string slashes = percentDecode(uri);
    for (char& c : slashes)
        if (c == '\\') c = '/';
    // As glTF means it; as a file name that holds a literal %; as Windows programs write it.
    for (const std::string& candidate : {percentDecode(uri), uri, slashes}) {
        if (candidate.empty() || candidate.find('\0') != candidate.npos) continue;
        if (leavesFolder(candidate))
            file.fail(place, fmt::format("{} leaves the scene's folder. Copy the file beside the scene and name it there.", shown(uri)));
        std::error_code ignored;
        const fs::path path = file.path.parent_path() / candidate;
        if (fs::is_regular_file(path, ignored)) return path;
    }
    return {};
}

} // namespace chiaro::gltf
