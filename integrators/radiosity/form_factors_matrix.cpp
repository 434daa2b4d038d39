// All rows, made reciprocal.
#include "core/render/error.h"
#include "core/render/fault.h"
#include "integrators/radiosity/form_factors.h"
#include "integrators/radiosity/patch_places.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro::radiosity {
namespace {

constexpr uint32_t probes = 64; // rays of a patch that look for an opening
constexpr double leak = 1e-4;   // share of rays that rounding may let out of a closed room
constexpr int mostScalings = 64;
constexpr double scaledEnough = 1e-6; // of the sum of a row

using Rows = std::vector<std::vector<Factor>>;

struct Sparse {
    std::vector<uint64_t> begin;
    std::vector<Factor> entries;
    std::span<const Factor> row(std::size_t i) const noexcept { return {entries.data() + begin[i], begin[i + 1] - begin[i]}; }
};

[[noreturn]] void refuse(const Work& work, std::size_t patches, double bytes) {
    throw Error(Exit::resources,
                fmt::format("the form factors of {} patches need about {:.2g} GB, limit {:.2g} GB. Take fewer patches or fewer "
                            "rays a row, another solver that keeps no matrix, or raise --max-memory.",
                            patches, bytes / 1e9, double(work.memoryLimit) / 1e9));
}

// The rows, their transpose and the matrix are in memory together: an entry three times.
double bytesFor(double patches, double entriesOfARow) {
    return patches * (sizeof(std::vector<Factor>) + 3 * sizeof(uint64_t) + 3 * sizeof(Factor) * entriesOfARow);
}

class MatrixBuilder {
public:
    MatrixBuilder(const Work& work, const FormFactors& factors) : work_(work), factors_(factors), patches_(factors.patches()) {}
    FormFactorMatrix build(FormFactorCheck* check);

private:
    bool findRows();
    void probe();
    Sparse transposed() const;
    void merge(const Sparse& other, FormFactorMatrix&);
    void scale(FormFactorMatrix&) const;
    void checkBefore(const Sparse& other, FormFactorCheck&) const;
    static void checkAfter(const FormFactorMatrix&, FormFactorCheck&);
    double areaOf(std::size_t i) const noexcept { return double(patches_[i].area); }
    template <class F> void each(F&& f) const { work_.run.chunks(patches_.size(), f, nullptr); }

