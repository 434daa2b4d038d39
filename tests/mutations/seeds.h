// Small whole scenes that between them use all that the glTF reader knows, made here: what mutations and fuzzing begin from.
#pragma once
#include <string>
#include <vector>

namespace chiaro::test {

struct Seed {
    std::string name; // with its extension
    std::string bytes;
};
std::vector<Seed> gltfSeeds();
std::vector<Seed> pictureSeeds(); // one of each kind and depth

} // namespace chiaro::test
