#include "io/solution_file.h"
#include "io/file_bytes.h"
#include "io/replace_file.h"
#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>
#include <xxhash.h>

namespace chiaro {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view magic = "chiaro solution 1\n";
constexpr std::string_view secondsName = "seconds";
constexpr uint64_t mostHeading = 1 << 16;

[[noreturn]] void refuse(const fs::path& file, std::string_view why) {
    throw Error(Exit::file, fmt::format("{}: {}. Delete it, or give another --prepass-file", file.string(), why));
}

// Takes bytes off a file and keeps their checksum.
class Scanner {
public:
    explicit Scanner(const fs::path& file) : file_(file), state_(XXH3_createState(), XXH3_freeState) {
        std::error_code failed;
        const fs::file_status status = fs::status(file, failed);
        if (status.type() == fs::file_type::not_found)
            throw Error(Exit::file, fmt::format("{}: no such file{}", file.string(), similarNames(file)));
        if (!fs::is_regular_file(status)) refuse(file, "not a file that could be read");
        in_.open(file, std::ios::binary);
        if (!in_) refuse(file, "cannot be read");
        left_ = fs::file_size(file, failed);
        if (failed) refuse(file, "cannot be read");
    }
    void begin() { XXH3_64bits_reset(state_.get()); }
    uint64_t checksum() const { return XXH3_64bits_digest(state_.get()); }
    uint64_t left() const noexcept { return left_; }
    uint64_t at() { return uint64_t(in_.tellg()); }

    void bytes(char* to, uint64_t count, bool summed = true) {
        if (count > left_ || !in_.read(to, std::streamsize(count))) refuse(file_, "cut short or damaged");
        left_ -= count;
        if (summed) XXH3_64bits_update(state_.get(), to, count);
    }
    uint64_t number(bool summed = true) {
        uint64_t value = 0;
        bytes(reinterpret_cast<char*>(&value), sizeof value, summed);
        return value;
    }
    void pass(uint64_t count) {
        std::array<char, 1 << 16> block;
        for (uint64_t n; count > 0; count -= n) bytes(block.data(), n = std::min<uint64_t>(count, block.size()));
    }

private:
    const fs::path& file_;
    std::ifstream in_;
    std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
    uint64_t left_ = 0;
};

StoredSolution parseHeading(const fs::path& file, std::string_view heading) {
    StoredSolution s;
    while (!heading.empty()) {
        const std::size_t end = heading.find('\n'), space = heading.find(' ');
        if (end == heading.npos || space > end) refuse(file, "its heading is damaged");
        const std::string_view name = heading.substr(0, space), value = heading.substr(space + 1, end - space - 1);
        if (name == secondsName) {
            const auto [rest, failed] = std::from_chars(value.data(), value.data() + value.size(), s.seconds);
            if (failed != std::errc() || rest != value.data() + value.size()) refuse(file, "its heading is damaged");
        } else {
            s.key.emplace_back(name, printable(std::string(value)));
        }
        heading.remove_prefix(end + 1);
    }
    return s;
}

std::string headingOf(const SolutionKey& key, double seconds) {
    std::string text;
    for (const auto& [name, value] : key) {
        if (name.empty() || name == secondsName || name.find_first_of(" \n") != name.npos || value.find('\n') != value.npos)
            throw Error(Exit::internal, fmt::format("\"{}\" cannot be kept with a solution", name));
        text += fmt::format("{} {}\n", name, value);
    }
    return text + fmt::format("{} {}\n", secondsName, seconds);
}

void put(std::string& out, uint64_t value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); }

} // namespace

std::string valueOf(const SolutionKey& key, std::string_view name) {
    for (const auto& [n, value] : key)
        if (n == name) return value;
    return {};
}

std::vector<StoredSolution> readSolutions(const fs::path& file) {
    Scanner in(file);
    std::array<char, magic.size()> begin{};
    if (in.left() < magic.size()) refuse(file, "no file of solved pre-passes");
    in.bytes(begin.data(), begin.size(), false);
    if (std::string_view(begin.data(), begin.size()) != magic) refuse(file, "no file of solved pre-passes, or of another version");
    std::vector<StoredSolution> all;
    while (in.left() > 0) {
        in.begin();
        const uint64_t length = in.number();
        if (length > mostHeading) refuse(file, "its heading is damaged");
        std::string heading(length, '\0');
        in.bytes(heading.data(), length);
        const uint64_t payload = in.number();
        const uint64_t offset = in.at();
        in.pass(payload);
        const uint64_t sum = in.checksum();
        if (in.number(false) != sum) refuse(file, "damaged (its checksum is wrong)");
        all.push_back(parseHeading(file, heading)); // only what is proven is read
        all.back().offset = offset;
        all.back().bytes = payload;
    }
    if (all.empty()) refuse(file, "holds no solution");
    return all;
}

void loadSolution(const fs::path& file, const StoredSolution& s, FunctionRef<void(Reader&)> load) {
    std::ifstream in(file, std::ios::binary);
    if (!in.seekg(std::streamoff(s.offset))) refuse(file, "cannot be read");
    Reader reader(in, file.string(), s.bytes);
    load(reader);
    if (reader.left() > 0) refuse(file, "holds more than the solution that it names");
}

void addSolution(const fs::path& file, const SolutionKey& key, double seconds, FunctionRef<void(Writer&)> save) {
    std::string content(magic);
    std::error_code ignored;
    if (fs::exists(file, ignored)) {
        readSolutions(file);
        std::ifstream old(file, std::ios::binary);
        content.assign(std::istreambuf_iterator<char>(old), std::istreambuf_iterator<char>());
    }
    std::ostringstream payload;
    Writer writer(payload);
    save(writer);
    const std::size_t begin = content.size();
    const std::string heading = headingOf(key, seconds);
    put(content, heading.size());
    content += heading;
    const std::string_view numbers = payload.view();
    put(content, numbers.size());
    content += numbers;
    put(content, XXH3_64bits(content.data() + begin, content.size() - begin));
    replaceFile(file, std::as_bytes(std::span(content)));
}

} // namespace chiaro
