// Sequences, jobs, models and compressed sequences on the wire. Messages come from outside: each
// FromProto checks them, and kInvalidArgument names the field that is wrong.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "pleat/service/compressed_sequence_service.h"
#include "pleat/service/job_service.h"
#include "pleat/service/model_service.h"
#include "pleat/service/sequence_service.h"
#include "pleat/v1/compressed_sequence_service.pb.h"
#include "pleat/v1/job_service.pb.h"
#include "pleat/v1/model_service.pb.h"
#include "pleat/v1/sequence_service.pb.h"

namespace pleat {

v1::Sequence ToProto(const SequenceInfo& info);
absl::StatusOr<SequenceInfo> FromProto(const v1::Sequence& message);

v1::JobState ToProto(JobState state);
absl::StatusOr<JobState> FromProto(v1::JobState state);

v1::Job ToProto(const JobInfo& info);
absl::StatusOr<JobInfo> FromProto(const v1::Job& message);

v1::Model ToProto(const ModelInfo& info);
absl::StatusOr<ModelInfo> FromProto(const v1::Model& message);

// A time to live in seconds, where 0 is for ever. kInvalidArgument names `what` when it is negative
// or longer than a century.
int64_t TtlToSeconds(absl::Duration ttl);
absl::StatusOr<absl::Duration> TtlFromSeconds(int64_t seconds, const std::string& what);

v1::CompressOptions ToProto(const CompressOptions& options);
// Returns kInvalidArgument when no goal is set or a number is out of range.
absl::StatusOr<CompressOptions> FromProto(const v1::CompressOptions& message);

v1::CompressedSequence ToProto(const CompressedSequenceInfo& info);
absl::StatusOr<CompressedSequenceInfo> FromProto(const v1::CompressedSequence& message);

}  // namespace pleat
