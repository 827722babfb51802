#include "cli/io/rig_measurement.h"

#include <ctime>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/session.h"
#include "cli/show/input_notes_json.h"
#include "cli/show/mesh_report_json.h"
#include "cli/show/report_json.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/character/train_options.h"
#include "pleat/fitting/pose_fit.h"
#include "pleat/fitting/rig_refinement.h"
#include "pleat/mesh/bounds.h"

namespace pleat {
namespace {

// Returns the options with which training fits poses by default.
PoseFitOptions FitOptions(const RigMeasurementOptions& options) {
  PoseFitOptions fit;
  fit.bend_stiffness = TrainOptions().bend_stiffness;
  fit.num_threads = options.rig.num_threads;
  return fit;
}

// Returns the joints of `rig` in frame `frame` of `sequence`, 3 x J, meters.
absl::StatusOr<Eigen::Matrix3Xd> JointsInFrame(const MeshSequence& sequence, const Rig& rig,
                                               int frame, const PoseFitOptions& options) {
  PLEAT_ASSIGN_OR_RETURN(const PoseTrack track,
                         FitPoses(sequence.Subset({frame}), rig, options, nullptr));
  BoneTransforms transforms;
  ComputeBoneTransforms(rig.skeleton, track.pose(0), {}, &transforms);
  return transforms.joint_positions;
}

// Scores the rig in the frame of the truth, which counts from the start of the whole sequence.
absl::StatusOr<JointErrors> ScoreJoints(const MeshSequence& sequence, const Rig& rig,
                                        const JointTruth& truth,
                                        const RigMeasurementOptions& options, int rest_frame) {
  if (truth.frame >= sequence.num_frames()) {
    return absl::InvalidArgumentError(absl::StrCat("joint truth: frame ", truth.frame, " of ",
                                                   sequence.name(), ", which has ",
                                                   sequence.num_frames(), " frames"));
  }
  Eigen::Matrix3Xd joints = rig.skeleton.RestPositions();
  if (truth.frame != rest_frame) {
    PLEAT_ASSIGN_OR_RETURN(joints, JointsInFrame(sequence, rig, truth.frame, FitOptions(options)));
  }
  return CompareJoints(truth, rig.skeleton, joints);
}

absl::Status MeasureFit(const MeshSequence& sequence, const MeshSequence& used,
                        const JointTruth* truth, const RigMeasurementOptions& options,
                        RigMeasurement* measurement, const Progress& progress) {
  const double percent = 100 / measurement->diagonal_m;
  PoseFitSummary fit;
  double start = MonotonicSeconds();
  PLEAT_ASSIGN_OR_RETURN(
      const PoseTrack track,
      FitPoses(used, *measurement->rig, FitOptions(options), &fit, progress.Stage("fit", 0, .3)));
  measurement->fit_seconds = MonotonicSeconds() - start;
  measurement->fit_rms_percent = fit.rms_m * percent;

  RigRefinementOptions refinement;  // refines everything, as --refine full does in training
  refinement.bend_stiffness = TrainOptions().bend_stiffness;
  refinement.num_threads = options.rig.num_threads;
  start = MonotonicSeconds();
  PLEAT_ASSIGN_OR_RETURN(const Rig refined, RefineRig(used, *measurement->rig, track, refinement,
                                                      nullptr, progress.Stage("refine", .3, .8)));
  measurement->refine_seconds = MonotonicSeconds() - start;
  PLEAT_RETURN_IF_ERROR(
      FitPoses(used, refined, FitOptions(options), &fit, progress.Stage("fit", .8, 1)).status());
  measurement->refined_rms_percent = fit.rms_m * percent;
  if (truth != nullptr) {
    PLEAT_ASSIGN_OR_RETURN(const JointErrors errors,
                           ScoreJoints(sequence, refined, *truth, options,
                                       options.first_frame + measurement->summary.rest_frame));
    measurement->refined_joint_mean_m = errors.mean_m;
  }
  return absl::OkStatus();
}

nlohmann::ordered_json FacingsJson(const AutoRigSummary& summary) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const FacingResidual& facing : summary.facings) {
    json.push_back({{"yaw_degrees", facing.yaw_degrees},
                    {"residual", facing.residual},
                    {"is_lower_bound", facing.is_lower_bound}});
  }
  return json;
}

}  // namespace

