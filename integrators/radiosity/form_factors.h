// Form factors: F_ij is the share of the flux that leaves patch i diffusely and reaches patch j directly; A_i F_ij = A_j F_ji.
// Three ways to find a row, all with occlusion by everything in the scene:
//   analytic    the double contour integral of two polygons, each clipped at the horizon of the other (form_factors_polygon.h), times the
//               share of rays between them that arrive, weighted by the kernel
//   hemisphere  rays distributed by the cosine over points of i, 16 wide, counted where they arrive: a whole row at a time (Malley 1988)
//   hemicube    the scene projected on five faces of a half cube at points of i, with the form factor of each of its pixels known
//               beforehand (Cohen and Greenberg 1985; hemicube.h)
// The matrix of all rows is reciprocal to the last bit: it holds the exchange areas A_i F_ij = A_j F_ji, each the mean of both estimates of
// it, weighted by their trust (a row of rays knows A_i F_ij with a variance in proportion to A_i: the smaller patch is believed more). That
// alone would break the sums of the rows, and with them the balance of energy; so exchanges are then scaled by d_i d_j, which keeps them
// symmetric, until each row sums to what its own rays found (Sinkhorn and Knopp 1967, in the symmetric form): in a closed room exactly 1.
// Analytic exchanges are symmetric from the start and are scaled only where their hidden shares were found by rays, to the share of other
// rays that meets a patch.
#pragma once
#include "integrators/radiosity/patches.h"

namespace chiaro::radiosity {

class Hemicube;

enum class FormFactorMethod : uint8_t { analytic, hemisphere, hemicube };
struct FormFactorSettings {
    FormFactorMethod method = FormFactorMethod::hemisphere;
    uint32_t rays = 1024;      // of a row, hemisphere
    uint32_t resolution = 128; // pixels along the edge of the top face of a hemicube
    uint32_t points = 4;       // of a patch, at which hemicubes stand
    uint32_t shadowRays = 4;   // between a pair, analytic; 0: no occlusion
};

// One entry of a sparse row.
struct Factor {
    uint32_t patch = 0;
    float factor = 0;
};

// A row at a time; what is not in it reached no patch. A pure function of the work's seed and the patch. Thread-safe.
class FormFactors {
public:
    FormFactors(const Work&, const Patches&, const FormFactorSettings&);
    FormFactors(const Work&, const Patches&&, const FormFactorSettings&) = delete; // they must outlive it
    ~FormFactors();
    // The row of patch i, ascending by patch, into `row` (cleared first). The same patch gives the same row, in any order of calls.
    void row(uint32_t i, std::vector<Factor>& row) const;
    // The same by rays, whatever the method: as many as asked for (rounded up to 16), another set for each salt. For those who want few at
    // a time (progressive refinement).
    void hemisphereRow(uint32_t i, uint32_t rays, uint32_t salt, std::vector<Factor>& row) const;
    // dA at p -> polygon, clipped at the horizon, as if nothing stood between: Lambert's formula. Counter-clockwise corners face p.
    double unoccluded(const Vec3& p, const Vec3& normal, std::span<const Vec3> polygon) const noexcept;
    // F_ij of whole patches, as if nothing stood between, holes of alpha masks apart.
    double unoccluded(uint32_t i, uint32_t j) const noexcept;
    // The share of what i sends j that arrives, by so many rays between them. Symmetric: the same number for j and i.
    double visibility(uint32_t i, uint32_t j, uint32_t rays, uint32_t salt) const noexcept;
    const Patches& patches() const noexcept { return patches_; }
    const FormFactorSettings& settings() const noexcept { return settings_; }

private:
    void analyticRow(uint32_t i, std::vector<Factor>& row) const;
    void hemicubeRow(uint32_t i, std::vector<Factor>& row) const;
    const Work& work_;
    const Patches& patches_;
    FormFactorSettings settings_;
    std::unique_ptr<const Hemicube> hemicube_;
};

// All rows of a scene as one sparse matrix: the exchange areas A_i F_ij in square metres, symmetric to the last bit.
struct FormFactorMatrix {
    std::vector<uint64_t> begin; // of each row, and the end
    std::vector<Factor> exchanges;
    std::vector<float> areas;
    std::size_t size() const noexcept { return areas.size(); }
    // A_i F_ij: what a tight loop wants; B_i = E_i + rho_i / A_i sum_j exchange_ij B_j.
    std::span<const Factor> exchange(uint32_t i) const noexcept { return {exchanges.data() + begin[i], begin[i + 1] - begin[i]}; }
    // F_ij, made as it is read.
    class Row {
    public:
        Row(std::span<const Factor> e, float area) noexcept : e_(e), perArea_(1 / area) {}
        struct Iterator {
            const Factor* at;
            float perArea;
            Factor operator*() const noexcept { return {at->patch, at->factor * perArea}; }
            Iterator& operator++() noexcept { return ++at, *this; }
            bool operator==(const Iterator& o) const noexcept { return at == o.at; }
        };
        Iterator begin() const noexcept { return {e_.data(), perArea_}; }
        Iterator end() const noexcept { return {e_.data() + e_.size(), perArea_}; }
        std::size_t size() const noexcept { return e_.size(); }
        Factor operator[](std::size_t k) const noexcept { return {e_[k].patch, e_[k].factor * perArea_}; }

    private:
        std::span<const Factor> e_;
        float perArea_;
    };
    Row row(uint32_t i) const noexcept { return {exchange(i), areas[i]}; }
    std::size_t bytes() const noexcept {
        return begin.size() * sizeof(uint64_t) + exchanges.size() * sizeof(Factor) + areas.size() * sizeof(float);
    }
};

// What `chiaro ff --check` prints. Of the rows as they were found, before reciprocity was enforced, and of the matrix after it.
struct FormFactorCheck {
    double worstRowSum = 0; // largest |1 - sum of a row| of a closed scene; of an open one, largest excess over 1
    double meanRowSum = 0;
    double worstAsymmetry = 0; // before: largest |A_i F_ij - A_j F_ji| / (A_i + A_j)
    uint32_t worstRow = 0;
    bool closed = true;             // no ray from a patch leaves the scene
    double worstRowSumAfter = 0;    // as worstRowSum, of the matrix
    double worstAsymmetryAfter = 0; // 0: to the last bit
};

// Empty (no areas) where the stop token ended it. Throws Error(Exit::resources) beyond the work's memory limit.
FormFactorMatrix formFactorMatrix(const Work&, const FormFactors&, FormFactorCheck* = nullptr);
// Throws what formFactorMatrix() throws beyond the memory limit, but judging by a few rows, before any work is done.
void requireRoomForMatrix(const Work&, const FormFactors&);

} // namespace chiaro::radiosity
