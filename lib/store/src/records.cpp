#include "pleat/store/records.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/check_count.h"
#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "record_messages.h"

namespace pleat {

store::v1::FrameRate ToRecord(const FrameRate& frame_rate) {
  store::v1::FrameRate message;
  message.set_numerator(frame_rate.numerator);
  message.set_denominator(frame_rate.denominator);
  return message;
}

absl::StatusOr<FrameRate> FromRecord(const store::v1::FrameRate& message) {
  if (message.numerator() <= 0 || message.denominator() <= 0) {
    return absl::InvalidArgumentError(absl::StrCat("frame_rate ", message.numerator(), "/",
                                                   message.denominator(), " is not positive"));
  }
  return FrameRate{message.numerator(), message.denominator()};
}

store::v1::Skeleton ToRecord(const Skeleton& skeleton) {
  store::v1::Skeleton message;
  for (const Joint& joint : skeleton.joints()) {
    store::v1::Joint* out = message.add_joints();
    out->set_name(ToValidUtf8(joint.name));
    out->set_parent(joint.parent);
    store::v1::Vector3* position = out->mutable_rest_position();
    position->set_x(joint.rest_position.x());
    position->set_y(joint.rest_position.y());
    position->set_z(joint.rest_position.z());
  }
  return message;
}

absl::StatusOr<Skeleton> FromRecord(const store::v1::Skeleton& message) {
  std::vector<Joint> joints;
  for (const store::v1::Joint& joint : message.joints()) {
    const store::v1::Vector3& position = joint.rest_position();
    joints.push_back({joint.name(), joint.parent(), {position.x(), position.y(), position.z()}});
  }
  return Skeleton::Create(std::move(joints));
}

// --- sequences, compressed or not ---

namespace {

template <typename Message, typename Info>
void ClipToRecord(const Info& info, Message* message) {
  message->set_id(info.id);
  message->set_name(ToValidUtf8(info.name));
  message->set_num_frames(info.num_frames);
  message->set_num_vertices(info.num_vertices);
  message->set_num_faces(info.num_faces);
  *message->mutable_frame_rate() = ToRecord(info.frame_rate);
  message->set_size_bytes(info.size_bytes);
}

template <typename Message, typename Info>
absl::Status ClipFromRecord(const Message& message, Info* info) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(message.id(), "id"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_frames(), "num_frames"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_vertices(), "num_vertices"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_faces(), "num_faces"));
  info->id = message.id();
  info->name = message.name();
  info->num_frames = message.num_frames();
  info->num_vertices = message.num_vertices();
  info->num_faces = message.num_faces();
  PLEAT_ASSIGN_OR_RETURN(info->frame_rate, FromRecord(message.frame_rate()));
  info->size_bytes = message.size_bytes();
  return absl::OkStatus();
}

}  // namespace

store::v1::Sequence ToRecord(const SequenceInfo& info) {
  store::v1::Sequence message;
  ClipToRecord(info, &message);
  return message;
}

store::v1::CompressedSequence ToRecord(const CompressedSequenceInfo& info) {
  store::v1::CompressedSequence message;
  ClipToRecord(info, &message);
  if (info.record) *message.mutable_record() = ToRecord(*info.record);
  return message;
}

absl::StatusOr<SequenceInfo> FromRecord(const store::v1::Sequence& message) {
  SequenceInfo info;
  PLEAT_RETURN_IF_ERROR(ClipFromRecord(message, &info));
  return info;
}

absl::StatusOr<CompressedSequenceInfo> FromRecord(const store::v1::CompressedSequence& message) {
  CompressedSequenceInfo info;
  PLEAT_RETURN_IF_ERROR(ClipFromRecord(message, &info));
  if (message.has_record()) {
    PLEAT_ASSIGN_OR_RETURN(info.record, FromRecord(message.record()));
  }
  return info;
}

// --- models ---

store::v1::Model ToRecord(const ModelInfo& info) {
  store::v1::Model message;
  message.set_id(info.id);
  message.set_name(ToValidUtf8(info.name));
  *message.mutable_skeleton() = ToRecord(info.skeleton);
  *message.mutable_frame_rate() = ToRecord(info.frame_rate);
  message.set_num_vertices(info.num_vertices);
  message.set_num_faces(info.num_faces);
  message.set_num_control_vertices(info.num_control_vertices);
  message.set_num_components(info.num_components);
  message.set_size_bytes(info.size_bytes);
  message.set_memory_bytes(info.memory_bytes);
  *message.mutable_options() = ToRecord(info.options);
  *message.mutable_record() = ToRecord(info.record);
  return message;
}

