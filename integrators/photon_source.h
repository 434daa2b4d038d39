// PhotonSource: what integrators and pre-passes offer that have photons, for whoever wants to see them (chiaro render --photon-map). Found
// by dynamic_cast, as PathSource is (core/render/path_log.h).
#pragma once
#include "integrators/photon_store.h"
#include <string_view>

namespace chiaro {

struct PhotonMapView {
    std::string_view name; // "global", "caustic"
    std::span<const Photon> photons;
    double paths = 1; // what their flux is to be divided by
};
class PhotonSource {
public:
    virtual ~PhotonSource() = default;
    virtual std::vector<PhotonMapView> photonMaps() const = 0; // as they are now: empty before there are any
    virtual std::size_t photonBytes() const = 0;               // of the maps and of what is kept about pixels, between passes
};

} // namespace chiaro
