// References on disk.
#include "core/render/error.h"
#include "io/replace_file.h"
#include "tools/cli/compare_reference.h"
#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <xxhash.h>

namespace chiaro::cli {
namespace {

constexpr std::string_view magic = "chiaro reference 2\n";

template <class T> void put(std::string& out, std::span<const T> values) {
    out.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}
void putFloats(std::string& out, const std::vector<double>& values) {
    for (const double v : values) {
        const float f = float(v);
        put<float>(out, {&f, 1});
    }
}

// Takes values off the front.
class Reader {
public:
    explicit Reader(std::string_view rest) : rest_(rest) {}
    template <class T> std::vector<T> values(std::size_t count) {
        const std::size_t bytes = count * sizeof(T);
        if (rest_.size() / sizeof(T) < count) throw Error(Exit::file, "it ends too early");
        std::vector<T> all(count);
        std::memcpy(all.data(), rest_.data(), bytes);
        rest_.remove_prefix(bytes);
        return all;
    }
    std::string_view line() {
        const std::size_t end = rest_.find('\n');
        if (end == std::string_view::npos) throw Error(Exit::file, "it ends too early");
        const std::string_view text = rest_.substr(0, end);
        rest_.remove_prefix(end + 1);
        return text;
    }
    bool empty() const { return rest_.empty(); }

private:
    std::string_view rest_;
};

std::string readAll(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

uint64_t checksum(std::string_view bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

std::vector<double> doubles(const std::vector<float>& values) { return {values.begin(), values.end()}; }

} // namespace

void ReferenceSums::write(const std::filesystem::path& file, const std::string& key) const {
    const judge::Replicates::State state = luminance_.state();
    std::string out(magic);
    out += nlohmann::ordered_json{{"key", key},          {"width", width()},
                                  {"height", height()},  {"replicas", replicas()},
                                  {"spp", spp_},         {"seconds", seconds_},
                                  {"dropped", dropped_}, {"tiles", state.sums.empty() ? 0 : state.sums[0].size()}}
               .dump() +
           "\n";
    put<float>(out, mean_);
    put<float>(out, m2_);
    put<uint8_t>(out, state.bad);
    putFloats(out, state.mean);
    putFloats(out, state.m2);
    putFloats(out, state.m3);
    for (const auto& replicate : state.sums) put<std::array<double, judge::meanCount>>(out, replicate);
    const uint64_t sum = checksum(out);
    put<uint64_t>(out, {&sum, 1});
    replaceFile(file, std::as_bytes(std::span(out)));
}

ReferenceSums ReferenceSums::read(const std::filesystem::path& file, const std::string& key, uint32_t width, uint32_t height) {
    const std::string content = readAll(file);
    std::string_view bytes = content;
    uint64_t sum = 0;
    if (bytes.size() < magic.size() + sizeof sum || !bytes.starts_with(magic))
        throw Error(Exit::file, "it is no reference of this version");
    std::memcpy(&sum, bytes.data() + bytes.size() - sizeof sum, sizeof sum);
    bytes.remove_suffix(sizeof sum);
    if (checksum(bytes) != sum) throw Error(Exit::file, "its checksum is wrong");
    Reader in(bytes.substr(magic.size()));
    const auto head = nlohmann::json::parse(in.line(), nullptr, false);
    if (!head.is_object() || head.value("key", "") != key || head.value("width", 0u) != width || head.value("height", 0u) != height)
        throw Error(Exit::file, "it belongs to another picture");
    const std::size_t pixels = std::size_t(width) * height, tiles = head.value("tiles", std::size_t(0));
    ReferenceSums sums(width, height, head.value("spp", 1u));
    sums.seconds_ = head.value("seconds", 0.0);
    sums.dropped_ = head.value("dropped", uint64_t(0));
    sums.mean_ = in.values<float>(3 * pixels);
    sums.m2_ = in.values<float>(3 * pixels);
    judge::Replicates::State state;
    state.bad = in.values<uint8_t>(pixels);
    state.mean = doubles(in.values<float>(pixels));
    state.m2 = doubles(in.values<float>(pixels));
    state.m3 = doubles(in.values<float>(pixels));
    for (uint32_t r = 0; r < head.value("replicas", 0u); ++r) state.sums.push_back(in.values<std::array<double, judge::meanCount>>(tiles));
    if (!in.empty()) throw Error(Exit::file, "it is longer than it should be");
    sums.luminance_.restore(std::move(state));
    return sums;
}

void markUsed(const std::filesystem::path& file) noexcept {
    std::error_code ignored; // a folder that cannot be written to: its files stay as old as they are
    std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now(), ignored);
}

void boundCache(const std::filesystem::path& folder, uint64_t bytes, const std::filesystem::path& kept) {
    namespace fs = std::filesystem;
    struct Kept {
        fs::file_time_type used;
        uint64_t bytes = 0;
        fs::path file;
    };
    std::vector<Kept> all;
    uint64_t sum = 0;
    std::error_code gone;
    for (fs::directory_iterator at(folder, gone), end; !gone && at != end; at.increment(gone)) {
        if (at->path().extension() != referenceEnding) continue;
        std::error_code vanished;
        Kept one{fs::last_write_time(at->path(), vanished), 0, at->path()};
        if (!vanished) one.bytes = fs::file_size(at->path(), vanished);
        if (vanished) continue;
        sum += one.bytes;
        if (one.file.filename() != kept.filename()) all.push_back(std::move(one));
    }
    std::sort(all.begin(), all.end(), [](const Kept& a, const Kept& b) { return a.used < b.used; });
    for (const Kept& one : all) {
        if (sum <= bytes) return;
        std::error_code failed;
        fs::remove(one.file, failed);
        if (failed)
            throw Error(Exit::file, fmt::format("{}: cannot be deleted ({}), though the folder of references is full", one.file.string(),
                                                failed.message()));
        sum -= one.bytes;
    }
}

} // namespace chiaro::cli
