#include "io/replace_file.h"
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace chiaro {
namespace {

namespace fs = std::filesystem;

// strerror() in the lower case of a sentence's middle; names in capitals stay.
std::string reason(int code) {
    std::string text = std::strerror(code);
    if (text.size() > 1 && text[1] >= 'a') text[0] = char(std::tolower(static_cast<unsigned char>(text[0])));
    return text;
}

[[noreturn]] void fail(const fs::path& file, int code, const char* after) {
    const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
    throw Error(full ? Exit::resources : Exit::file, fmt::format("cannot write {} ({}){}", file.string(), reason(code), after));
}

// The file that is really written: links are followed, so that the link stays one.
fs::path target(const fs::path& file) {
    std::error_code ignored;
    const fs::path end = fs::weakly_canonical(file, ignored);
    return fs::is_symlink(file, ignored) && !end.empty() ? end : file;
}

// A file beside its place that vanishes unless it is renamed into it.
class Beside {
public:
    explicit Beside(const fs::path& file) : place_(target(file)) {
        name_ = place_.parent_path() / fmt::format(".{}.{}.tmp", place_.filename().string(), getpid());
        handle_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    }
    ~Beside() {
        if (handle_ < 0) return;
        close(handle_);
        unlink(name_.c_str());
    }
    Beside(const Beside&) = delete;
    Beside& operator=(const Beside&) = delete;
    bool ok() const { return handle_ >= 0; }

    bool write(std::span<const std::byte> bytes) {
        while (!bytes.empty()) {
            const ssize_t n = ::write(handle_, bytes.data(), bytes.size());
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) return false;
            bytes = bytes.subspan(std::size_t(n));
        }
        return true;
    }
    // To the disk first: a rename that outlives its content would be a half file after a power cut.
    bool commit() {
        if (fsync(handle_) != 0 && errno != EINVAL && errno != EROFS) return false;
        struct stat old {};
        if (stat(place_.c_str(), &old) == 0 && fchmod(handle_, old.st_mode & 07777) != 0 && errno != EPERM) return false;
        if (rename(name_.c_str(), place_.c_str()) != 0) return false;
        close(std::exchange(handle_, -1));
        return true;
    }

private:
    fs::path place_, name_;
    int handle_ = -1;
};

bool isDevice(const fs::path& file) {
    std::error_code ignored;
    const fs::file_status s = fs::status(file, ignored);
    return fs::is_character_file(s) || fs::is_fifo(s);
}

} // namespace

void replaceFile(const fs::path& file, std::span<const std::byte> content) {
    Beside beside(file);
    if (!beside.ok() || !beside.write(content) || !beside.commit()) fail(file, errno, "; the file that was there is untouched");
}

void checkWritable(const fs::path& file) {
    constexpr const char* nothingLost = "; checked before rendering, nothing lost.";
    const fs::path place = target(file), folder = place.has_parent_path() ? place.parent_path() : fs::path(".");
    std::error_code ignored;
    if (fs::is_directory(place, ignored)) fail(file, EISDIR, nothingLost);
    if (isDevice(place)) fail(file, EINVAL, nothingLost);
    if (!fs::exists(folder, ignored))
        throw Error(Exit::file, fmt::format("cannot write {} (no folder {}){} Make it: mkdir -p {}", file.string(), folder.string(),
                                            nothingLost, folder.string()));
    // A file that says read-only is meant, though its folder would let us replace it.
    if (fs::exists(place, ignored) && access(place.c_str(), W_OK) != 0) fail(file, errno, nothingLost);
    const Beside trial(place);
    if (!trial.ok()) fail(file, errno, nothingLost);
}

} // namespace chiaro
