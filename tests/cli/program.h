// Runs the real program ($CHIARO, set by ctest) as a user would, with both outputs and the exit code caught; and small scenes to give it.
#pragma once
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <doctest/doctest.h>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace program {

namespace fs = std::filesystem;

// A folder of its own, gone at the end.
class Folder {
public:
    Folder() {
        std::string name = (fs::temp_directory_path() / "chiaro-test-XXXXXX").string();
        path_ = mkdtemp(name.data());
    }
    ~Folder() {
        std::error_code ignored;
        fs::permissions(path_, fs::perms::owner_all, ignored);
        fs::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    fs::path operator/(const std::string& name) const { return path_ / name; }
    const fs::path& path() const { return path_; }
    void write(const std::string& name, const std::string& content) const { std::ofstream(path_ / name, std::ios::binary) << content; }

private:
    fs::path path_;
};

inline std::string readAll(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

struct Outcome {
    int code = -1; // of the exit; 1000 + the signal that ended it
    std::string out, err;
};

// A program that runs; signals can be sent to it.
class Running {
public:
    Running(const Folder& folder, const std::vector<std::string>& words) : folder_(folder) {
        const char* binary = std::getenv("CHIARO");
        std::vector<char*> arguments{const_cast<char*>(binary)};
        for (const std::string& w : words) arguments.push_back(const_cast<char*>(w.c_str()));
        arguments.push_back(nullptr);
        const std::string out = (folder / ".out").string(), err = (folder / ".err").string();
        process_ = fork();
        if (process_ != 0) return;
        const int o = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), e = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        dup2(o, STDOUT_FILENO);
        dup2(e, STDERR_FILENO);
        std::signal(SIGINT, SIG_DFL);
        unsetenv("OCIO");
        if (chdir(folder.path().c_str()) == 0) execv(binary, arguments.data());
        _exit(127);
    }
    void send(int signal) const {
        if (!ended_) kill(process_, signal);
    }
    // Until the text is on stderr; false when the program ends first.
    bool awaitStderr(const std::string& text) {
        return await([&] { return readAll(folder_ / ".err").find(text) != std::string::npos; });
    }
    bool awaitFile(const fs::path& file) {
        return await([&] { return fs::exists(file); });
    }
    Outcome wait() {
        if (!ended_) waitpid(process_, &status_, 0);
        return {WIFEXITED(status_) ? WEXITSTATUS(status_) : 1000 + WTERMSIG(status_), readAll(folder_ / ".out"), readAll(folder_ / ".err")};
    }

private:
    bool await(const std::function<bool()>& there) { // false: it ended before
        for (;;) {
            if (there()) return true;
            if (waitpid(process_, &status_, WNOHANG) == process_) {
                ended_ = true;
                return false;
            }
            usleep(5'000);
        }
    }
    const Folder& folder_;
    pid_t process_ = 0;
    int status_ = 0;
    bool ended_ = false;
};

inline Outcome run(const Folder& folder, const std::vector<std::string>& words) { return Running(folder, words).wait(); }

inline bool absent() {
    if (std::getenv("CHIARO")) return false;
    std::cout << "SKIPPED: $CHIARO does not name the program\n";
    return true;
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// One triangle as glTF, with what `more` adds to the top level and the material's content.
inline std::string triangle(const std::string& material = "{}", const std::string& more = "") {
    // positions (0,0,0) (1,0,0) (0,1,0)
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
        "materials": [)" +
           material + "]" + more + "}";
}

} // namespace program
