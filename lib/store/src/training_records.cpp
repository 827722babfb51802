// Training options and what training recorded.
#include <google/protobuf/descriptor.h>

#include <cstdio>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "record_messages.h"

namespace pleat {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

// Sets `field` to the value that `text` stands for; FormatTrainOptions wrote it.
void SetFromText(absl::string_view text, const FieldDescriptor* field, Message* message) {
  const google::protobuf::Reflection* fields = message->GetReflection();
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32: {
      int32_t value = 0;
      if (absl::SimpleAtoi(text, &value)) fields->SetInt32(message, field, value);
      break;
    }
    case FieldDescriptor::CPPTYPE_UINT64: {
      uint64_t value = 0;
      if (absl::SimpleAtoi(text, &value)) fields->SetUInt64(message, field, value);
      break;
    }
    case FieldDescriptor::CPPTYPE_DOUBLE: {
      double value = 0;
      if (absl::SimpleAtod(text, &value)) fields->SetDouble(message, field, value);
      break;
    }
    default:
      fields->SetString(message, field, std::string(text));
  }
}

// The value of `field` as ParseTrainOptions reads it.
std::string TextOf(const Message& message, const FieldDescriptor* field) {
  const google::protobuf::Reflection* fields = message.GetReflection();
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return absl::StrCat(fields->GetInt32(message, field));
    case FieldDescriptor::CPPTYPE_UINT64:
      return absl::StrCat(fields->GetUInt64(message, field));
    case FieldDescriptor::CPPTYPE_DOUBLE: {
      char text[40];
      std::snprintf(text, sizeof(text), "%.17g", fields->GetDouble(message, field));
      return text;
    }
    default:
      return fields->GetString(message, field);
  }
}

store::v1::ErrorSummary ToRecord(const ErrorSummary& summary) {
  store::v1::ErrorSummary message;
  message.set_mean_percent(summary.mean_percent);
  message.set_rms_percent(summary.rms_percent);
  message.set_p95_percent(summary.p95_percent);
  message.set_max_percent(summary.max_percent);
  message.set_mean_mm(summary.mean_mm);
  message.set_motion_mean_percent(summary.motion_mean_percent);
  return message;
}

ErrorSummary FromRecord(const store::v1::ErrorSummary& message) {
  ErrorSummary summary;
  summary.mean_percent = message.mean_percent();
  summary.rms_percent = message.rms_percent();
  summary.p95_percent = message.p95_percent();
  summary.max_percent = message.max_percent();
  summary.mean_mm = message.mean_mm();
  summary.motion_mean_percent = message.motion_mean_percent();
  return summary;
}

}  // namespace

// The fields of the message have the names of the options, so the options' own text form is enough:
// a new option needs one line in the schema and none here (records_test compares the two lists).
store::v1::TrainOptions ToRecord(const TrainOptions& options) {
  store::v1::TrainOptions message;
  const std::string text = FormatTrainOptions(options);
  for (const absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty())) {
    const std::pair<std::string, absl::string_view> option =
        absl::StrSplit(line, absl::MaxSplits('=', 1));
    const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(option.first);
    if (field != nullptr) SetFromText(option.second, field, &message);
  }
  return message;
}

absl::StatusOr<TrainOptions> FromRecord(const store::v1::TrainOptions& message) {
  std::vector<const FieldDescriptor*> set_fields;
  message.GetReflection()->ListFields(message, &set_fields);
  std::string text;
  for (const FieldDescriptor* field : set_fields) {
    const std::string value = TextOf(message, field);
    if (absl::StrContains(value, '\n')) {  // would be read as another option
      return absl::InvalidArgumentError(
          absl::StrCat("option ", field->name(), " has more than one line"));
    }
    absl::StrAppend(&text, field->name(), "=", value, "\n");
  }
  return ParseTrainOptions(text);
}

store::v1::TrainingRecord ToRecord(const TrainingRecord& record) {
  store::v1::TrainingRecord message;
  message.set_learner(record.learner);
  message.set_num_frames(record.num_frames);
  message.set_rest_frame(record.rest_frame);
  message.set_yaw_degrees(record.yaw_degrees);
  message.set_rig_residual(record.rig_residual);
  message.set_diagonal_m(record.diagonal_m);
  *message.mutable_fit() = ToRecord(record.fit);
  *message.mutable_reconstruction() = ToRecord(record.reconstruction);
  for (const std::string& warning : record.warnings) message.add_warnings(ToValidUtf8(warning));
  for (const FrameError& error : record.worst_frames) {
    store::v1::FrameError* out = message.add_worst_frames();
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

TrainingRecord FromRecord(const store::v1::TrainingRecord& message) {
  TrainingRecord record;
  record.learner = message.learner();
  record.num_frames = message.num_frames();
  record.rest_frame = message.rest_frame();
  record.yaw_degrees = message.yaw_degrees();
  record.rig_residual = message.rig_residual();
  record.diagonal_m = message.diagonal_m();
  record.fit = FromRecord(message.fit());
  record.reconstruction = FromRecord(message.reconstruction());
  record.warnings.assign(message.warnings().begin(), message.warnings().end());
  for (const store::v1::FrameError& error : message.worst_frames()) {
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
