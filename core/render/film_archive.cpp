// A film to a file and back, to the last bit: sums, not quotients. Sums of 128 bits go in runs that say whether 64 bits hold them all,
// which they nearly always do.
#include "core/render/archive.h"
#include "core/render/film.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro {
namespace {

constexpr std::size_t run = 4096;

// at(i): the i-th of `count` sums.
template <class At> void putFixed(Writer& to, std::size_t count, At&& at) {
    std::vector<Int128> some;
    std::vector<int64_t> narrow;
    for (std::size_t begin = 0; begin < count; begin += run) {
        some.resize(std::min(run, count - begin));
        for (std::size_t i = 0; i < some.size(); ++i) some[i] = at(begin + i);
        const bool wide = std::any_of(some.begin(), some.end(), [](Int128 v) { return Int128(int64_t(v)) != v; });
        to.value(uint8_t(wide));
        if (wide) {
            to.array(some);
            continue;
        }
        narrow.assign(some.begin(), some.end());
        to.array(narrow);
    }
}

template <class T> void getSome(Reader& from, std::span<Int128> some) {
    const std::vector<T> v = from.array<T>();
    if (v.size() != some.size()) from.refuse("its sums are not those of its picture; it is damaged");
    std::copy(v.begin(), v.end(), some.begin());
}
void getFixed(Reader& from, std::span<Int128> all) {
    for (std::size_t i = 0; i < all.size(); i += run) {
        const std::span<Int128> some = all.subspan(i, std::min(run, all.size() - i));
        from.value<uint8_t>() ? getSome<Int128>(from, some) : getSome<int64_t>(from, some);
    }
}

template <class T> void getArray(Reader& from, std::vector<T>& to) {
    std::vector<T> v = from.array<T>();
    if (v.size() != to.size()) from.refuse("its layers are not those of its picture; it is damaged");
    to = std::move(v);
}

void putLayout(Writer& to, const FilmLayout& l) {
    to.value(l.width);
    to.value(l.height);
    to.value(l.crop);
    to.value(uint32_t(l.layers.size()));
    for (const std::string& name : l.layers) to.text(name);
    for (const bool b : {l.splats, l.costs, l.photons}) to.value(uint8_t(b));
}
FilmLayout getLayout(Reader& from) {
    FilmLayout l;
    l.width = from.value<uint32_t>();
    l.height = from.value<uint32_t>();
    l.crop = from.value<Rect>();
    const auto layers = from.value<uint32_t>();
    const Rect& c = l.crop;
    if (c.x0 >= c.x1 || c.y0 >= c.y1 || c.x1 > l.width || c.y1 > l.height || layers > uint32_t(Outputs::maxLayers))
        from.refuse("it holds no picture; it is damaged");
    for (uint32_t i = 0; i < layers; ++i) l.layers.push_back(from.text());
    for (bool* b : {&l.splats, &l.costs, &l.photons}) *b = from.value<uint8_t>() != 0;
    return l;
}

} // namespace

void Film::save(Writer& to) const {
    putLayout(to, layout_);
    to.value(begin_);
    to.value(done_);
    putFixed(to, sums_.size() * 6, [&](std::size_t i) { return (&sums_[i / 6].half[0][0])[i % 6]; });
    to.array(aovs_);
    to.array(counts_);
    to.array(costs_);
    if (!gathered_.empty()) putFixed(to, gathered_.size() * 3, [&](std::size_t i) { return gathered_[i / 3][i % 3]; });
    if (splats_)
        putFixed(to, sums_.size() * 6, [&](std::size_t i) {
            const auto& d = splats_[i / 6].digit[i % 6 / 3][i % 3];
            return Int128(d[0].load()) + (Int128(d[1].load()) << 32) + (Int128(d[2].load()) << 64);
        });
    to.value(lightPaths_);
    to.value(droppedCount_.load());
    to.array(droppedSamples());
    to.value(growth_.samples);
    to.value(growth_.spread);
    to.value(growth_.pooledBefore);
    to.value(growth_.squaresBefore);
    to.array(grown_);
    to.value(grownAt_);
}

std::unique_ptr<Film> Film::load(Reader& from, std::size_t memory) {
    const FilmLayout layout = getLayout(from);
    if (layout.crop.area() > from.left() / sizeof(Counts)) from.refuse("the file is cut short or damaged; make it again");
    if (layout.bytes() > memory)
        throw Error(Exit::resources,
                    fmt::format("a picture of {}x{} needs about {:.1f} GB, more than there may be. Give more with --max-memory.",
                                layout.crop.width(), layout.crop.height(), double(layout.bytes()) * 1e-9));
    const auto begin = from.value<uint32_t>();
    auto film = std::make_unique<Film>(layout, begin);
    film->done_ = from.value<uint32_t>();
    getFixed(from, {&film->sums_[0].half[0][0], film->sums_.size() * 6});
    getArray(from, film->aovs_);
    getArray(from, film->counts_);
    getArray(from, film->costs_);
    if (!film->gathered_.empty()) getFixed(from, {film->gathered_[0].data(), film->gathered_.size() * 3});
    if (film->splats_) {
        std::vector<Int128> sums(film->sums_.size() * 6);
        getFixed(from, sums);
        for (std::size_t i = 0; i < sums.size(); ++i) {
            auto& d = film->splats_[i / 6].digit[i % 6 / 3][i % 3];
            d[0] = int64_t(uint32_t(sums[i]));
            d[1] = int64_t(uint32_t(sums[i] >> 32));
            d[2] = int64_t(sums[i] >> 64);
        }
    }
    for (double& paths : film->lightPaths_) paths = from.value<double>();
    film->droppedCount_ = from.value<uint64_t>();
    film->dropped_ = from.array<DroppedSample>();
    film->growth_.samples = from.value<uint32_t>();
    film->growth_.spread = from.value<Spread>();
    film->growth_.pooledBefore = from.value<double>();
    film->growth_.squaresBefore = from.value<double>();
    film->grown_ = from.array<float>();
    film->grownAt_ = from.value<uint32_t>();
    const bool grew = film->grownAt_ > 0;
    bool sound = film->done_ >= begin && film->grown_.size() == (grew ? layout.crop.area() : 0) && film->dropped_.size() <= 16;
    for (const Counts& c : film->counts_) sound = sound && c.next >= begin && uint64_t(c.kept[0]) + c.kept[1] <= c.next - begin;
    for (const DroppedSample& d : film->dropped_) sound = sound && d.pixel.x < layout.width && d.pixel.y < layout.height;
    if (!sound) from.refuse("its counts cannot be; it is damaged");
    return film;
}

} // namespace chiaro
