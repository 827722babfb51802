#include "cli/show/info_json.h"

#include <nlohmann/json.hpp>

#include "cli/show/report_json.h"
#include "cli/show/time_text.h"

namespace pleat {

using nlohmann::ordered_json;

namespace {

// What stored sequences and compressed ones say alike.
template <typename Info>
ordered_json StoredMeshesJson(const Info& info) {
  return {{"id", info.id},
          {"name", info.name},
          {"num_frames", info.num_frames},
          {"num_vertices", info.num_vertices},
          {"num_faces", info.num_faces},
          {"fps", info.frame_rate.fps()},
          {"size_bytes", info.size_bytes}};
}

void AddTime(const char* name, const std::optional<absl::Time>& time, ordered_json* json) {
  if (time) (*json)[name] = TimeForJson(*time);
}

void AddLife(const EntryLife& life, ordered_json* json) {
  AddTime("created", life.created, json);
  AddTime("expires", life.expires, json);
  if (life.pinned) (*json)["pinned"] = true;
}

}  // namespace

ordered_json SequenceJson(const SequenceInfo& info) {
  ordered_json json = StoredMeshesJson(info);
  AddLife(info.life, &json);
  return json;
}

const char* JobKindName(const JobInfo& info) {
  return std::holds_alternative<TrainOptions>(info.options) ? "training" : "compression";
}

ordered_json JobJson(const JobInfo& info) {
  ordered_json json = {
      {"id", info.id},
      {"state", JobStateName(info.state)},
      {"sequence_ids", info.sequence_ids},
      {"kind", JobKindName(info)},
      {"name", info.name},
      {"stage", info.stage},
      {"fraction", info.fraction},
      {"warnings", info.warnings},
      {"options",
       std::visit([](const auto& options) { return OptionsJson(options); }, info.options)}};
  if (info.objective) json["objective"] = *info.objective;
  if (info.eta_seconds) json["eta_seconds"] = *info.eta_seconds;
  if (!info.error.ok()) {
    json["error"] = {{"code", absl::StatusCodeToString(info.error.code())},
                     {"message", std::string(info.error.message())}};
  }
  if (!info.result_id.empty()) json["result_id"] = info.result_id;
  if (!info.rig_id.empty()) json["rig_id"] = info.rig_id;
  AddTime("created", info.created, &json);
  AddTime("started", info.started, &json);
  AddTime("ended", info.ended, &json);
  if (info.result_ttl != kKeepForEver) {
    json["result_ttl_seconds"] = absl::ToDoubleSeconds(info.result_ttl);
  }
  return json;
}

ordered_json ModelJson(const ModelInfo& info) {
  ordered_json joints = ordered_json::array();
  for (const Joint& joint : info.skeleton.joints()) {
    const Eigen::Vector3d& p = joint.rest_position;
    joints.push_back(
        {{"name", joint.name}, {"parent", joint.parent}, {"position_m", {p.x(), p.y(), p.z()}}});
  }
  ordered_json json = {{"id", info.id},
                       {"name", info.name},
                       {"learner", info.record.learner},
                       {"fps", info.frame_rate.fps()},
                       {"num_vertices", info.num_vertices},
                       {"num_faces", info.num_faces},
                       {"num_control_vertices", info.num_control_vertices},
                       {"num_components", info.num_components},
                       {"num_training_frames", info.record.num_frames},
                       {"size_bytes", info.size_bytes},
                       {"memory_bytes", info.memory_bytes},
                       {"diagonal_m", info.record.diagonal_m},
                       {"fit", ErrorJson(info.record.fit)},
                       {"reconstruction", ErrorJson(info.record.reconstruction)},
                       {"joints", joints},
                       {"warnings", info.record.warnings},
                       {"options", OptionsJson(info.options)}};
  AddLife(info.life, &json);
  return json;
}

ordered_json CompressedSequenceJson(const CompressedSequenceInfo& info) {
  ordered_json json = StoredMeshesJson(info);
  AddLife(info.life, &json);
  if (info.record) {
    json["sequence_id"] = info.record->sequence_id;
    json["options"] = OptionsJson(info.record->options);
    json["report"] = CompressReportJson(*info.record, info.num_frames, info.num_vertices);
  }
  return json;
}

}  // namespace pleat
