#include "pleat/wire/training_messages.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/wire/skeleton_messages.h"

namespace pleat {

// The message has the fields of TrainOptions under the same names, with choices as strings, so that
// VisitTrainOptions is the list of options on the wire as well. A test compares the two, because
// FindFieldByName returns null for a field that is missing.

v1::TrainOptions ToProto(const TrainOptions& options) {
  v1::TrainOptions message;
  const google::protobuf::Reflection& fields = *message.GetReflection();
  VisitTrainOptions(options, [&](const char* name, const auto& value) {
    using T = std::decay_t<decltype(value)>;
    const auto* field = v1::TrainOptions::descriptor()->FindFieldByName(name);
    if constexpr (std::is_enum_v<T>) {
      fields.SetString(&message, field, ChoiceName(value));
    } else if constexpr (std::is_same_v<T, std::vector<PlacedJoint>>) {
      fields.SetString(&message, field, FormatPlacedJoints(value));
    } else if constexpr (std::is_same_v<T, double>) {
      fields.SetDouble(&message, field, value);
    } else if constexpr (std::is_same_v<T, uint64_t>) {
      fields.SetUInt64(&message, field, value);
    } else {
      fields.SetInt32(&message, field, value);
    }
  });
  return message;
}

absl::StatusOr<TrainOptions> FromProto(const v1::TrainOptions& message) {
  TrainOptions options;
  const google::protobuf::Reflection& fields = *message.GetReflection();
  absl::Status status;
  VisitTrainOptions(options, [&](const char* name, auto& value) {
    using T = std::decay_t<decltype(value)>;
    const auto* field = v1::TrainOptions::descriptor()->FindFieldByName(name);
    if (!fields.HasField(message, field)) return;
    if constexpr (std::is_enum_v<T>) {
      absl::StatusOr<T> choice = ParseChoice<T>(name, fields.GetString(message, field));
      if (choice.ok()) value = *choice;
      status.Update(choice.status());
    } else if constexpr (std::is_same_v<T, std::vector<PlacedJoint>>) {
      absl::StatusOr<T> placed = ParsePlacedJoints(fields.GetString(message, field));
      if (placed.ok()) value = *std::move(placed);
      status.Update(WithContext(absl::StrCat("option ", name), placed.status()));
    } else if constexpr (std::is_same_v<T, double>) {
      value = fields.GetDouble(message, field);
    } else if constexpr (std::is_same_v<T, uint64_t>) {
      value = fields.GetUInt64(message, field);
    } else {
      value = fields.GetInt32(message, field);
    }
  });
  PLEAT_RETURN_IF_ERROR(status);
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(options));
  return options;
}

v1::TrainingRecord ToProto(const TrainingRecord& record) {
  v1::TrainingRecord message;
  message.set_learner(record.learner);
  message.set_num_frames(record.num_frames);
  message.set_rest_frame(record.rest_frame);
  message.set_yaw_degrees(record.yaw_degrees);
  message.set_rig_residual(record.rig_residual);
  message.set_diagonal_m(record.diagonal_m);
  *message.mutable_fit() = ToProto(record.fit);
  *message.mutable_reconstruction() = ToProto(record.reconstruction);
  for (const std::string& warning : record.warnings) message.add_warnings(ToValidUtf8(warning));
  for (const FrameError& error : record.worst_frames) {
    v1::FrameError* out = message.add_worst_frames();
    out->set_clip(error.clip);
    out->set_frame(error.frame);
    out->set_mean_percent(error.mean_percent);
  }
  message.mutable_joint_fit_percent()->Assign(record.joint_fit_percent.begin(),
                                              record.joint_fit_percent.end());
  message.set_pose_jitter_degrees(record.pose_jitter_degrees);
  message.set_unsmoothed_jitter_degrees(record.unsmoothed_jitter_degrees);
  message.set_unsmoothed_rms_percent(record.unsmoothed_rms_percent);
  message.set_num_held_out_frames(record.validation.num_held_out_frames);
  for (const auto& [learner, percent] : record.validation.mean_percent) {
    (*message.mutable_validation_mean_percent())[learner] = percent;
  }
  return message;
}

TrainingRecord FromProto(const v1::TrainingRecord& message) {
  TrainingRecord record;
  record.learner = message.learner();
  record.num_frames = message.num_frames();
  record.rest_frame = message.rest_frame();
  record.yaw_degrees = message.yaw_degrees();
  record.rig_residual = message.rig_residual();
  record.diagonal_m = message.diagonal_m();
  record.fit = FromProto(message.fit());
  record.reconstruction = FromProto(message.reconstruction());
  record.warnings.assign(message.warnings().begin(), message.warnings().end());
  for (const v1::FrameError& error : message.worst_frames()) {
    record.worst_frames.push_back({error.clip(), error.frame(), error.mean_percent()});
  }
  record.joint_fit_percent.assign(message.joint_fit_percent().begin(),
                                  message.joint_fit_percent().end());
  record.pose_jitter_degrees = message.pose_jitter_degrees();
  record.unsmoothed_jitter_degrees = message.unsmoothed_jitter_degrees();
  record.unsmoothed_rms_percent = message.unsmoothed_rms_percent();
  record.validation.num_held_out_frames = message.num_held_out_frames();
  record.validation.mean_percent.insert(message.validation_mean_percent().begin(),
                                        message.validation_mean_percent().end());
  return record;
}

}  // namespace pleat
