// What `chiaro agree` says: one row an integrator (or pair of pictures), as a table for people, as CSV and as JSON.
#pragma once
#include "tools/cli/agree_run.h"
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace chiaro::cli {

struct AgreeRow {
    std::string name, judgedOn;
    judge::Verdict verdict = judge::Verdict::cannotTell;
    std::string text; // the verdict with its numbers
    Judgement judgement;
    judge::AgreementSettings rule;              // of this row
    double samples = 0;                         // a pixel and side; 0: not known
    double seconds = 0, referenceSeconds = 0;   // of rendering
    uint64_t dropped = 0, referenceDropped = 0; // non-finite samples left out
    std::vector<std::string> notes;
};

std::string agreeTable(const std::vector<AgreeRow>&);
// Lines "verdict", "note".
std::string agreeVerdicts(const std::vector<AgreeRow>&);
std::string agreeCsv(const std::vector<AgreeRow>&);
nlohmann::ordered_json agreeJson(const AgreeRow&);

} // namespace chiaro::cli