absl::StatusOr<RigMeasurement> MeasureRig(const std::string& input, const MeshSequence& sequence,
                                          const JointTruth* truth,
                                          const RigMeasurementOptions& options,
                                          const Progress& progress) {
  if (options.first_frame < 0 || options.first_frame >= sequence.num_frames()) {
    return UsageError(absl::StrCat("--first-frame ", options.first_frame, ": ", sequence.name(),
                                   " has ", sequence.num_frames(), " frames"));
  }
  std::vector<int> frames(sequence.num_frames() - options.first_frame);
  std::iota(frames.begin(), frames.end(), options.first_frame);
  const MeshSequence used = sequence.Subset(frames);

  RigMeasurement measurement;
  measurement.input = input;
  measurement.num_frames = used.num_frames();
  measurement.num_vertices = used.num_vertices();
  const Eigen::Matrix3Xd first = used.FrameAsDouble(0);
  measurement.diagonal_m = BoundsDiagonal(first);
  measurement.height_m = ComputeBounds(first).sizes().y();
  measurement.mesh = InspectMesh(used.topology(), first);

  const bool does_fit = options.fit && used.num_frames() > 1;
  const double rig_share = does_fit ? .25 : 1;
  const double start = MonotonicSeconds();
  const std::clock_t cpu_start = std::clock();
  absl::StatusOr<Rig> rig =
      AutoRig(used, options.rig, &measurement.summary, progress.Stage("rig", 0, rig_share));
  measurement.rig_seconds = MonotonicSeconds() - start;
  measurement.rig_cpu_seconds = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  if (absl::IsCancelled(rig.status())) return rig.status();
  measurement.status = rig.status();
  if (!rig.ok()) return measurement;
  measurement.rig = *std::move(rig);
  if (truth != nullptr) {
    PLEAT_ASSIGN_OR_RETURN(measurement.joint_errors,
                           ScoreJoints(sequence, *measurement.rig, *truth, options,
                                       options.first_frame + measurement.summary.rest_frame));
  }
  if (does_fit) {
    PLEAT_RETURN_IF_ERROR(MeasureFit(sequence, used, truth, options, &measurement,
                                     progress.Stage("fit", rig_share, 1)));
  }
  return measurement;
}

nlohmann::ordered_json RigMeasurementJson(const RigMeasurement& measurement) {
  nlohmann::ordered_json json;
  json["input"] = ToValidUtf8(measurement.input);
  json["input_notes"] = InputNotesJson(measurement.input_notes);
  json["num_frames"] = measurement.num_frames;
  json["num_vertices"] = measurement.num_vertices;
  json["diagonal_m"] = measurement.diagonal_m;
  json["height_m"] = measurement.height_m;
  json["mesh_report"] = MeshReportJson(measurement.mesh);
  json["is_refused"] = !measurement.status.ok();
  json["seconds"]["rig"] = measurement.rig_seconds;
  json["seconds"]["rig_cpu"] = measurement.rig_cpu_seconds;
  if (!measurement.rig) {
    json["message"] = std::string(measurement.status.message());
    return json;
  }
  const AutoRigSummary& summary = measurement.summary;
  json["rest_frame"] = summary.rest_frame;
  json["yaw_degrees"] = summary.yaw_degrees;
  json["up"] = {summary.up.x(), summary.up.y(), summary.up.z()};
  json["residual"] = summary.residual;
  json["evidence"] = {{"feet", summary.evidence.feet},
                      {"knees", summary.evidence.knees},
                      {"is_turned", summary.is_turned_by_evidence}};
  json["num_frames_tried"] = summary.num_frames_tried;
  json["num_spheres"] = summary.num_spheres;
  json["facings"] = FacingsJson(summary);
  json["joints"] = JointsJson(measurement.rig->skeleton);
  json["warnings"] = summary.warnings;
  if (measurement.joint_errors) {
    json["joint_error"]["mean_m"] = measurement.joint_errors->mean_m;
    json["joint_error"]["max_m"] = measurement.joint_errors->max_m;
    for (size_t i = 0; i < measurement.joint_errors->names.size(); ++i) {
      json["joint_error"]["joints_m"][measurement.joint_errors->names[i]] =
          measurement.joint_errors->errors_m[i];
    }
    if (measurement.refined_joint_mean_m) {
      json["joint_error"]["refined_mean_m"] = *measurement.refined_joint_mean_m;
    }
  }
  if (measurement.fit_rms_percent) {
    json["fit"]["rms_percent"] = *measurement.fit_rms_percent;
    json["fit"]["refined_rms_percent"] = *measurement.refined_rms_percent;
    json["seconds"]["fit"] = measurement.fit_seconds;
    json["seconds"]["refine"] = measurement.refine_seconds;
  }
  return json;
}

}  // namespace pleat
