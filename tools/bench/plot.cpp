#include "tools/bench/plot.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::bench {
namespace {

constexpr double panelWidth = 400, panelHeight = 330;
constexpr double left = 62, right = 14, top = 34, bottom = 46; // of a panel, beside what is drawn
constexpr double legendLine = 20, legendEntry = 190;
// Okabe and Ito (2008), told apart by every eye, and a grey.
constexpr std::array colors = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8C8C8C"};

bool drawn(const std::pair<double, double>& p) { return std::isfinite(p.first) && std::isfinite(p.second) && p.first > 0 && p.second > 0; }

// A range of decades and its place on the paper.
struct Axis {
    double low = 0, high = 1; // log10
    double from = 0, to = 1;  // pixels
    double at(double v) const { return from + (std::log10(v) - low) / (high - low) * (to - from); }
};
Axis axisOf(const Panel& panel, bool x, double from, double to) {
    double least = 1e300, most = 0;
    for (const Curve& c : panel.curves)
        for (const auto& p : c.points)
            if (drawn(p)) least = std::min(least, x ? p.first : p.second), most = std::max(most, x ? p.first : p.second);
    if (most == 0) return {0, 1, from, to};
    Axis a{std::log10(least), std::log10(most), from, to};
    const double room = std::max(0.06 * (a.high - a.low), 0.05); // about the outermost points
    a.low -= room, a.high += room;
    if (std::ceil(a.low) > std::floor(a.high)) a.low = std::floor(a.low), a.high = std::ceil(a.high); // one decade is named at least
    return a;
}

std::string escaped(const std::string& text) {
    std::string all;
    for (const char c : text) all += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
    return all;
}
std::string decadeName(int n) {
    static constexpr std::array<const char*, 10> names = {"0.001", "0.01",  "0.1",    "1",       "10",
                                                          "100",   "1,000", "10,000", "100,000", "1,000,000"};
    return n >= -3 && n <= 6 ? names[std::size_t(n + 3)] : fmt::format("1e{}", n);
}

std::string text(double x, double y, const char* anchor, const std::string& words, const char* more = "") {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more, escaped(words));
}
std::string line(double x0, double y0, double x1, double y1, const char* color) {
    return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x0, y0, x1, y1, color);
}

std::string rules(const Axis& x, const Axis& y) {
    std::string s;
    const auto each = [](const Axis& a, auto&& draw) {
        for (int d = int(std::floor(a.low)); d <= int(std::ceil(a.high)); ++d)
            for (int k = 1; k < 10; ++k)
                if (const double v = k * std::pow(10.0, d); std::log10(v) >= a.low && std::log10(v) <= a.high) draw(v, d, k);
    };
    each(x, [&](double v, int d, int k) {
        s += line(x.at(v), y.from, x.at(v), y.to, k == 1 ? "#bbb" : "#eee");
        if (k == 1) s += text(x.at(v), y.from + 16, "middle", decadeName(d));
    });
    each(y, [&](double v, int d, int k) {
        s += line(x.from, y.at(v), x.to, y.at(v), k == 1 ? "#bbb" : "#eee");
        if (k == 1) s += text(x.from - 6, y.at(v) + 4, "end", decadeName(d));
    });
    return s + fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#666\"/>\n", x.from, y.to,
                           x.to - x.from, y.from - y.to);
}

std::string curve(const Curve& c, const char* color, const Axis& x, const Axis& y) {
    std::vector<std::pair<double, double>> points;
    std::copy_if(c.points.begin(), c.points.end(), std::back_inserter(points), drawn);
    std::sort(points.begin(), points.end());
    std::string path, marks;
    for (const auto& [px, py] : points) {
        path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "" : " ", x.at(px), y.at(py));
        marks += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n", x.at(px), y.at(py), color);
    }
    return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"/>\n{}", path, color, marks);
}

} // namespace

std::string svgPlot(const std::vector<Panel>& panels) {
    std::vector<std::string> names;
    for (const Panel& p : panels)
        for (const Curve& c : p.curves)
            if (std::find(names.begin(), names.end(), c.name) == names.end()) names.push_back(c.name);
    const auto colorOf = [&](const std::string& name) {
        return colors[std::size_t(std::find(names.begin(), names.end(), name) - names.begin()) % colors.size()];
    };
    const double width = panelWidth * double(std::max<std::size_t>(1, panels.size()));
    const std::size_t columns = std::max<std::size_t>(1, std::size_t((width - left) / legendEntry));
    const double height = panelHeight + legendLine * double((names.size() + columns - 1) / columns) + 10;
    std::string s = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
                                "{1:.0f}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n<rect width=\"100%\" "
                                "height=\"100%\" fill=\"#fff\"/>\n",
                                width, height);
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const Panel& p = panels[i];
        const double x0 = panelWidth * double(i);
        const Axis x = axisOf(p, true, x0 + left, x0 + panelWidth - right), y = axisOf(p, false, panelHeight - bottom, top);
        s += rules(x, y);
        for (const Curve& c : p.curves) s += curve(c, colorOf(c.name), x, y);
        s += text(x.from, top - 12, "start", p.title, " font-weight=\"bold\"");
        s += text((x.from + x.to) / 2, panelHeight - 10, "middle", p.xName);
        s += text(0, 0, "middle", p.yName,
                  fmt::format(" transform=\"translate({:.1f} {:.1f}) rotate(-90)\"", x0 + 13, (y.from + y.to) / 2).c_str());
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        const double x = left + legendEntry * double(i % columns), y = panelHeight + 12 + legendLine * double(i / columns);
        s += fmt::format("<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{2:.1f}\" y2=\"{1:.1f}\" stroke=\"{3}\" stroke-width=\"1.8\"/>\n", x,
                         y - 4, x + 22, colorOf(names[i])) +
             fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n", x + 11, y - 4, colorOf(names[i]));
        s += text(x + 28, y, "start", names[i]);
    }
    return s + "</svg>\n";
}

} // namespace chiaro::bench
