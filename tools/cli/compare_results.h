// What `chiaro compare` says: a compact table for people, results.csv with a line for every picture, results.json with everything.
#pragma once
#include "tools/cli/compare_verdict.h"
#include "tools/report/report.h"
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace chiaro::cli {

std::string compareTable(const report::Report&);
std::string compareCsv(const report::Report&);
// stands: of each entry. head: what the report does not hold.
std::string compareJson(const report::Report&, const std::vector<Stands>&, const judge::AgreementSettings&, nlohmann::ordered_json head);

} // namespace chiaro::cli
