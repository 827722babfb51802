#include "cli/show/experiment_files.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/show/error_text.h"
#include "cli/show/report_json.h"
#include "cli/show/text_table.h"
#include "pleat/base/status.h"
#include "pleat/render/line_plot.h"

namespace pleat {
namespace {

using nlohmann::ordered_json;

std::vector<std::string> Groups(const ExperimentReport& report) {
  std::vector<std::string> groups;
  for (const ExperimentRow& row : report.rows) {
    if (std::find(groups.begin(), groups.end(), row.variant.group) == groups.end()) {
      groups.push_back(row.variant.group);
    }
  }
  return groups;
}

std::string PlotName(const ExperimentReport& report, const std::string& group) {
  return absl::StrCat(ExperimentName(report.experiment),
                      Groups(report).size() > 1 ? absl::StrCat("-", group) : "", ".png");
}

std::string HybridName(const ExperimentRow& row) {
  return row.variant.name == "hybrid" ? absl::StrCat("hybrid (", row.report.learner, ")")
                                      : row.variant.name;
}

// Returns the error over the frame numbers, with gaps where nothing was tested.
PlotSeries SeriesOf(const std::string& name, const ErrorSummary& error,
                    const std::vector<int>& test_frames) {
  PlotSeries series{absl::StrFormat("%s: %.3f", name, error.mean_percent), {}};
  const int first = test_frames.front();
  series.values.assign(test_frames.back() - first + 1, std::numeric_limits<double>::quiet_NaN());
  for (size_t i = 0; i < test_frames.size(); ++i) {
    series.values[test_frames[i] - first] = error.frame_mean_percent[i];
  }
  return series;
}

bool ShowsSkinned(const ExperimentReport& report) {
  return report.experiment == Experiment::kFullVsFine ||
         report.experiment == Experiment::kSkinnedVsHybrid;
}

const char* Meaning(Experiment experiment) {
  switch (experiment) {
    case Experiment::kFullVsFine:
      return "Learning the details beyond skinning (fine) against learning all deformation beyond "
             "the motion of the root (full); all components of both are kept.";
    case Experiment::kRepresentations:
      return "Rotations of the pose features, and axes or coordinates of the details; everything "
             "else as in the preset.";
    case Experiment::kResolutions:
      return "Share of the vertices that learn; the others follow by upsampling.";
    case Experiment::kSkinnedVsHybrid:
      break;
  }
  return "Skinning alone against skinning with learned details.";
}

std::string Title(const ExperimentReport& report, const ExperimentSubject& subject) {
  return absl::StrFormat("%s, %s, protocol %s, preset %s", ExperimentName(report.experiment),
                         subject.input, report.rows.front().report.protocol, subject.preset);
}

std::vector<std::string> Row(const std::string& group, const std::string& name,
                             const ErrorSummary& error, const std::string& learn_seconds) {
  std::vector<std::string> row = MotionTableRow(name, error);
  row.insert(row.begin(), group);
  row.push_back(learn_seconds);
  return row;
}

}  // namespace

std::vector<std::string> ExperimentTableHeader() {
  std::vector<std::string> header = MotionTableHeader("variant");
  header.insert(header.begin(), "comparison");
  header.emplace_back("learn s");
  return header;
}

std::vector<std::vector<std::string>> ExperimentTableRows(const ExperimentReport& report) {
  std::vector<std::vector<std::string>> rows;
  const EvaluateReport& first = report.rows.front().report;
  ErrorSummary truth;  // the truth has no error, but it has a jitter of its own
  truth.num_motion_frames = first.skinned.num_motion_frames;
  truth.num_jitter_frames = first.skinned.num_jitter_frames;
  truth.jitter_mm = first.skinned.truth_jitter_mm;
  rows.push_back(Row("", "the input itself", truth, "-"));
  rows.push_back(Row("", "skinned only", first.skinned, "-"));
  for (const ExperimentRow& row : report.rows) {
    rows.push_back(Row(row.variant.group, HybridName(row), row.report.hybrid,
                       absl::StrFormat("%.2f", row.report.seconds.at("learn"))));
    if (report.experiment != Experiment::kSkinnedVsHybrid) continue;
    for (const auto& [name, error] : row.report.learners) {
      rows.push_back(Row("learner", name, error, "-"));
    }
    for (const auto& [name, error] : row.report.baselines) {
      rows.push_back(Row("baseline", name, error, "-"));
    }
  }
  return rows;
}

ordered_json ExperimentJson(const ExperimentReport& report, const ExperimentSubject& subject) {
  ordered_json json;
  json["schema"] = "pleat.experiment/1";
  json["experiment"] = ExperimentName(report.experiment);
  json["input"] = subject.input;
  json["preset"] = subject.preset;
  json["rows"] = ordered_json::array();
  for (const ExperimentRow& row : report.rows) {
    ordered_json one = {{"comparison", row.variant.group}, {"variant", row.variant.name}};
    one["num_control_vertices"] = row.report.num_control_vertices;
    one.update(EvaluateReportJson(row.report));
    one["frame_mean_percent"]["learners"] = ordered_json::object();
    for (const auto& [name, error] : row.report.learners) {
      one["frame_mean_percent"]["learners"][name] = error.frame_mean_percent;
    }
    json["rows"].push_back(std::move(one));
  }
  return json;
}

std::string ExperimentMarkdown(const ExperimentReport& report, const ExperimentSubject& subject) {
  const EvaluateReport& first = report.rows.front().report;
  std::string text = absl::StrFormat(
      "# %s\n\n%s\n\n%d training frames, %d test frames, diagonal %.3f m. Errors are vertex "
      "distances on the test frames, %% of the diagonal; step: mean error of the frame-to-frame "
      "motion; jitter: RMS second difference of the vertices.\n\n",
      Title(report, subject), Meaning(report.experiment), first.num_train_frames,
      first.num_test_frames, first.diagonal_m);
  text += FormatMarkdownTable(ExperimentTableHeader(), ExperimentTableRows(report));
  for (const std::string& group : Groups(report)) {
    absl::StrAppendFormat(&text, "\n![%s: mean error of every test frame](%s)\n", group,
                          PlotName(report, group));
  }
  return text;
}

absl::StatusOr<std::map<std::string, std::string>> ExperimentPlots(
    const ExperimentReport& report, const ExperimentSubject& subject) {
  std::map<std::string, std::string> plots;
  for (const std::string& group : Groups(report)) {
    std::vector<PlotSeries> series;
    LinePlotOptions options;
    options.width = 1000;
    options.height = 420;
    options.title = Title(report, subject);
    for (const ExperimentRow& row : report.rows) {
      if (row.variant.group != group) continue;
      const EvaluateReport& measured = row.report;
      if (series.empty()) {
        options.first_x = measured.test_frames.front();
        options.y_label = absl::StrFormat("mean vertex error, %% of the diagonal (1 %% = %.1f mm)",
                                          10 * measured.diagonal_m);
        if (ShowsSkinned(report)) {
          series.push_back(SeriesOf("skinned only", measured.skinned, measured.test_frames));
        }
      }
      series.push_back(SeriesOf(HybridName(row), measured.hybrid, measured.test_frames));
    }
    const std::string name = PlotName(report, group);
    for (const std::string& file : {name, name.substr(0, name.rfind('.')) + ".svg"}) {
      PLEAT_ASSIGN_OR_RETURN(plots[file], EncodeLinePlot(file, series, options));
    }
  }
  return plots;
}

}  // namespace pleat
