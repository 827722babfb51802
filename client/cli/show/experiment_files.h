// An experiment as JSON, as Markdown and as plots of the error per frame.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/character/experiment.h"

namespace pleat {

// What is measured on what, for titles.
struct ExperimentSubject {
  std::string input;  // of the sequence; "walk_a -> walk_b" with protocol cross
  std::string preset;
};

// The table's cells, without its header: what was compared, and what that is compared with.
std::vector<std::vector<std::string>> ExperimentTableRows(const ExperimentReport& report);
std::vector<std::string> ExperimentTableHeader();

// "pleat.experiment/1"
nlohmann::ordered_json ExperimentJson(const ExperimentReport& report,
                                      const ExperimentSubject& subject);

// Table, what it means and the plots by name.
std::string ExperimentMarkdown(const ExperimentReport& report, const ExperimentSubject& subject);

// PNG bytes by file name, one plot for each group of variants: mean vertex error of every test
// frame, gaps where frames were trained on.
absl::StatusOr<std::map<std::string, std::string>> ExperimentPlots(
    const ExperimentReport& report, const ExperimentSubject& subject);

}  // namespace pleat
