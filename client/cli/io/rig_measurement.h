// One row of the table of `pleat rig`: a rig and how good it is.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/io/joint_truth.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/input_note.h"
#include "pleat/mesh/mesh_report.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/rigging/auto_rig.h"

namespace pleat {

struct RigMeasurementOptions {
  AutoRigOptions rig;
  int first_frame = 0;  // earlier frames are left out
  bool fit = true;      // also measures the pose fit of sequences with two frames or more
};

struct RigMeasurement {
  std::string input;
  std::vector<InputNote> input_notes;  // filled by those who read the input
  int num_frames = 0, num_vertices = 0;
  double diagonal_m = 0;  // bounding-box diagonal of the first frame that is used
  double height_m = 0;    // the extent of that frame along y
  MeshReport mesh;        // the report on that frame
  // What went wrong when there is no rig; OK otherwise.
  absl::Status status;
  std::optional<Rig> rig;
  AutoRigSummary summary;
  std::optional<JointErrors> joint_errors;     // when the truth is known
  std::optional<double> fit_rms_percent;       // % of the diagonal, with the rig as it was found
  std::optional<double> refined_rms_percent;   // the same with the refined rig
  std::optional<double> refined_joint_mean_m;  // the mean joint error of the refined rig
  double rig_cpu_seconds = 0;                  // the processor time of all threads
  double rig_seconds = 0, fit_seconds = 0, refine_seconds = 0;  // wall time
};

// Rigs `sequence` and measures the result. A refusal is a row like any other, with its reason in
// `status`. The call itself fails only when it is cancelled, when an option is out of range, or
// when `truth`, which may be null, does not fit.
absl::StatusOr<RigMeasurement> MeasureRig(const std::string& input, const MeshSequence& sequence,
                                          const JointTruth* truth,
                                          const RigMeasurementOptions& options,
                                          const Progress& progress = {});

nlohmann::ordered_json RigMeasurementJson(const RigMeasurement& measurement);

}  // namespace pleat
