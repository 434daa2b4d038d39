// Quadrature for the tables of this folder.
#pragma once
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace chiaro {

// Nodes and weights of Gauss-Legendre quadrature on [0, 1] (Newton on the Legendre recurrence).
struct Gauss {
    std::vector<float> x, w;
    explicit Gauss(int n) : x(std::size_t(n)), w(std::size_t(n)) {
        for (int i = 0; i < n; ++i) {
            double z = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1;
            for (int k = 0; k < 20; ++k) {
                double p = 1, before = 0;
                for (int j = 0; j < n; ++j) {
                    const double next = ((2 * j + 1) * z * p - j * before) / (j + 1);
                    before = p;
                    p = next;
                }
                slope = n * (z * p - before) / (z * z - 1);
                z -= p / slope;
            }
            x[std::size_t(i)] = float((1 - z) / 2);
            w[std::size_t(i)] = float(1 / ((1 - z * z) * slope * slope));
        }
    }
};

} // namespace chiaro
