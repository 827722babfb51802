#include "cli/show/report_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <vector>

namespace pleat {
namespace {

using nlohmann::ordered_json;

ordered_json ErrorsJson(const std::map<std::string, ErrorSummary>& errors,
                        ordered_json (*to_json)(const ErrorSummary&)) {
  ordered_json json = ordered_json::object();
  for (const auto& [name, error] : errors) json[name] = to_json(error);
  return json;
}

// Returns all bones, each named by its joint, with the largest error first.
ordered_json WorstJointsJson(const Skeleton& skeleton, const std::vector<double>& percent) {
  std::vector<int> order;  // stays empty for models of older files
  for (int j = 1; j < std::min<int>(skeleton.num_joints(), static_cast<int>(percent.size())); ++j) {
    order.push_back(j);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return percent[a] > percent[b]; });
  ordered_json joints = ordered_json::array();
  for (const int j : order) {
    joints.push_back({{"name", skeleton.joint(j).name}, {"mean_percent", percent[j]}});
  }
  return joints;
}

}  // namespace

ordered_json JointsJson(const Skeleton& skeleton) {
  ordered_json joints = ordered_json::array();
  for (const Joint& joint : skeleton.joints()) {
    const Eigen::Vector3d& p = joint.rest_position;
    joints.push_back(
        {{"name", joint.name}, {"parent", joint.parent}, {"position_m", {p.x(), p.y(), p.z()}}});
  }
  return joints;
}

ordered_json ErrorJson(const ErrorSummary& error) {
  return {{"mean_percent", error.mean_percent},
          {"rms_percent", error.rms_percent},
          {"p95_percent", error.p95_percent},
          {"max_percent", error.max_percent},
          {"mean_mm", error.mean_mm}};
}

ordered_json MotionJson(const ErrorSummary& error) {
  const auto measured = [](int count, double value) {
    return count > 0 ? ordered_json(value) : ordered_json(nullptr);
  };
  return {{"num_frames", error.num_motion_frames},
          {"mean_percent", measured(error.num_motion_frames, error.motion_mean_percent)},
          {"mean_mm", measured(error.num_motion_frames, error.motion_mean_mm)},
          {"jitter_mm", measured(error.num_jitter_frames, error.jitter_mm)},
          {"truth_jitter_mm", measured(error.num_jitter_frames, error.truth_jitter_mm)}};
}

ordered_json ValidationJson(const LearnerValidation& validation) {
  if (validation.num_held_out_frames == 0) return nullptr;
  return {{"num_held_out_frames", validation.num_held_out_frames},
          {"mean_percent", validation.mean_percent}};
}

ordered_json OptionsJson(const TrainOptions& options) {
  ordered_json json;
  VisitTrainOptions(options, [&json](const char* name, const auto& value) {
    if constexpr (std::is_enum_v<std::decay_t<decltype(value)>>) {
      json[name] = ChoiceName(value);
    } else if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::vector<PlacedJoint>>) {
      json[name] = FormatPlacedJoints(value);
    } else {
      json[name] = value;
    }
  });
  return json;
}

ordered_json OptionsJson(const CompressOptions& options) {
  ordered_json json = {{"any_face_order", !options.keep_face_order}};
  switch (options.goal) {
    case CompressionGoal::kMaxError:
      json["max_error_mm"] = options.max_error_mm;
      break;
    case CompressionGoal::kKg:
      json["kg_percent"] = options.kg_percent;
      break;
    case CompressionGoal::kGrid:
      json["lossless_at_bits"] = options.grid_bits;
      break;
  }
  return json;
}

ordered_json CompressReportJson(const CompressionRecord& record, int num_frames, int num_vertices) {
  const CompressSummary& summary = record.summary;
  return {{"schema", "pleat.compress/1"},
          {"bytes", summary.num_bytes},
          {"bpvf", summary.bpvf},
          {"kg_percent", summary.kg_percent},
          {"max_error_mm", summary.max_error_mm},
          {"encode_seconds", record.encode_seconds},
          {"decode_seconds", record.decode_seconds},
          {"topology_bytes", summary.num_topology_bytes},
          {"bpvf_without_topology", summary.bpvf_without_topology},
          {"num_frames", num_frames},
          {"num_vertices", num_vertices}};
}

ordered_json TrainReportJson(const CharacterModel& model, const TrainCosts& costs) {
  const TrainingRecord& record = model.record();
  ordered_json json;
  json["schema"] = "pleat.train/1";
  json["rig"] = {{"rest_frame", record.rest_frame},
                 {"yaw_degrees", record.yaw_degrees},
                 {"residual", record.rig_residual},
                 {"joints", JointsJson(model.skeleton())},
                 {"warnings", record.warnings}};
  json["fit"] = ErrorJson(record.fit);
  json["reconstruction"] = ErrorJson(record.reconstruction);
  json["poses"] = {{"jitter_degrees", record.pose_jitter_degrees},
                   {"unsmoothed_jitter_degrees", record.unsmoothed_jitter_degrees},
                   {"unsmoothed_rms_percent", record.unsmoothed_rms_percent}};
  json["worst_frames"] = ordered_json::array();
  for (const FrameError& error : record.worst_frames) {
    json["worst_frames"].push_back(
        {{"clip", error.clip}, {"frame", error.frame}, {"mean_percent", error.mean_percent}});
  }
  json["worst_joints"] = WorstJointsJson(model.skeleton(), record.joint_fit_percent);
  json["learner"] = record.learner;
  json["validation"] = ValidationJson(record.validation);
  json["options"] = OptionsJson(model.options());
  json["num_frames"] = record.num_frames;
  json["num_vertices"] = model.num_vertices();
  json["diagonal_m"] = record.diagonal_m;
  json["seconds"] = costs.seconds;
  json["peak_memory_bytes"] = costs.peak_memory_bytes;
  json["model_bytes"] = costs.model_bytes;
  json["model_id"] = costs.model_id;
  return json;
}

ordered_json EvaluateReportJson(const EvaluateReport& report) {
  ordered_json json;
  json["schema"] = "pleat.evaluate/1";
  json["protocol"] = report.protocol;
  json["diagonal_m"] = report.diagonal_m;
  json["learner"] = report.learner;
  json["validation"] = ValidationJson(report.validation);
  json["skinned"] = ErrorJson(report.skinned);
  json["hybrid"] = ErrorJson(report.hybrid);
  json["baselines"] = ErrorsJson(report.baselines, ErrorJson);
  json["learners"] = ErrorsJson(report.learners, ErrorJson);
  json["seconds"] = report.seconds;
  json["num_train_frames"] = report.num_train_frames;
  json["num_test_frames"] = report.num_test_frames;
  json["test_frames"] = report.test_frames;
  json["frame_mean_percent"] = {{"skinned", report.skinned.frame_mean_percent},
                                {"hybrid", report.hybrid.frame_mean_percent}};
  json["motion_mean_percent"] = {{"skinned", report.skinned.motion_mean_percent},
                                 {"hybrid", report.hybrid.motion_mean_percent}};
  json["motion"] = {{"skinned", MotionJson(report.skinned)},
                    {"hybrid", MotionJson(report.hybrid)},
                    {"baselines", ErrorsJson(report.baselines, MotionJson)},
                    {"learners", ErrorsJson(report.learners, MotionJson)}};
  json["options"] = OptionsJson(report.options);
  return json;
}

}  // namespace pleat
