#include "io/replace_file.h"
#include <cerrno>
#include <charconv>
#include <csignal>
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

[[noreturn]] void refuse(const fs::path& file, int code, const char* after) {
    const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
    throw Error(full ? Exit::resources : Exit::file, fmt::format("cannot write {} ({}){}", file.string(), reason(code), after));
}

// The file that is really written: links are followed, so that the link stays one.
fs::path target(const fs::path& file) {
    std::error_code ignored;
    const fs::path end = fs::weakly_canonical(file, ignored);
    return fs::is_symlink(file, ignored) && !end.empty() ? end : file;
}

fs::path folderOf(const fs::path& place) { return place.has_parent_path() ? place.parent_path() : fs::path("."); }

// A rename is safe from a power cut when the folder is on the disk too; that some systems cannot do this is no reason to fail.
void syncFolder(const fs::path& folder) noexcept {
    const int handle = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle < 0) return;
    fsync(handle);
    close(handle);
}

// What the temporary files of this machine begin with; then comes the number of the process.
std::string temporaryStem(const fs::path& place) {
    char host[256] = {};
    gethostname(host, sizeof host - 1);
    return fmt::format(".{}.{}-", place.filename().string(), host);
}

// Of programs of this machine that were killed before they could remove or rename them.
void removeLeftovers(const fs::path& place) {
    const std::string stem = temporaryStem(place), ending = ".tmp";
    std::error_code failed;
    for (fs::directory_iterator i(folderOf(place), failed), end; !failed && i != end; i.increment(failed)) {
        const std::string name = i->path().filename().string();
        if (!name.starts_with(stem) || !name.ends_with(ending) || name.size() <= stem.size() + ending.size()) continue;
        pid_t owner = 0;
        const char *first = name.data() + stem.size(), *last = name.data() + name.size() - ending.size();
        const auto [rest, bad] = std::from_chars(first, last, owner);
        if (bad == std::errc() && rest == last && owner > 0 && kill(owner, 0) != 0 && errno == ESRCH) unlink(i->path().c_str());
    }
}

bool isDevice(const fs::path& file) {
    std::error_code ignored;
    const fs::file_status s = fs::status(file, ignored);
    return fs::is_character_file(s) || fs::is_fifo(s);
}

} // namespace

FileReplacement::FileReplacement(const fs::path& file, Trial) : file_(file), place_(target(file)) {
    name_ = folderOf(place_) / fmt::format("{}{}.tmp", temporaryStem(place_), getpid());
    handle_ = open(folderOf(place_).c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
    if (handle_ >= 0) return;
    handle_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666); // file systems without nameless files
    named_ = handle_ >= 0;
}

FileReplacement::FileReplacement(const fs::path& file) : FileReplacement(file, Trial{}) {
    if (handle_ < 0) fail(errno);
    removeLeftovers(place_);
}

FileReplacement::~FileReplacement() {
    if (handle_ >= 0) close(handle_);
    if (named_) unlink(name_.c_str());
}

void FileReplacement::fail(int code) const { refuse(file_, code, "; the file that was there is untouched"); }

void FileReplacement::write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t n = ::write(handle_, bytes.data(), bytes.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) fail(n == 0 ? ENOSPC : errno);
        bytes = bytes.subspan(std::size_t(n));
    }
}

// To the disk first: a rename that outlives its content would be a half file after a power cut.
void FileReplacement::commit() {
    if (fsync(handle_) != 0 && errno != EINVAL && errno != EROFS) fail(errno);
    struct stat old {};
    if (stat(place_.c_str(), &old) == 0 && fchmod(handle_, old.st_mode & 07777) != 0 && errno != EPERM) fail(errno);
    if (!named_) {
        unlink(name_.c_str()); // of a killed program that had this number
        const std::string nameless = fmt::format("/proc/self/fd/{}", handle_);
        if (linkat(AT_FDCWD, nameless.c_str(), AT_FDCWD, name_.c_str(), AT_SYMLINK_FOLLOW) != 0) fail(errno);
        named_ = true;
    }
    if (rename(name_.c_str(), place_.c_str()) != 0) fail(errno);
    named_ = false;
    close(std::exchange(handle_, -1));
    syncFolder(folderOf(place_));
}

void replaceFile(const fs::path& file, std::span<const std::byte> content) {
    FileReplacement replacement(file);
    replacement.write(content);
    replacement.commit();
}

void checkWritable(const fs::path& file) {
    constexpr const char* nothingLost = "; checked before rendering, nothing lost.";
    const fs::path place = target(file), folder = folderOf(place);
    std::error_code ignored;
    if (fs::is_directory(place, ignored)) refuse(file, EISDIR, nothingLost);
    if (isDevice(place)) refuse(file, EINVAL, nothingLost);
    if (!fs::exists(folder, ignored))
        throw Error(Exit::file, fmt::format("cannot write {} (no folder {}){} Make it: mkdir -p {}", file.string(), folder.string(),
                                            nothingLost, folder.string()));
    // A file that says read-only is meant, though its folder would let us replace it.
    if (fs::exists(place, ignored) && access(place.c_str(), W_OK) != 0) refuse(file, errno, nothingLost);
    const FileReplacement trial(place, FileReplacement::Trial{});
    if (trial.handle_ < 0) refuse(file, errno, nothingLost);
}

} // namespace chiaro
