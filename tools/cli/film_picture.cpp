#include "tools/cli/film_picture.h"

namespace chiaro::cli {
namespace {

template <class F> judge::Picture pictureBy(const Film& film, std::string name, F&& value) {
    const Rect& r = film.layout().crop;
    judge::Picture p{r.width(), r.height(), {}, {}, std::move(name), {}};
    p.rgb.reserve(p.pixels() * 3);
    for (uint32_t y = r.y0; y < r.y1; ++y)
        for (uint32_t x = r.x0; x < r.x1; ++x) {
            const Spectrum v = value(Pixel{x, y});
            for (std::size_t c = 0; c < 3; ++c) p.rgb.push_back(v[c]);
        }
    return p;
}

} // namespace

judge::Picture judgedPicture(const Film& film, std::string name) {
    return pictureBy(film, std::move(name), [&](Pixel p) { return film.mean(p); });
}

judge::Picture judgedLayer(const Film& film, int layer, std::string name) {
    return pictureBy(film, std::move(name), [&](Pixel p) { return film.mean(p, layer); });
}

double meanLuminance(const judge::Picture& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.rgb.size(); i += 3) sum += luminance(Rgb<double>(p.rgb[i], p.rgb[i + 1], p.rgb[i + 2]));
    return sum / double(p.pixels());
}

} // namespace chiaro::cli
