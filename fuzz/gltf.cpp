// Whatever the bytes are: reading them as a scene gives a description, or an Error.
#include "io/gltf.h"
#include "tests/mutations/mutate.h"
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most); // of libFuzzer

using namespace chiaro;

namespace {

// In memory, in a folder of its own: the reader opens files, and those beside it.
const std::filesystem::path& place() {
    static const std::filesystem::path file = [] {
        const auto folder = std::filesystem::path("/dev/shm") / ("chiaro-fuzz-" + std::to_string(getpid()));
        std::filesystem::create_directories(folder);
        static const struct Cleaner {
            std::filesystem::path folder;
            ~Cleaner() {
                std::error_code ignored;
                std::filesystem::remove_all(folder, ignored);
            }
        } cleaner{folder};
        return folder / "scene.glb";
    }();
    return file;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    std::ofstream(place(), std::ios::binary).write(reinterpret_cast<const char*>(data), std::streamsize(size));
    Diagnostics notes;
    GltfOptions options;
    options.missingTexture = MissingTexture::grey; // a picture that is none does not end the reading
    options.shutter = {0, 0.5f};
    try {
        readGltf(place(), options, notes);
    } catch (const Error&) {}
    return 0;
}

// Half of the time a value of the JSON is replaced: random bytes alone seldom get past the parser.
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
    if (seed % 2 == 0) return LLVMFuzzerMutate(data, size, most);
    test::Dice dice(seed);
    const std::string out = test::withWildValue({reinterpret_cast<const char*>(data), size}, dice);
    if (out.size() > most) return LLVMFuzzerMutate(data, size, most);
    std::memcpy(data, out.data(), out.size());
    return out.size();
}