absl::StatusOr<ModelInfo> FromRecord(const store::v1::Model& message) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(message.id(), "id"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_vertices(), "num_vertices"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_faces(), "num_faces"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_control_vertices(), "num_control_vertices"));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_components(), "num_components"));
  ModelInfo info;
  info.id = message.id();
  info.name = message.name();
  PLEAT_ASSIGN_OR_RETURN(info.skeleton, FromRecord(message.skeleton()));
  PLEAT_ASSIGN_OR_RETURN(info.frame_rate, FromRecord(message.frame_rate()));
  info.num_vertices = message.num_vertices();
  info.num_faces = message.num_faces();
  info.num_control_vertices = message.num_control_vertices();
  info.num_components = message.num_components();
  info.size_bytes = message.size_bytes();
  info.memory_bytes = message.memory_bytes();
  PLEAT_ASSIGN_OR_RETURN(info.options, FromRecord(message.options()));
  info.record = FromRecord(message.record());
  return info;
}

// --- jobs ---

namespace {

constexpr std::pair<JobState, store::v1::JobState> kJobStates[] = {
    {JobState::kQueued, store::v1::JOB_STATE_QUEUED},
    {JobState::kRunning, store::v1::JOB_STATE_RUNNING},
    {JobState::kSucceeded, store::v1::JOB_STATE_SUCCEEDED},
    {JobState::kFailed, store::v1::JOB_STATE_FAILED},
    {JobState::kCancelled, store::v1::JOB_STATE_CANCELLED}};

store::v1::JobState StateToRecord(JobState state) {
  for (const auto& [value, stored] : kJobStates) {
    if (value == state) return stored;
  }
  return store::v1::JOB_STATE_UNSPECIFIED;
}

absl::StatusOr<JobState> StateFromRecord(store::v1::JobState state) {
  for (const auto& [value, stored] : kJobStates) {
    if (stored == state) return value;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("state is ", static_cast<int>(state), ", which is unknown"));
}

absl::Status CheckJobId(const std::string& id, absl::string_view field) {
  if (!id.empty() && id.size() <= kContentIdLength) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(field, " must have 1 to 64 bytes"));
}

absl::Status CheckJob(const store::v1::Job& message) {
  PLEAT_RETURN_IF_ERROR(CheckJobId(message.id(), "id"));
  if (!(message.fraction() >= 0 && message.fraction() <= 1)) {  // written so that a NaN fails
    return absl::InvalidArgumentError(
        absl::StrCat("fraction is ", message.fraction(), ", not 0 to 1"));
  }
  for (const std::string& id : message.sequence_ids()) {
    PLEAT_RETURN_IF_ERROR(CheckContentId(id, "sequence_ids"));
  }
  if (!message.result_id().empty()) {
    PLEAT_RETURN_IF_ERROR(CheckContentId(message.result_id(), "result_id"));
  }
  if (message.rig_id().empty()) return absl::OkStatus();
  return CheckContentId(message.rig_id(), "rig_id");
}

// An unknown or missing code must not turn an error into success.
absl::Status ErrorFromRecord(const store::v1::JobError& message) {
  const bool known = message.code() >= 1 && message.code() <= 16;
  return absl::Status(
      known ? static_cast<absl::StatusCode>(message.code()) : absl::StatusCode::kUnknown,
      message.message());
}

}  // namespace

