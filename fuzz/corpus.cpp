// Writes what fuzzing begins from: chiaro_fuzz_corpus gltf|image FOLDER.
#include "tests/mutations/seeds.h"
#include <cstdio>
#include <filesystem>
#include <fstream>

using namespace chiaro::test;

int main(int count, char** arguments) {
    const std::string kind = count > 1 ? arguments[1] : "";
    if (count != 3 || (kind != "gltf" && kind != "image")) {
        std::fprintf(stderr, "chiaro_fuzz_corpus: give gltf or image, and a folder\n");
        return 64;
    }
    const std::filesystem::path folder = arguments[2];
    std::filesystem::create_directories(folder);
    for (const Seed& s : kind == "gltf" ? gltfSeeds() : pictureSeeds()) std::ofstream(folder / s.name, std::ios::binary) << s.bytes;
    return 0;
}
