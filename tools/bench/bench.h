// What Chiaro can do in a second, measured: suites of figures over scenes and numbers of threads, as data. Every figure is the median of
// several runs by a clock that never goes back; ratios are taken within one run of a suite, because the machine of the next minute is
// another one. A suite never asks for more than its time: what does not fit is left out and said.
#pragma once
#include "core/render/integrator.h"
#include "integrators/registry.h"
#include "tools/bench/plot.h"
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
    double replaySeconds = 0;                  // of every class of rays that is replayed, at least; 0: by the suite's time
    uint64_t seed = 0;
    std::size_t memoryLimit = ~std::size_t(0);
    uint32_t width = 256, height = 256; // of the views of scenes that a suite makes
    std::string isa = {};               // for those; empty: the best
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
    bool failed = false;            // a check of the suite's own; the notes say which
};

struct Suite {
    std::string_view name, summary;
    std::string_view scenes;      // the standard ones, parted by commas; empty: it makes its own
    std::string_view integrators; // the standard ones; empty: all that transport light, where the suite asks for any
    Table (*run)(const Request&);
    std::vector<Panel> (*plot)(const Table&) = nullptr; // its growth; null: it has none to show
};
std::span<const Suite> suites();

Table raysSuite(const Request&);
Table integratorsSuite(const Request&);
Table replaySuite(const Request&);
Table splitSuite(const Request&);
Table trianglesSuite(const Request&);
std::vector<Panel> trianglesPlot(const Table&);
Table photonsSuite(const Request&);
Table radiositySuite(const Request&);
std::vector<Panel> radiosityPlot(const Table&);
// A figure over another, both columns of the table, a curve for each of its subjects.
Panel panelOf(const Table&, std::string title, std::size_t xColumn, std::size_t yColumn);

} // namespace chiaro::bench