    const Work& work_;
    const FormFactors& factors_;
    const Patches& patches_;
    Rows rows_;
    std::vector<double> sums_; // of the rows as they were found
    std::vector<double> met_;  // share of a patch's rays that meet a patch
    bool closed_ = false;
};

// Whether rays from the patches all meet something, be it a patch or not; and how many of each patch's meet one.
void MatrixBuilder::probe() {
    std::atomic<uint64_t> lost{0};
    met_.assign(patches_.size(), 0);
    each([&](uint64_t i) {
        const Sampler sampler(work_.seed, work_.sampler, Stream::prepass, hashCombine(i, 0xc105ed), 0);
        const PatchRays source(patches_[i], sampler, patches_.time());
        RayPacket rays;
        std::array<Hit, RayPacket::size> hits;
        uint32_t out = 0, met = 0, counted = probes;
        for (uint32_t first = 0; first < probes; first += RayPacket::size) {
            source.fill(first, rays);
            work_.scene.intersect(rays, hits, false);
            for (std::size_t k = 0; k < hits.size(); ++k) {
                out += !hits[k];
                const bool patch = hits[k] && patches_.seen(hits[k], {rays.dx[k], rays.dy[k], rays.dz[k]}) != ~0u;
                met += patch;
                counted -= !patch && patches_.unlit(hits[k]);
            }
        }
        met_[i] = double(met) / std::max(counted, 1u);
        lost += out;
    });
    closed_ = double(lost) <= leak * probes * double(patches_.size());
}

bool MatrixBuilder::findRows() {
    rows_.resize(patches_.size());
    std::atomic<uint64_t> entries{0}, done{0};
    std::atomic<bool> full{false};
    const double limit = double(work_.memoryLimit), n = double(patches_.size());
    const bool complete = work_.run.chunks(
        patches_.size(),
        [&](uint64_t i) {
            if (full.load(std::memory_order_relaxed)) return;
            std::vector<Factor> row;
            factors_.row(uint32_t(i), row);
            rows_[i].assign(row.begin(), row.end()); // without what the vector holds in reserve
            const uint64_t found = entries += row.size();
            ++done;
            if (bytesFor(n, double(found) / n) > limit) full = true;
        },
        &work_.stop);
    if (full) refuse(work_, patches_.size(), bytesFor(n, double(entries) / double(done)));
    return complete;
}

Sparse MatrixBuilder::transposed() const {
    const std::size_t n = patches_.size();
    Sparse t;
    t.begin.assign(n + 1, 0);
    for (const auto& row : rows_)
        for (const Factor& f : row) ++t.begin[f.patch + 1];
    for (std::size_t i = 0; i < n; ++i) t.begin[i + 1] += t.begin[i];
    t.entries.resize(t.begin[n]);
    std::vector<uint64_t> at(t.begin.begin(), t.begin.end() - 1);
    for (uint32_t i = 0; i < n; ++i)
        for (const Factor& f : rows_[i]) t.entries[at[f.patch]++] = {i, f.factor};
    return t;
}

// Calls f(column, own, other): F_ij of the row and F_ji of column i, 0 where one is absent.
template <class F> void together(std::span<const Factor> row, std::span<const Factor> column, F&& f) {
    std::size_t a = 0, b = 0;
    while (a < row.size() || b < column.size()) {
        const uint32_t i = a < row.size() ? row[a].patch : ~0u, j = b < column.size() ? column[b].patch : ~0u, at = std::min(i, j);
        const double own = i == at ? double(row[a++].factor) : 0, other = j == at ? double(column[b++].factor) : 0;
        f(at, own, other);
    }
}

void MatrixBuilder::merge(const Sparse& other, FormFactorMatrix& m) {
    const std::size_t n = patches_.size();
    m.areas.resize(n);
    m.begin.assign(n + 1, 0);
    each([&](uint64_t i) {
        m.areas[i] = patches_[i].area;
        uint64_t entries = 0;
        together(rows_[i], other.row(i), [&](uint32_t, double, double) { ++entries; });
        m.begin[i + 1] = entries;
    });
    for (std::size_t i = 0; i < n; ++i) m.begin[i + 1] += m.begin[i];
    m.exchanges.resize(m.begin[n]);
    // An estimate of A_i F_ij from rays of i varies in proportion to A_i: weights of the inverse variance. Sum and product are symmetric in
    // i and j, so that both entries get the same bits.
    each([&](uint64_t i) {
        const double area = areaOf(i);
        Factor* to = &m.exchanges[m.begin[i]];
        together(rows_[i], other.row(i), [&](uint32_t j, double own, double its) {
            const double b = areaOf(j);
            double exchange = (own + its) * ((area * b) / (area + b));
            if (fault(Fault::formFactorTransposed)) exchange = area * its;
            *to++ = {j, float(exchange)};
        });
        std::vector<Factor>().swap(rows_[i]);
    });
}

void MatrixBuilder::scale(FormFactorMatrix& m) const {
    const std::size_t n = m.size();
    std::vector<double> d(n, 1), next(n);
    for (int round = 0; round < mostScalings; ++round) {
        std::vector<double> wrong(n, 0);
        each([&](uint64_t i) {
            double sum = 0;
            for (const Factor& f : m.exchange(uint32_t(i))) sum += double(f.factor) * d[f.patch];
            const double now = sum * d[i] / areaOf(i);
            next[i] = now > 0 && sums_[i] > 0 ? std::clamp(d[i] * std::sqrt(sums_[i] / now), 0.25, 4.0) : d[i];
            wrong[i] = std::fabs(now - sums_[i]);
        });
        d.swap(next);
        if (*std::max_element(wrong.begin(), wrong.end()) < scaledEnough) break;
    }
    each([&](uint64_t i) {
        for (uint64_t k = m.begin[i]; k < m.begin[i + 1]; ++k) {
            Factor& f = m.exchanges[k];
            f.factor = float(double(f.factor) * (d[i] * d[f.patch]));
        }
    });
}

void MatrixBuilder::checkBefore(const Sparse& other, FormFactorCheck& c) const {
    const std::size_t n = patches_.size();
    std::vector<double> asymmetry(n, 0);
    each([&](uint64_t i) {
        together(rows_[i], other.row(i), [&](uint32_t j, double own, double its) {
            const double a = areaOf(i), b = areaOf(j);
            asymmetry[i] = std::max(asymmetry[i], std::fabs(a * own - b * its) / (a + b));
        });
    });
    double sum = 0;
    for (const double s : sums_) sum += s;
    c.meanRowSum = n ? sum / double(n) : 0;
    c.worstAsymmetry = n ? *std::max_element(asymmetry.begin(), asymmetry.end()) : 0;
    c.closed = closed_;
    for (uint32_t i = 0; i < n; ++i) {
        const double wrong = c.closed ? std::fabs(1 - sums_[i]) : std::max(sums_[i] - 1, 0.0);
        if (wrong > c.worstRowSum) c.worstRowSum = wrong, c.worstRow = i;
    }
}

void MatrixBuilder::checkAfter(const FormFactorMatrix& m, FormFactorCheck& c) {
    for (uint32_t i = 0; i < m.size(); ++i) {
        double sum = 0;
        for (const Factor& f : m.exchange(i)) {
            sum += double(f.factor);
            const auto mirror = m.exchange(f.patch);
            const auto at = std::lower_bound(mirror.begin(), mirror.end(), i, [](const Factor& x, uint32_t p) { return x.patch < p; });
            const double its = at != mirror.end() && at->patch == i ? double(at->factor) : 0;
            c.worstAsymmetryAfter = std::max(c.worstAsymmetryAfter, std::fabs(double(f.factor) - its));
        }
        sum /= double(m.areas[i]);
        c.worstRowSumAfter = std::max(c.worstRowSumAfter, c.closed ? std::fabs(1 - sum) : std::max(sum - 1, 0.0));
    }
}

FormFactorMatrix MatrixBuilder::build(FormFactorCheck* check) {
    FormFactorMatrix m;
    if (patches_.size() == 0 || !findRows()) return m;
    const bool analytic = factors_.settings().method == FormFactorMethod::analytic;
    const bool guessed = analytic && factors_.settings().shadowRays > 0; // the share that arrives
    if (check || guessed) probe();
    for (const auto& row : rows_) {
        double sum = 0;
        for (const Factor& f : row) sum += double(f.factor);
        sums_.push_back(sum);
    }
    {
        const Sparse other = transposed();
        if (check) checkBefore(other, *check);
        merge(other, m);
    }
    // Analytic factors are symmetric as they are. Where rays weighed what hides them, other rays tell what they must sum to.
    if (guessed) sums_ = met_;
    if ((!analytic || guessed) && !fault(Fault::formFactorTransposed)) scale(m);
    if (check) checkAfter(m, *check);
    return m;
}

} // namespace

void requireRoomForMatrix(const Work& work, const FormFactors& factors) {
    constexpr std::size_t looks = 64; // rows that speak for all
    const std::size_t n = factors.patches().size(), step = std::max<std::size_t>(1, n / looks);
    if (bytesFor(double(n), double(n)) <= double(work.memoryLimit)) return; // even a full one fits
    std::vector<Factor> row;
    double entries = 0, seen = 0;
    for (std::size_t i = 0; i < n; i += step, ++seen) {
        factors.row(uint32_t(i), row);
        entries += double(row.size());
    }
    const double bytes = bytesFor(double(n), entries / seen);
    if (bytes > double(work.memoryLimit)) refuse(work, n, bytes);
}

FormFactorMatrix formFactorMatrix(const Work& work, const FormFactors& factors, FormFactorCheck* check) {
    return MatrixBuilder(work, factors).build(check);
}

} // namespace chiaro::radiosity
