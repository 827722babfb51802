// rig INPUT... --report r.json: rigs many inputs automatically and shows the results as one table.
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/exit_code.h"
#include "cli/io/input.h"
#include "cli/io/output_path.h"
#include "cli/io/rig_measurement.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/text_table.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/character/option_choices.h"
#include "pleat/character/placed_joints.h"
#include "pleat/formats/rig_file.h"

namespace pleat {
namespace {

struct RigVerbOptions {
  std::vector<std::string> inputs, truths, placed;
  std::string report, fps, output;
  RigMeasurementOptions measurement;
  bool no_fit = false;
};

std::string Cell(const std::optional<double>& value, const char* unit_format, double factor) {
  if (!value) return "-";
  return absl::StrFormat(*absl::ParsedFormat<'f'>::New(unit_format), *value * factor);
}

std::vector<std::string> TableRow(const RigMeasurement& row) {
  const std::string seconds = absl::StrFormat("%.2f", row.rig_cpu_seconds);
  if (!row.rig) {
    return {row.input,
            absl::StrCat(row.num_frames),
            absl::StrCat(row.num_vertices),
            "refused",
            "-",
            "-",
            "-",
            "-",
            "-",
            seconds};
  }
  std::optional<double> joint_error;
  if (row.joint_errors) joint_error = row.joint_errors->mean_m;
  return {row.input,
          absl::StrCat(row.num_frames),
          absl::StrCat(row.num_vertices),
          absl::StrFormat("%.4f", row.summary.residual),
          absl::StrFormat("%.0f", row.summary.yaw_degrees),
          absl::StrCat(row.summary.rest_frame),
          Cell(joint_error, "%.1f", 1000),
          Cell(row.fit_rms_percent, "%.3f", 1),
          Cell(row.refined_rms_percent, "%.3f", 1),
          seconds};
}

void PrintText(const std::vector<RigMeasurement>& rows, std::ostream& out) {
  std::vector<std::vector<std::string>> cells;
  for (const RigMeasurement& row : rows) cells.push_back(TableRow(row));
  out << FormatTable({"input", "frames", "vertices", "residual", "yaw", "rest frame", "joints mm",
                      "fit %", "refined %", "cpu s"},
                     cells);
  for (const RigMeasurement& row : rows) {
    if (!row.rig) out << row.input << ": refused: " << std::string(row.status.message()) << "\n";
    for (const std::string& warning : row.summary.warnings) {
      out << row.input << ": warning: " << warning << "\n";
    }
  }
}

absl::StatusOr<RigMeasurement> MeasureInput(const RigVerbOptions& options, size_t i,
                                            const Session& session) {
  const std::string& input = options.inputs[i];
  std::vector<InputNote> notes;
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                         ReadInput(session, input, options.fps, &notes));
  const std::string truth_path =
      i < options.truths.size() ? options.truths[i] : FindJointTruth(input);
  std::optional<JointTruth> truth;
  if (!truth_path.empty() && truth_path != "-") {
    PLEAT_ASSIGN_OR_RETURN(truth, ReadJointTruth(truth_path));
  }
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_ASSIGN_OR_RETURN(RigMeasurement row,
                         MeasureRig(input, sequence, truth ? &*truth : nullptr, options.measurement,
                                    InterruptibleProgress(&display)));
  row.input_notes = std::move(notes);
  return row;
}

absl::Status RunRig(RigVerbOptions options, const Session& session) {
  if (options.truths.size() > options.inputs.size()) {
    return UsageError("there are more --truth than inputs");
  }
  if (!options.output.empty() && options.inputs.size() != 1) {
    return UsageError("-o takes one INPUT");
  }
  if (!options.placed.empty() && options.inputs.size() != 1) {
    return UsageError("--at takes one INPUT");
  }
  absl::StatusOr<std::vector<PlacedJoint>> placed =
      ParsePlacedJoints(absl::StrJoin(options.placed, " "));
  if (!placed.ok()) return UsageError(absl::StrCat("--at: ", placed.status().message()));
  options.measurement.rig.placed_joints = *std::move(placed);
  PLEAT_RETURN_IF_ERROR(CheckOutputFiles(
      session, {{"-o", options.output, {".json"}}, {"--report", options.report, {".json"}}}));
  options.measurement.fit = !options.no_fit;
  std::vector<RigMeasurement> rows;
  for (size_t i = 0; i < options.inputs.size(); ++i) {
    PLEAT_ASSIGN_OR_RETURN(RigMeasurement row, MeasureInput(options, i, session));
    rows.push_back(std::move(row));
  }
  nlohmann::ordered_json report;
  report["schema"] = "pleat.rig/1";
  report["rigs"] = nlohmann::ordered_json::array();
  int num_refused = 0;
  for (const RigMeasurement& row : rows) {
    report["rigs"].push_back(RigMeasurementJson(row));
    num_refused += !row.rig;
  }
  if (!options.report.empty()) {
    PLEAT_RETURN_IF_ERROR(WriteFile(options.report, JsonText(report)));
  }
  if (!options.output.empty() && rows[0].rig) {
    const UserRig rig{rows[0].rig->skeleton,
                      rows[0].rig->weights,
                      options.measurement.first_frame + rows[0].summary.rest_frame,
                      {}};
    PLEAT_RETURN_IF_ERROR(WriteFile(options.output, EncodeRig(rig) + "\n"));
  }
  if (session.json) {
    *session.out << JsonText(report);
  } else {
    PrintText(rows, *session.out);
  }
  if (num_refused == 0) {
    size_t num_warnings = 0;
    for (const RigMeasurement& row : rows) num_warnings += row.summary.warnings.size();
    return RefuseWarningsWhenStrict(session, num_warnings);
  }
  if (rows.size() == 1) return rows[0].status;
  return absl::FailedPreconditionError(
      absl::StrCat(num_refused, " of ", rows.size(), " inputs were refused"));
}

}  // namespace

void AddRigVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<RigVerbOptions>();
  CLI::App* verb =
      AddVerb(app, session, "rig", "find the skeleton of each input and say how well it fits",
              [options, &session] { return RunRig(*options, session); });
  verb->add_option("INPUT", options->inputs, "sequences or single meshes, one row each")
      ->required();
  verb->add_option("--report", options->report, "JSON report (pleat.rig/1)");
  verb->add_option("-o,--output", options->output,
                   "of one INPUT: the rig as a file that `train --rig` takes");
  verb->add_option("--truth", options->truths,
                   "known joints, one JSON file per input ('-' = none) [<stem>_truth.json or "
                   "truth.json beside the input]");
  verb->add_option("--first-frame", options->measurement.first_frame, "leave out earlier frames")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  verb->add_option("--rest-frame", options->measurement.rig.rest_frame, "frame to rig; -1 finds it")
      ->capture_default_str();
  verb->add_option("--yaw", options->measurement.rig.yaw_degrees,
                   "facing about +y from +z, degrees [found]");
  verb->add_option("--at", options->placed, TextOfOption("placed_joints").help);
  verb->add_flag("--no-fit", options->no_fit, "only the rig: no pose fit, no refinement");
  verb->add_option("--threads", options->measurement.rig.num_threads,
                   "0 = one per core; the result does not depend on it")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb->add_option("--fps", options->fps, "frames per second, where the inputs do not say");
  AddObjectFlag(verb, session);
  AddForceFlag(verb, session);
  AddInProcessFlag(verb, session);
}

}  // namespace pleat
