// Curves over logarithmic axes, as an SVG picture: growth shows as a slope. Points are marked, decades ruled and labelled.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace chiaro::bench {

struct Curve {
    std::string name;
    std::vector<std::pair<double, double>> points; // those that are not positive and finite are left out
};
struct Panel {
    std::string title, xName, yName; // names with their units: "time, s"
    std::vector<Curve> curves;
};

// The panels side by side; the curves of one name have one colour and one entry in the legend below them.
std::string svgPlot(const std::vector<Panel>&);

} // namespace chiaro::bench
