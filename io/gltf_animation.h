// Inside the glTF reader: the animations of a file (glTF 2.0.1, 3.11 and appendix C). Which one plays, where its channels put the nodes at
// a time, and what people are told about all of them. Times are seconds of the animation; before its first key and after its last one it
// holds still.
#pragma once
#include "io/gltf_file.h"
#include <array>
#include <map>
#include <tuple>

namespace chiaro::gltf {

// A node's placement under its parent, as glTF writes it: quaternion x, y, z, w.
struct Trs {
    std::array<double, 3> translation{0, 0, 0};
    std::array<double, 4> rotation{0, 0, 0, 1};
    std::array<double, 3> scale{1, 1, 1};
};

// How many morph targets a mesh has: those of its primitive with the most. mesh -1: none.
size_t targetsOf(const GltfFile&, int mesh);

class Animations {
public:
    // wanted: as GltfOptions::animation. Throws Error: Exit::file for keys that cannot be used, Exit::usage where no animation is meant.
    Animations(const GltfFile&, const std::string& wanted);
    bool moves(size_t node) const { // in space
        return !channels_.empty() && (channels_[node][translation] >= 0 || channels_[node][rotation] >= 0 || channels_[node][scale] >= 0);
    }
    // Overwrites what the animation says of the node.
    void apply(size_t node, double seconds, Trs&) const;
    bool morphs(size_t node) const { return !channels_.empty() && channels_[node][weights] >= 0; }
    // The weights of the morph targets of its mesh, as many as that has.
    void apply(size_t node, double seconds, std::vector<double>& all) const;
    const std::vector<AnimationInfo>& info() const { return info_; }

private:
    enum class Way { step, linear, cubic };
    struct Sampler {
        std::vector<float> times, values; // a cubic one: in-tangent, value, out-tangent
        Way way = Way::linear;
        size_t width = 3; // numbers a key
        // Between which key and the next a time lies; 0 or 1 of the way: there it holds.
        struct Place {
            size_t key = 0;
            double share = 0;
        };
        Place place(double seconds) const;
        double length(size_t key) const { return double(times[key + 1]) - double(times[key]); }
        std::array<double, 4> at(double seconds) const; // of four numbers at most
        std::array<double, 4> value(size_t key, size_t part = 1) const;
        double number(size_t key, size_t component, size_t part = 1) const;
        double number(const Place&, size_t component) const; // each by itself
    };
    enum Property : size_t { translation, rotation, scale, weights };
    static constexpr std::array<int, 4> still{-1, -1, -1, -1};

    // Samplers that are there already: by number, whether of weights, and width.
    using ReadSamplers = std::map<std::tuple<size_t, bool, size_t>, int>;
    void describe(const GltfFile&, const std::string& wanted);
    void play(const GltfFile&, size_t animation);
    void connect(const GltfFile&, const std::string& place, const nlohmann::json& channel, ReadSamplers& read, size_t animation);
    Sampler readSampler(const GltfFile&, const std::string& place, const nlohmann::json&, Property, size_t width);

    std::vector<Sampler> samplers_;
    std::vector<std::array<int, 4>> channels_; // by node: its samplers of each property, -1: none
    std::vector<AnimationInfo> info_;
    uint64_t numbers_ = 0; // read so far
    bool twice_ = false;   // one target, two channels
};

} // namespace chiaro::gltf
