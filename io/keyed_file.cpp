#include "io/keyed_file.h"
#include "io/file_bytes.h"
#include "io/replace_file.h"
#include <algorithm>
#include <array>
#include <exception>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <xxhash.h>

namespace chiaro {
namespace {

namespace fs = std::filesystem;
constexpr uint64_t mostHeading = 1 << 20;

class Checksum {
public:
    Checksum() : state_(XXH3_createState(), XXH3_freeState) { begin(); }
    void begin() { XXH3_64bits_reset(state_.get()); }
    void add(const char* data, std::size_t count) { XXH3_64bits_update(state_.get(), data, count); }
    uint64_t value() const { return XXH3_64bits_digest(state_.get()); }

private:
    std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

// Takes bytes off a file and keeps their checksum.
class Scanner {
public:
    Scanner(const fs::path& file, const FileKind& kind) : file_(file), kind_(kind) {
        std::error_code failed;
        const fs::file_status status = fs::status(file, failed);
        if (status.type() == fs::file_type::not_found)
            throw Error(Exit::file, fmt::format("{}: no such file{}", file.string(), similarNames(file)));
        if (!fs::is_regular_file(status)) refuseFile(file, kind, "not a file that could be read");
        in_.open(file, std::ios::binary);
        if (!in_) refuseFile(file, kind, "cannot be read");
        left_ = fs::file_size(file, failed);
        if (failed) refuseFile(file, kind, "cannot be read");
    }
    void begin() { sum_.begin(); }
    uint64_t checksum() const { return sum_.value(); }
    uint64_t left() const noexcept { return left_; }
    uint64_t at() { return uint64_t(in_.tellg()); }

