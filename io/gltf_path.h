// Inside the glTF reader: the way of a node through the world while the shutter is open, and how few equal steps of core/scene/motion.h
// follow it closely.
#pragma once
#include "core/scene/desc.h"
#include <memory>

namespace chiaro::gltf {

// The node's map to the world at `samples` equal steps of the shutter, or once: it rests.
class Path {
public:
    static constexpr size_t samples = 257; // twice as fine as the finest motion

    Path() : maps_(std::make_shared<const std::vector<Affine>>(1)) {} // the world itself
    explicit Path(std::vector<Affine> maps) : maps_(std::make_shared<const std::vector<Affine>>(std::move(maps))) {}
    bool rests() const { return maps_->size() == 1; }
    const Affine& opening() const { return maps_->front(); }
    const Affine& operator[](size_t i) const { return (*maps_)[rests() ? 0 : i]; }
    const std::vector<Affine>& maps() const { return *maps_; }
    // f of every map; it rests where this does.
    template <class F> Path each(F f) const {
        std::vector<Affine> maps;
        for (const Affine& m : *maps_) maps.push_back(f(m));
        return Path(std::move(maps));
    }

private:
    std::shared_ptr<const std::vector<Affine>> maps_; // shared with the stack of the traversal
};

// How many equal segments a motion along this path needs to carry what lies within `radius` of the node's origin, 0: none, it rests.
struct Segments {
    size_t count = 0;
    double off = 0; // where 128 do not suffice: how far they may be off, as a share of the way and the size
};
Segments segmentsFor(const Path&, double radius);
// The path at the ends of so many segments; empty for 0.
MotionDesc motionAlong(const Path&, size_t segments);

} // namespace chiaro::gltf
