// The service's values as messages of pleat.store.v1 and back. FromRecord: kInvalidArgument names
// the field that is wrong.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/service/compressed_sequence_service.h"
#include "pleat/service/job_service.h"
#include "pleat/service/model_service.h"
#include "pleat/service/sequence_service.h"
#include "pleat/store/records.h"
#include "pleat/store/v1/records.pb.h"

namespace pleat {

store::v1::FrameRate ToRecord(const FrameRate& frame_rate);
absl::StatusOr<FrameRate> FromRecord(const store::v1::FrameRate& message);

store::v1::Skeleton ToRecord(const Skeleton& skeleton);
absl::StatusOr<Skeleton> FromRecord(const store::v1::Skeleton& message);

// Sets every field but those of FormatTrainOptions that have no line.
store::v1::TrainOptions ToRecord(const TrainOptions& options);
// An option that is absent keeps its default.
absl::StatusOr<TrainOptions> FromRecord(const store::v1::TrainOptions& message);

store::v1::TrainingRecord ToRecord(const TrainingRecord& record);
TrainingRecord FromRecord(const store::v1::TrainingRecord& message);

store::v1::CompressOptions ToRecord(const CompressOptions& options);
absl::StatusOr<CompressOptions> FromRecord(const store::v1::CompressOptions& message);

store::v1::CompressionRecord ToRecord(const CompressionRecord& record);
absl::StatusOr<CompressionRecord> FromRecord(const store::v1::CompressionRecord& message);

store::v1::Sequence ToRecord(const SequenceInfo& info);
absl::StatusOr<SequenceInfo> FromRecord(const store::v1::Sequence& message);

store::v1::CompressedSequence ToRecord(const CompressedSequenceInfo& info);
absl::StatusOr<CompressedSequenceInfo> FromRecord(const store::v1::CompressedSequence& message);

store::v1::Model ToRecord(const ModelInfo& info);
absl::StatusOr<ModelInfo> FromRecord(const store::v1::Model& message);

store::v1::Job ToRecord(const JobInfo& info);
absl::StatusOr<JobInfo> FromRecord(const store::v1::Job& message);

store::v1::Checkpoint ToRecord(const CheckpointInfo& info);
absl::StatusOr<CheckpointInfo> FromRecord(const store::v1::Checkpoint& message);

}  // namespace pleat
