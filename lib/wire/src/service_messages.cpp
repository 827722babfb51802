#include "pleat/wire/service_messages.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "clip_info.h"
#include "pleat/base/check_count.h"
#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/training_messages.h"
#include "timestamps.h"

namespace pleat {
v1::Sequence ToProto(const SequenceInfo& info) {
  v1::Sequence message;
  ClipInfoToProto(info, &message);
  return message;
}

absl::StatusOr<SequenceInfo> FromProto(const v1::Sequence& message) {
  SequenceInfo info;
  PLEAT_RETURN_IF_ERROR(ClipInfoFromProto(message, "sequence", &info));
  return info;
}

v1::JobState ToProto(JobState state) {
  switch (state) {
    case JobState::kQueued:
      return v1::JOB_STATE_QUEUED;
    case JobState::kRunning:
      return v1::JOB_STATE_RUNNING;
    case JobState::kSucceeded:
      return v1::JOB_STATE_SUCCEEDED;
    case JobState::kFailed:
      return v1::JOB_STATE_FAILED;
    case JobState::kCancelled:
      return v1::JOB_STATE_CANCELLED;
  }
  return v1::JOB_STATE_UNSPECIFIED;
}

absl::StatusOr<JobState> FromProto(v1::JobState state) {
  switch (state) {
    case v1::JOB_STATE_QUEUED:
      return JobState::kQueued;
    case v1::JOB_STATE_RUNNING:
      return JobState::kRunning;
    case v1::JOB_STATE_SUCCEEDED:
      return JobState::kSucceeded;
    case v1::JOB_STATE_FAILED:
      return JobState::kFailed;
    case v1::JOB_STATE_CANCELLED:
      return JobState::kCancelled;
    default:
      return absl::InvalidArgumentError(
          absl::StrCat("job.state is ", static_cast<int>(state), ", which is unknown"));
  }
}

v1::Job ToProto(const JobInfo& info) {
  v1::Job message;
  message.set_id(info.id);
  message.set_state(ToProto(info.state));
  for (const std::string& id : info.sequence_ids) message.add_sequence_ids(id);
  if (const auto* training = std::get_if<TrainOptions>(&info.options)) {
    *message.mutable_training() = ToProto(*training);
  } else {
    *message.mutable_compression() = ToProto(std::get<CompressOptions>(info.options));
  }
  message.set_name(ToValidUtf8(info.name));
  message.set_stage(ToValidUtf8(info.stage));
  message.set_fraction(info.fraction);
  if (info.objective) message.set_objective(*info.objective);
  if (info.eta_seconds) message.set_eta_seconds(*info.eta_seconds);
  for (const std::string& warning : info.warnings) message.add_warnings(ToValidUtf8(warning));
  if (!info.error.ok()) {
    message.mutable_error()->set_code(static_cast<int>(info.error.code()));
    message.mutable_error()->set_message(ToValidUtf8(std::string(info.error.message())));
  }
  message.set_result_id(info.result_id);
  message.set_rig_id(info.rig_id);
  if (info.created) *message.mutable_created() = ToProto(*info.created);
  if (info.started) *message.mutable_started() = ToProto(*info.started);
  if (info.ended) *message.mutable_ended() = ToProto(*info.ended);
  message.set_result_ttl_seconds(TtlToSeconds(info.result_ttl));
  return message;
}

namespace {

absl::Status TimesFromProto(const v1::Job& message, JobInfo* info) {
  if (message.has_created()) {
    PLEAT_ASSIGN_OR_RETURN(info->created, FromProto(message.created(), "job.created"));
  }
  if (message.has_started()) {
    PLEAT_ASSIGN_OR_RETURN(info->started, FromProto(message.started(), "job.started"));
  }
  if (message.has_ended()) {
    PLEAT_ASSIGN_OR_RETURN(info->ended, FromProto(message.ended(), "job.ended"));
  }
  PLEAT_ASSIGN_OR_RETURN(info->result_ttl,
                         TtlFromSeconds(message.result_ttl_seconds(), "job.result_ttl_seconds"));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<JobInfo> FromProto(const v1::Job& message) {
  if (message.id().empty() || message.id().size() > kContentIdLength) {
    return absl::InvalidArgumentError("job.id must have 1 to 64 bytes");
  }
  if (!(message.fraction() >= 0 && message.fraction() <= 1)) {
    return absl::InvalidArgumentError(
        absl::StrCat("job.fraction is ", message.fraction(), ", not 0 to 1"));
  }
  JobInfo info;
  info.id = message.id();
  PLEAT_ASSIGN_OR_RETURN(info.state, FromProto(message.state()));
  info.sequence_ids.assign(message.sequence_ids().begin(), message.sequence_ids().end());
  for (const std::string& id : info.sequence_ids) {
    PLEAT_RETURN_IF_ERROR(CheckContentId(id, "job.sequence_ids"));
  }
  if (message.has_compression()) {
    PLEAT_ASSIGN_OR_RETURN(info.options, FromProto(message.compression()));
  } else {
    PLEAT_ASSIGN_OR_RETURN(info.options, FromProto(message.training()));
  }
  info.name = message.name();
  info.stage = message.stage();
  info.fraction = message.fraction();
  if (message.has_objective()) info.objective = message.objective();
  if (message.has_eta_seconds()) info.eta_seconds = message.eta_seconds();
  info.warnings.assign(message.warnings().begin(), message.warnings().end());
  if (message.has_error()) {
    const int code = message.error().code();
    // An unknown or missing code must not turn an error into success.
    const bool known = code >= 1 && code <= 16;
    info.error =
        absl::Status(known ? static_cast<absl::StatusCode>(code) : absl::StatusCode::kUnknown,
                     message.error().message());
  }
  info.result_id = message.result_id();
  if (!info.result_id.empty()) {
    PLEAT_RETURN_IF_ERROR(CheckContentId(info.result_id, "job.result_id"));
  }
  info.rig_id = message.rig_id();
  if (!info.rig_id.empty()) PLEAT_RETURN_IF_ERROR(CheckContentId(info.rig_id, "job.rig_id"));
  PLEAT_RETURN_IF_ERROR(TimesFromProto(message, &info));
  return info;
}

v1::Model ToProto(const ModelInfo& info) {
  v1::Model message;
  message.set_id(info.id);
  message.set_name(ToValidUtf8(info.name));
  *message.mutable_skeleton() = ToProto(info.skeleton);
  *message.mutable_frame_rate() = ToProto(info.frame_rate);
  message.set_num_vertices(info.num_vertices);
  message.set_num_faces(info.num_faces);
  message.set_num_control_vertices(info.num_control_vertices);
  message.set_num_components(info.num_components);
  message.set_size_bytes(info.size_bytes);
  message.set_memory_bytes(info.memory_bytes);
  *message.mutable_options() = ToProto(info.options);
  *message.mutable_record() = ToProto(info.record);
  LifeToProto(info.life, &message);
  return message;
}

absl::StatusOr<ModelInfo> FromProto(const v1::Model& message) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(message.id(), "model.id"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_vertices(), "model.num_vertices"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_faces(), "model.num_faces"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_control_vertices(), "model.num_control_vertices"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_components(), "model.num_components"));
  ModelInfo info;
  info.id = message.id();
  info.name = message.name();
  PLEAT_ASSIGN_OR_RETURN(info.skeleton, FromProto(message.skeleton()));
  PLEAT_ASSIGN_OR_RETURN(info.frame_rate, FromProto(message.frame_rate()));
  info.num_vertices = message.num_vertices();
  info.num_faces = message.num_faces();
  info.num_control_vertices = message.num_control_vertices();
  info.num_components = message.num_components();
  info.size_bytes = message.size_bytes();
  info.memory_bytes = message.memory_bytes();
  PLEAT_ASSIGN_OR_RETURN(info.options, FromProto(message.options()));
  info.record = FromProto(message.record());
  PLEAT_ASSIGN_OR_RETURN(info.life, LifeFromProto(message, "model"));
  return info;
}

}  // namespace pleat
