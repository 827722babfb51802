// An experiment as JSON, as Markdown and as plots of the error per frame.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/character/experiment.h"

namespace pleat {

// What was measured, for titles.
struct ExperimentSubject {
  std::string input;  // the sequence; "walk_a -> walk_b" with the protocol "cross"
  std::string preset;
};

// Returns the cells of the table without its header: what was compared, and what that is compared
// with.
std::vector<std::vector<std::string>> ExperimentTableRows(const ExperimentReport& report);
std::vector<std::string> ExperimentTableHeader();

// Returns the report in the schema "pleat.experiment/1".
nlohmann::ordered_json ExperimentJson(const ExperimentReport& report,
                                      const ExperimentSubject& subject);

// Returns the table, what it means, and links to the plots.
std::string ExperimentMarkdown(const ExperimentReport& report, const ExperimentSubject& subject);

// Returns PNG and SVG bytes by file name, one plot for each group of variants: the mean vertex
// error of every test frame, with gaps where frames were trained on.
absl::StatusOr<std::map<std::string, std::string>> ExperimentPlots(
    const ExperimentReport& report, const ExperimentSubject& subject);

}  // namespace pleat
