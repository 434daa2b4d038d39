// What Chiaro can do in a second, measured: suites of figures over scenes and numbers of threads, as data. Every figure is the median of
// several runs by a clock that never goes back; ratios are taken within one run of a suite, because the machine of the next minute is
// another one. A suite never asks for more than its time: what does not fit is left out and said.
#pragma once
#include "core/render/integrator.h"
#include "integrators/registry.h"
#include <string>
#include <vector>

namespace chiaro::bench {

struct BenchScene {
    std::string name; // as the user called it
    const Scene* scene = nullptr;
    View view;
};

struct Request {
    std::vector<BenchScene> scenes;
    std::vector<IntegratorChoice> integrators; // of the suite of that name
    std::vector<unsigned> threads;             // ascending
    double seconds = 20;                       // of a suite, about
    uint32_t runs = 3;                         // of which the median counts
    uint64_t seed = 0;
    std::size_t memoryLimit = ~std::size_t(0);
    const StopToken& stop;
    Progress& progress; // told of phases
    Diagnostics& notes;
};

struct Column {
    std::string name, unit;
};
struct Row {
    std::string scene, subject;
    unsigned threads = 1;
    double spread = 0;         // of the first figure: (largest - smallest) / median of its runs
    std::vector<double> cells; // one a column; NaN: there is none
};
struct Table {
    std::string suite, title;
    std::vector<Column> columns;
    std::vector<Row> rows;
    std::vector<std::string> notes; // what was left out, and why
    bool stopped = false;           // by the user: the rows that are there are whole
};

struct Suite {
    std::string_view name, summary;
    std::string_view scenes; // the standard ones, parted by commas
    Table (*run)(const Request&);
};
std::span<const Suite> suites();

Table raysSuite(const Request&);
Table integratorsSuite(const Request&);
Table photonsSuite(const Request&);
Table radiositySuite(const Request&);

} // namespace chiaro::bench
