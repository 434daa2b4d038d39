// Inside the glTF reader: the animations of a file (glTF 2.0.1, 3.11 and appendix C). Which one plays, where its channels put the nodes at
// a time, and what people are told about all of them. Times are seconds of the animation; before its first key and after its last one it
// holds still.
#pragma once
#include "io/gltf_file.h"
#include <array>

namespace chiaro::gltf {

// A node's placement under its parent, as glTF writes it: quaternion x, y, z, w.
struct Trs {
    std::array<double, 3> translation{0, 0, 0};
    std::array<double, 4> rotation{0, 0, 0, 1};
    std::array<double, 3> scale{1, 1, 1};
};

class Animations {
public:
    // wanted: as GltfOptions::animation. Throws Error: Exit::file for keys that cannot be used, Exit::usage where no animation is meant.
    Animations(const GltfFile&, const std::string& wanted);
    bool moves(size_t node) const { return !channels_.empty() && channels_[node] != still; }
    // Overwrites what the animation says of the node.
    void apply(size_t node, double seconds, Trs&) const;
    const std::vector<AnimationInfo>& info() const { return info_; }

private:
    enum class Way { step, linear, cubic };
    struct Sampler {
        std::vector<float> times, values; // a cubic one: in-tangent, value, out-tangent
        Way way = Way::linear;
        size_t width = 3; // 4: a quaternion
        std::array<double, 4> at(double seconds) const;
        std::array<double, 4> value(size_t key, size_t part = 1) const;
        std::array<double, 4> spline(size_t key, double seconds) const;
    };
    static constexpr std::array<int, 3> still{-1, -1, -1};

    void describe(const GltfFile&, const std::string& wanted);
    void play(const GltfFile&, size_t animation);
    void connect(const GltfFile&, const std::string& place, const nlohmann::json& channel, std::vector<int>& read, size_t animation);
    Sampler readSampler(const GltfFile&, const std::string& place, const nlohmann::json&, bool rotation);

    std::vector<Sampler> samplers_;
    std::vector<std::array<int, 3>> channels_; // by node: its samplers of translation, rotation and scale, -1: none
    std::vector<AnimationInfo> info_;
    uint64_t numbers_ = 0; // read so far
    bool twice_ = false;   // one target, two channels
};

} // namespace chiaro::gltf
