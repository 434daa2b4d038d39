// ClosureTable: of every material of a scene that looks the same at all its points, what its closures share: parameters, and the mixture of
// lobes with its albedo slices, which would else be made at every hit. Made when the scene is compiled (Scene::compile), read by all
// threads. The closures are the same to the last bit; of a scene without a table every hit makes its own.
#pragma once
#include "core/scene/scene.h"
#include "materials/layers.h"

namespace chiaro {

struct ClosureRecord {
    BsdfParameters parameters; // at a white vertex
    LobeMixture mixture;
    Spectrum diffuseScale{1}; // of the layers

    explicit ClosureRecord(const BsdfParameters&) noexcept;
    SharedClosure shared() const noexcept { return {&mixture, &diffuseScale}; }
};

class ClosureTable final : public SceneTable {
public:
    explicit ClosureTable(const Scene&);
    static std::unique_ptr<const SceneTable> make(const Scene&); // for Scene::compile
    static const ClosureTable* of(const Scene& scene) noexcept { return static_cast<const ClosureTable*>(scene.table()); }
    std::size_t bytes() const noexcept override { return entries_.capacity() * sizeof(Entry); }

    // What the closure at a point is made from; null: its parameters are its own.
    const ClosureRecord* find(const SurfacePoint& s, const Wavelengths& lambda) const noexcept {
        const Entry& e = entries_[s.material];
        if (!e.shared || (e.disperses && lambda.hero > 0)) return nullptr;
        return (s.color.x == 1) & (s.color.y == 1) & (s.color.z == 1) ? &e.record : nullptr;
    }
    bool absorbs() const noexcept { return absorbs_; } // is there an inside that dims what crosses it?

private:
    struct Entry {
        ClosureRecord record;
        bool shared = false;    // it does not vary with textures, or the way that a brush runs: else the record says nothing
        bool disperses = false; // of one wavelength it is another closure
    };
    std::vector<Entry> entries_;
    bool absorbs_ = false;
};

} // namespace chiaro
