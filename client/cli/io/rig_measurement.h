// One row of the table of `pleat rig`: a rig and how good it is.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "cli/io/joint_truth.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_report.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/rigging/auto_rig.h"

namespace pleat {

struct RigMeasurementOptions {
  AutoRigOptions rig;
  int first_frame = 0;  // earlier frames are left out
  bool fit = true;      // measure the pose fit of sequences of two frames or more
};

struct RigMeasurement {
  std::string input;
  int num_frames = 0, num_vertices = 0;
  double diagonal_m = 0;  // of the first frame used
  double height_m = 0;    // extent of that frame along y
  MeshReport mesh;        // of the first frame used
  // What went wrong where there is no rig; OK otherwise.
  absl::Status status;
  std::optional<Rig> rig;
  AutoRigSummary summary;
  std::optional<JointErrors> joint_errors;     // where the truth is known
  std::optional<double> fit_rms_percent;       // of the diagonal, with the rig as it was found
  std::optional<double> refined_rms_percent;   // the same with the refined rig
  std::optional<double> refined_joint_mean_m;  // mean joint error of the refined rig
  double rig_cpu_seconds = 0;                  // of all threads
  double rig_seconds = 0, fit_seconds = 0, refine_seconds = 0;  // wall time
};

// Rigs `sequence` and measures the result. A refusal is a row like any other (`status`); the call
// itself fails only when it is cancelled, an option is out of range or `truth` (may be null) does
// not fit.
absl::StatusOr<RigMeasurement> MeasureRig(const std::string& input, const MeshSequence& sequence,
                                          const JointTruth* truth,
                                          const RigMeasurementOptions& options,
                                          const Progress& progress = {});

nlohmann::ordered_json RigMeasurementJson(const RigMeasurement& measurement);

}  // namespace pleat