    void bytes(char* to, uint64_t count, bool summed = true) {
        if (count > left_ || !in_.read(to, std::streamsize(count))) refuseFile(file_, kind_, "cut short or damaged");
        left_ -= count;
        if (summed) sum_.add(to, count);
    }
    uint64_t number(bool summed = true) {
        uint64_t value = 0;
        bytes(reinterpret_cast<char*>(&value), sizeof value, summed);
        return value;
    }
    void pass(uint64_t count) {
        if (count > left_) refuseFile(file_, kind_, "cut short or damaged");
        std::vector<char> block(std::min<uint64_t>(count, 1 << 20));
        for (uint64_t n; count > 0; count -= n) bytes(block.data(), n = std::min<uint64_t>(count, block.size()));
    }

private:
    const fs::path& file_;
    const FileKind& kind_;
    std::ifstream in_;
    Checksum sum_;
    uint64_t left_ = 0;
};

FileKey parseHeading(const fs::path& file, const FileKind& kind, std::string_view heading) {
    FileKey key;
    while (!heading.empty()) {
        const std::size_t end = heading.find('\n'), space = heading.find(' ');
        if (end == heading.npos || space > end) refuseFile(file, kind, "its heading is damaged");
        key.emplace_back(heading.substr(0, space), printable(std::string(heading.substr(space + 1, end - space - 1))));
        heading.remove_prefix(end + 1);
    }
    return key;
}

std::string headingOf(const FileKey& key) {
    std::string text;
    for (const auto& [name, value] : key) {
        if (name.empty() || name.find_first_of(" \n") != name.npos || value.find('\n') != value.npos)
            throw Error(Exit::internal, fmt::format("\"{}\" cannot be kept in the heading of a file", name));
        text += fmt::format("{} {}\n", name, value);
    }
    if (text.size() > mostHeading) throw Error(Exit::internal, "the heading of a file is too long");
    return text;
}

// An ostream's other end: counts, or writes and sums up. What goes wrong is kept, since streams swallow exceptions.
class Sink final : public std::streambuf {
public:
    explicit Sink(FileReplacement* to) : to_(to) {}
    void put(const char* data, std::size_t count) {
        bytes_ += count;
        if (!to_) return;
        sum_.add(data, count);
        if (used_ + count > buffer_.size()) flush();
        if (count > buffer_.size()) return to_->write(std::as_bytes(std::span(data, count)));
        std::copy_n(data, count, buffer_.data() + used_);
        used_ += count;
    }
    void number(uint64_t v) { put(reinterpret_cast<const char*>(&v), sizeof v); }
    void flush() {
        to_->write(std::as_bytes(std::span(buffer_).first(used_)));
        used_ = 0;
    }
    uint64_t bytes() const noexcept { return bytes_; }
    uint64_t checksum() const { return sum_.value(); }
    void rethrow() const {
        if (failed_) std::rethrow_exception(failed_);
    }

private:
    std::streamsize xsputn(const char* data, std::streamsize count) override {
        try {
            put(data, std::size_t(count));
            return count;
        } catch (...) {
            failed_ = std::current_exception();
            return 0;
        }
    }
    int_type overflow(int_type c) override {
        const char one = traits_type::to_char_type(c);
        return xsputn(&one, 1) == 1 ? c : traits_type::eof();
    }
    FileReplacement* to_;
    Checksum sum_;
    std::vector<char> buffer_ = std::vector<char>(1 << 16);
    std::size_t used_ = 0;
    uint64_t bytes_ = 0;
    std::exception_ptr failed_;
};

void pour(Sink& sink, FunctionRef<void(Writer&)> save) {
    std::ostream out(&sink);
    Writer writer(out);
    save(writer);
    sink.rethrow();
}

void copyAll(const fs::path& file, FileReplacement& to) {
    std::ifstream in(file, std::ios::binary);
    std::vector<char> block(1 << 20);
    while (in.read(block.data(), std::streamsize(block.size())), in.gcount() > 0)
        to.write(std::as_bytes(std::span(block).first(std::size_t(in.gcount()))));
}

} // namespace

std::string valueOf(const FileKey& key, std::string_view name) {
    for (const auto& [n, value] : key)
        if (n == name) return value;
    return {};
}

void refuseFile(const fs::path& file, const FileKind& kind, std::string_view why) {
    throw Error(Exit::file, fmt::format("{}: {}. {}", file.string(), why, kind.advice));
}

std::vector<KeyedEntry> readKeyed(const fs::path& file, const FileKind& kind) {
    Scanner in(file, kind);
    const std::string magic = fmt::format("{}\n", kind.magic);
    std::string begin(magic.size(), '\0');
    if (in.left() < magic.size()) refuseFile(file, kind, fmt::format("no {}", kind.noun));
    in.bytes(begin.data(), begin.size(), false);
    if (begin != magic) refuseFile(file, kind, fmt::format("no {}, or of another version", kind.noun));
    std::vector<KeyedEntry> all;
    while (in.left() > 0) {
        in.begin();
        const uint64_t length = in.number();
        if (length > mostHeading) refuseFile(file, kind, "its heading is damaged");
        std::string heading(length, '\0');
        in.bytes(heading.data(), length);
        const uint64_t payload = in.number();
        const uint64_t offset = in.at();
        in.pass(payload);
        const uint64_t sum = in.checksum();
        if (in.number(false) != sum) refuseFile(file, kind, "damaged (its checksum is wrong)");
        all.push_back({parseHeading(file, kind, heading), offset, payload}); // only what is proven is read
    }
    if (all.empty()) refuseFile(file, kind, "holds nothing");
    return all;
}

void loadKeyed(const fs::path& file, const FileKind& kind, const KeyedEntry& entry, FunctionRef<void(Reader&)> load) {
    std::ifstream in(file, std::ios::binary);
    if (!in.seekg(std::streamoff(entry.offset))) refuseFile(file, kind, "cannot be read");
    Reader reader(in, file.string(), entry.bytes);
    load(reader);
    if (reader.left() > 0) refuseFile(file, kind, "holds more than what it names");
}

void writeKeyed(const fs::path& file, const FileKind& kind, const FileKey& key, FunctionRef<void(Writer&)> save, bool add) {
    const std::string heading = headingOf(key), magic = fmt::format("{}\n", kind.magic);
    Sink counted(nullptr);
    pour(counted, save);
    std::error_code ignored;
    const bool behind = add && fs::exists(file, ignored);
    if (behind) readKeyed(file, kind);
    FileReplacement to(file);
    if (behind)
        copyAll(file, to);
    else
        to.write(std::as_bytes(std::span(magic)));
    Sink sink(&to);
    sink.number(heading.size());
    sink.put(heading.data(), heading.size());
    sink.number(counted.bytes());
    const uint64_t before = sink.bytes();
    pour(sink, save);
    if (sink.bytes() - before != counted.bytes())
        throw Error(Exit::internal, fmt::format("{} changed while it was written", file.string()));
    sink.number(sink.checksum());
    sink.flush();
    to.commit();
}

} // namespace chiaro
