// The ledger of a picture: samples that were no numbers, or too bright for any film, and were left out. All are counted; the first ones are
// located, each with the command that brings it back: the sample alone, the path of light, or, where the state of earlier iterations
// decides, the iterations of that pixel.
#pragma once
#include "tools/cli/settings.h"
#include <nlohmann/json_fwd.hpp>

namespace chiaro::cli {

struct LedgerLine {
    DroppedSample dropped;
    std::string command; // empty: of a splat, which a pixel alone does not bring back
};
std::vector<LedgerLine> ledger(const RenderSettings&, const Film&);
// [{"pixel": [119, 518], "sample": 77, "replay": "chiaro render ..."}]
nlohmann::ordered_json ledgerJson(const RenderSettings&, const Film&);
// The same for the file: "119,518 sample 77; ..."; empty: nothing was dropped.
std::string ledgerText(const Film&);
// One warning for all: how many, where the first was, the command.
void warnDropped(const RenderSettings&, const Job&, const Integrator&, const Film&);

} // namespace chiaro::cli
