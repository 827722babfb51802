// Compressed sequences on the wire.
#include <string>
#include <utility>

#include "clip_info.h"
#include "pleat/base/check_count.h"
#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/wire/service_messages.h"
#include "pleat/wire/skeleton_messages.h"

namespace pleat {

v1::CompressOptions ToProto(const CompressOptions& options) {
  v1::CompressOptions message;
  switch (options.goal) {
    case CompressionGoal::kMaxError:
      message.set_max_error_mm(options.max_error_mm);
      break;
    case CompressionGoal::kKg:
      message.set_kg_percent(options.kg_percent);
      break;
    case CompressionGoal::kGrid:
      message.set_lossless_at_bits(options.grid_bits);
      break;
  }
  message.set_any_face_order(!options.keep_face_order);
  return message;
}

absl::StatusOr<CompressOptions> FromProto(const v1::CompressOptions& message) {
  CompressOptions options;
  switch (message.goal_case()) {
    case v1::CompressOptions::kMaxErrorMm:
      options.goal = CompressionGoal::kMaxError;
      options.max_error_mm = message.max_error_mm();
      break;
    case v1::CompressOptions::kKgPercent:
      options.goal = CompressionGoal::kKg;
      options.kg_percent = message.kg_percent();
      break;
    case v1::CompressOptions::kLosslessAtBits:
      options.goal = CompressionGoal::kGrid;
      options.grid_bits = message.lossless_at_bits();
      break;
    case v1::CompressOptions::GOAL_NOT_SET:
      return absl::InvalidArgumentError(
          "options has no goal: set max_error_mm, kg_percent or lossless_at_bits");
  }
  options.keep_face_order = !message.any_face_order();
  PLEAT_RETURN_IF_ERROR(ValidateCompressOptions(options));
  return options;
}

namespace {

v1::CompressionRecord RecordToProto(const CompressionRecord& record) {
  v1::CompressionRecord message;
  message.set_sequence_id(record.sequence_id);
  *message.mutable_options() = ToProto(record.options);
  const CompressSummary& summary = record.summary;
  message.set_size_bytes(summary.num_bytes);
  message.set_topology_bytes(summary.num_topology_bytes);
  message.set_bpvf(summary.bpvf);
  message.set_bpvf_without_topology(summary.bpvf_without_topology);
  message.set_kg_percent(summary.kg_percent);
  message.set_max_error_mm(summary.max_error_mm);
  message.set_encode_seconds(record.encode_seconds);
  message.set_decode_seconds(record.decode_seconds);
  return message;
}

absl::StatusOr<CompressionRecord> RecordFromProto(const v1::CompressionRecord& message) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(message.sequence_id(), "record.sequence_id"));
  CompressionRecord record;
  record.sequence_id = message.sequence_id();
  PLEAT_ASSIGN_OR_RETURN(record.options, FromProto(message.options()));
  CompressSummary& summary = record.summary;
  summary.num_bytes = message.size_bytes();
  summary.num_topology_bytes = message.topology_bytes();
  summary.bpvf = message.bpvf();
  summary.bpvf_without_topology = message.bpvf_without_topology();
  summary.kg_percent = message.kg_percent();
  summary.max_error_mm = message.max_error_mm();
  record.encode_seconds = message.encode_seconds();
  record.decode_seconds = message.decode_seconds();
  return record;
}

}  // namespace

v1::CompressedSequence ToProto(const CompressedSequenceInfo& info) {
  v1::CompressedSequence message;
  ClipInfoToProto(info, &message);
  if (info.record) *message.mutable_record() = RecordToProto(*info.record);
  return message;
}

absl::StatusOr<CompressedSequenceInfo> FromProto(const v1::CompressedSequence& message) {
  CompressedSequenceInfo info;
  PLEAT_RETURN_IF_ERROR(ClipInfoFromProto(message, "compressed_sequence", &info));
  if (message.has_record()) {
    PLEAT_ASSIGN_OR_RETURN(info.record, RecordFromProto(message.record()));
  }
  return info;
}

}  // namespace pleat