store::v1::Job ToRecord(const JobInfo& info) {
  store::v1::Job message;
  message.set_id(info.id);
  message.set_state(StateToRecord(info.state));
  for (const std::string& id : info.sequence_ids) message.add_sequence_ids(id);
  if (const auto* training = std::get_if<TrainOptions>(&info.options)) {
    *message.mutable_training() = ToRecord(*training);
  } else {
    *message.mutable_compression() = ToRecord(std::get<CompressOptions>(info.options));
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
  message.set_request_id(info.request_id);
  message.set_client(info.client);
  if (info.created) message.set_created_unix_ms(absl::ToUnixMillis(*info.created));
  if (info.started) message.set_started_unix_ms(absl::ToUnixMillis(*info.started));
  if (info.ended) message.set_ended_unix_ms(absl::ToUnixMillis(*info.ended));
  if (info.result_ttl != kKeepForEver) {
    message.set_result_ttl_ms(absl::ToInt64Milliseconds(info.result_ttl));
  }
  return message;
}

absl::StatusOr<JobInfo> FromRecord(const store::v1::Job& message) {
  PLEAT_RETURN_IF_ERROR(CheckJob(message));
  JobInfo info;
  info.id = message.id();
  PLEAT_ASSIGN_OR_RETURN(info.state, StateFromRecord(message.state()));
  info.sequence_ids.assign(message.sequence_ids().begin(), message.sequence_ids().end());
  if (message.has_compression()) {
    PLEAT_ASSIGN_OR_RETURN(info.options, FromRecord(message.compression()));
  } else {
    PLEAT_ASSIGN_OR_RETURN(info.options, FromRecord(message.training()));
  }
  info.name = message.name();
  info.stage = message.stage();
  info.fraction = message.fraction();
  if (message.has_objective()) info.objective = message.objective();
  if (message.has_eta_seconds()) info.eta_seconds = message.eta_seconds();
  info.warnings.assign(message.warnings().begin(), message.warnings().end());
  if (message.has_error()) info.error = ErrorFromRecord(message.error());
  info.result_id = message.result_id();
  info.rig_id = message.rig_id();
  info.request_id = message.request_id();
  info.client = message.client();
  if (message.has_created_unix_ms()) info.created = absl::FromUnixMillis(message.created_unix_ms());
  if (message.has_started_unix_ms()) info.started = absl::FromUnixMillis(message.started_unix_ms());
  if (message.has_ended_unix_ms()) info.ended = absl::FromUnixMillis(message.ended_unix_ms());
  if (message.has_result_ttl_ms()) info.result_ttl = absl::Milliseconds(message.result_ttl_ms());
  return info;
}

store::v1::Checkpoint ToRecord(const CheckpointInfo& info) {
  store::v1::Checkpoint message;
  message.set_job_id(info.job_id);
  return message;
}

absl::StatusOr<CheckpointInfo> FromRecord(const store::v1::Checkpoint& message) {
  PLEAT_RETURN_IF_ERROR(CheckJobId(message.job_id(), "job_id"));
  return CheckpointInfo{.job_id = message.job_id()};
}

// --- bytes ---

namespace {

// Deterministic: the entries of a map come in order, so equal content gives equal bytes.
std::string Serialize(const google::protobuf::MessageLite& message) {
  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  {
    google::protobuf::io::CodedOutputStream output(&stream);
    output.SetSerializationDeterministic(true);
    message.SerializeToCodedStream(&output);
  }
  return bytes;
}

template <typename Message>
auto Parse(const std::string& bytes, absl::string_view what)
    -> decltype(FromRecord(std::declval<Message>())) {
  Message message;
  if (!message.ParseFromString(bytes)) {
    return absl::DataLossError(absl::StrCat("a stored ", what, " record cannot be parsed"));
  }
  auto info = FromRecord(message);
  if (!info.ok()) {
    return absl::DataLossError(absl::StrCat(
        "a stored ", what, " record is wrong: ", absl::string_view(info.status().message())));
  }
  return info;
}

}  // namespace

std::string EncodeRecord(const SequenceInfo& info) { return Serialize(ToRecord(info)); }
std::string EncodeRecord(const JobInfo& info) { return Serialize(ToRecord(info)); }
std::string EncodeRecord(const ModelInfo& info) { return Serialize(ToRecord(info)); }
std::string EncodeRecord(const CompressedSequenceInfo& info) { return Serialize(ToRecord(info)); }
std::string EncodeRecord(const CheckpointInfo& info) { return Serialize(ToRecord(info)); }

absl::StatusOr<SequenceInfo> DecodeSequenceRecord(const std::string& bytes) {
  return Parse<store::v1::Sequence>(bytes, "sequence");
}
absl::StatusOr<JobInfo> DecodeJobRecord(const std::string& bytes) {
  return Parse<store::v1::Job>(bytes, "job");
}
absl::StatusOr<ModelInfo> DecodeModelRecord(const std::string& bytes) {
  return Parse<store::v1::Model>(bytes, "model");
}
absl::StatusOr<CompressedSequenceInfo> DecodeCompressedSequenceRecord(const std::string& bytes) {
  return Parse<store::v1::CompressedSequence>(bytes, "compressed sequence");
}
absl::StatusOr<CheckpointInfo> DecodeCheckpointRecord(const std::string& bytes) {
  return Parse<store::v1::Checkpoint>(bytes, "checkpoint");
}

}  // namespace pleat
