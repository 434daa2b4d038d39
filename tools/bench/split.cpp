// Where the time of a render goes, by asking its threads where they are (tools/bench/profile.h).
#include "tools/bench/profile.h"
#include "tools/bench/rendering.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro::bench {
namespace {

constexpr std::size_t namedFunctions = 6;

std::string costliest(const TimeSplit& split) {
    std::vector<std::pair<double, std::string>> all;
    for (const auto& [name, share] : split.functions) all.emplace_back(share, name);
    std::sort(all.rbegin(), all.rend());
    std::string text;
    for (std::size_t i = 0; i < std::min(namedFunctions, all.size()); ++i)
        text += fmt::format("{}{} {:.1f} %", i ? ", " : "", all[i].second, 100 * all[i].first);
    return text;
}

} // namespace

Table splitSuite(const Request& request) {
    Table table{
        .suite = "split",
        .title = "where the threads of a render are, in % of the processor's time",
        .columns = {},
        .rows = {},
        .notes = {"trace: inside Embree; packets: our layout of its rays and hits; walk: the integrator's own loop and all that the "
                  "compiler has put into it; waiting: looking for work; idle: no work, or another program had the processor; "
                  "asked: how often the processor's clock has asked"}};
    for (int p = 0; p < partCount; ++p) table.columns.push_back({std::string(partName(Part(p))), "%"});
    table.columns.push_back({"idle", "% of threads"});
    table.columns.push_back({"asked", ""});
    const double seconds =
        request.seconds / double(std::max<std::size_t>(1, request.scenes.size() * request.integrators.size() * request.threads.size()));
    const PathClasses classes;
    for (const BenchScene& s : request.scenes)
        for (const IntegratorChoice& choice : request.integrators)
            for (const unsigned threads : request.threads) {
                request.progress.phase(fmt::format("split {} {} {} thread{}", nameOf(choice), s.name, threads, threads == 1 ? "" : "s"));
                const Executor run(threads);
                const Job job{{*s.scene, classes, s.view.shutter, request.seed, SamplerKind::sobol, run, request.stop, request.progress,
                               request.notes, request.memoryLimit},
                              s.view};
                Rendering rendering(job, choice);
                rendering.pass();
                Profile profile;
                profile.start();
                const auto begin = Clock::now();
                while (secondsSince(begin) < seconds && !request.stop.requested()) rendering.pass();
                profile.stop();
                table.stopped = request.stop.requested();
                if (table.stopped) return table;
                const TimeSplit split = profile.split(threads);
                Row row{s.name, nameOf(choice), threads, 0, {}};
                for (const double share : split.share) row.cells.push_back(100 * share);
                row.cells.push_back(100 * split.idle);
                row.cells.push_back(double(split.samples));
                table.rows.push_back(std::move(row));
                table.notes.push_back(fmt::format("{} {} {}: {}", s.name, nameOf(choice), threads, costliest(split)));
            }
    return table;
}

} // namespace chiaro::bench
