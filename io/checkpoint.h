// Checkpoints: a render that was interrupted, and a part of one (a range of its samples), as a file. Sums, not quotients, and what the
// integrator remembers, so that whoever goes on, and whoever merges parts, gets the bits of the render that was never cut. A checkpoint
// knows what it belongs to: a key of all that decides a bit, in words, so that two that do not fit can be told apart by name. It also
// keeps the options as they were given, so that "--resume FILE" needs no others, and what a picture needs beside its film, so that a merge
// needs no scene.
#pragma once
#include "core/render/integrator.h"
#include "io/keyed_file.h"
#include "io/picture.h"
#include <map>

namespace chiaro {

struct CheckpointHead {
    FileKey key;
    std::map<std::string, std::vector<std::string>> options; // as given
    std::string command;                                     // that began the render
    std::string again;                                       // "chiaro render SCENE ...": the command that replays one of its samples
    std::string stem;                                        // name of the scene, for {scene} in the names of files
    double seconds = 0;                                      // rendering so far, of all runs
    uint32_t begin = 0, done = 0;                            // the samples that every pixel has
    bool even = true;                                        // no pixel has more
    std::vector<std::string> warnings;                       // that came while it was rendered
    KeyedEntry entry;                                        // where it lies; set by reading
};
struct Checkpoint : CheckpointHead {
    Metadata recipe;          // of the picture as it stands
    std::vector<float> depth; // what lies under the pixel centres (core/render/depth.h)
    std::vector<uint8_t> lamp;
    std::string state; // Integrator::save
    std::unique_ptr<Film> film;
};

// The heading alone; that the file is whole is proven all the same. Throws Error(Exit::file).
CheckpointHead readCheckpointHead(const std::filesystem::path&);
// Throws Error(Exit::resources) too: the film is larger than `memory` bytes.
Checkpoint readCheckpoint(const std::filesystem::path&, std::size_t memory = ~std::size_t(0));
// What of the checkpoint the film tells, and its entry, film and state, are not looked at.
void writeCheckpoint(const std::filesystem::path&, const Checkpoint&, const Film&, const std::string& state);
std::string stateOf(const Integrator&); // Integrator::save
// What `state` holds, to an integrator that has been prepared.
void loadState(const std::filesystem::path& file, const std::string& state, const Job&, Integrator&);

} // namespace chiaro
