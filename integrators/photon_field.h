// The photon maps that make an indirect light field (Jensen 1996): a global one, and where specular surfaces cast caustics one of photons
// L S+ alone, shot at those surfaces in greater number, since caustics are looked at without another scattering between. Shared by the
// integrators photon and sppm and by the pre-pass; nothing in it knows of a view, except how fine a pixel is.
#pragma once
#include "core/render/options.h"
#include "integrators/photon_map.h"
#include "integrators/photon_source.h"
#include "integrators/photon_trace.h"

namespace chiaro {

struct PhotonFieldPlan {
    uint64_t paths = 0, causticPaths = 0; // light paths a map; 0: chosen by the size of the picture
    float radius = 0, causticRadius = 0;  // metres; 0: chosen by the photons and the size of a pixel
    DensityPlan density;
    float shrink = 1; // of both radii
    double more = 1;  // times as many paths
    uint32_t rouletteDepth = 5;
    bool direct = false; // are photons of light that was not yet scattered in the global map?
    bool all = false;    // caustic photons in the global map though they have their own
};
// What a field is to be seen by.
struct PhotonScale {
    double pixels = 0; // of the picture; 0: no picture
    float pixel = 0;   // metres, the width of one on what is typically seen; 0: unknown
};
PhotonScale photonScale(const Job&);

class PhotonField {
public:
    PhotonField() = default;
    explicit PhotonField(const PhotonFieldPlan& plan) : plan_(plan) {}
    // Chooses what is to be chosen. Before anything else.
    void prepare(const Work&, const PhotonScale&);
    // The photons of one iteration; of a field made once, iteration 0. Radii that are to be chosen by the photons are chosen the first
    // time. False: stopped.
    bool trace(const Work&, uint64_t iteration, std::optional<float> time);
    // Before the next trace: the radius of the lookups to come, which the cells are made for.
    void setRadius(float radius) noexcept { radius_ = causticRadius_ = radius; }

    const PhotonMap& global() const noexcept { return global_; }
    const PhotonMap* caustic() const noexcept { return twoMaps_ ? &caustic_ : nullptr; }
    uint64_t paths() const noexcept { return paths_; }
    std::size_t bytes() const noexcept { return global_.store().bytes() + caustic_.store().bytes(); }
    // "1.2 M photons of 262144 paths, radius 0.021 m; ...", and the options that keep it so; where the light of the global map's paths
    // went, "emitted 67.1 lm: 69.7 % absorbed, ...".
    std::string summary() const;
    std::string balance() const;
    std::string recipe() const;
    std::vector<PhotonMapView> views() const; // of the photons as they stand

    void save(Writer&) const;
    void load(const Work&, Reader&);

private:
    struct RadiusChoice {          // where none is given
        double photons = 0;        // in a typical disc
        float least = 0, most = 0; // metres
    };
    bool traceOne(const Work&, const PhotonRequest&, float& radius, const RadiusChoice&, PhotonMap&, PhotonStatistics&);
    PhotonFieldPlan plan_;
    PhotonScale scale_;
    uint64_t paths_ = 0, causticPaths_ = 0;
    float radius_ = 0, causticRadius_ = 0; // 0: not chosen yet
    float sceneRadius_ = 1;
    bool twoMaps_ = false;
    std::shared_ptr<const EmissionGuide> guide_;
    PhotonMap global_, caustic_;
    PhotonStatistics statistics_, causticStatistics_;
    double seconds_ = 0;
};

// The options that describe a field, for the integrators and the pre-pass that have one.
struct PhotonFieldOptions {
    static constexpr OptionSpec count = {
        "count", OptionType::integer, "0", 0, 1e10, "", "light paths of the global map; 0: as many as the picture has pixels, 32k to 1M"};
    static constexpr OptionSpec causticCount = {"caustic-count",
                                                OptionType::integer,
                                                "0",
                                                0,
                                                1e10,
                                                "",
                                                "light paths of the caustic map, aimed at mirrors and glass; 0: twice count"};
    static constexpr OptionSpec radius = {
        "radius",
        OptionType::real,
        "0",
        0,
        1e9,
        "",
        "metres, of the discs in which photons are counted; the greatest one where estimate=knn; 0: by the photons"};
    static constexpr OptionSpec causticRadius = {
        "caustic-radius", OptionType::real, "0", 0, 1e9, "", "the same in the caustic map; 0: by its photons, no smaller than a pixel"};
    static constexpr OptionSpec estimate = {
        "estimate", OptionType::choice, "radius", 0, 0, "radius|knn", "photons within the radius, or the k nearest"};
    static constexpr OptionSpec k = {"k", OptionType::integer, "50", 3, 1024, "", "photons of estimate=knn"};
    static constexpr OptionSpec kernel = {"kernel",
                                          OptionType::choice,
                                          "epanechnikov",
                                          0,
                                          0,
                                          "constant|cone|epanechnikov",
                                          "weight of a photon by its distance: 1, 1 - d/r, 1 - (d/r)^2"};
    static constexpr OptionSpec shrink = {"shrink",
                                          OptionType::real,
                                          "1",
                                          1e-3,
                                          1e3,
                                          "",
                                          "multiplies both radii (knn: and divides the counts by its square): the bias vanishes with it"};
    static constexpr OptionSpec rouletteDepth = {"rr-depth",
                                                 OptionType::integer,
                                                 "5",
                                                 0,
                                                 65535,
                                                 "",
                                                 "scatterings before Russian roulette may end a path, from the light or from the eye"};
    static PhotonFieldPlan plan(const Options&); // of all but rr-depth's use along eye paths
};
PhotonKernel photonKernel(const Options&);

} // namespace chiaro
