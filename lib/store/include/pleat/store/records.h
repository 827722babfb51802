// Rows of the catalog as bytes: messages of pleat.store.v1 (proto/pleat/store/v1/records.proto).
//
// The schema on disk is its own, apart from the wire, so pleat.v1 may change without touching what
// is stored. Rows that Pleat 0.1.0 wrote are read like new ones. Equal content gives equal bytes.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "pleat/service/compressed_sequence_service.h"
#include "pleat/service/job_service.h"
#include "pleat/service/model_service.h"
#include "pleat/service/sequence_service.h"

namespace pleat {

// Of a file that belongs to a job which has not ended.
struct CheckpointInfo {
  std::string job_id;
};

std::string EncodeRecord(const SequenceInfo& info);
std::string EncodeRecord(const JobInfo& info);
std::string EncodeRecord(const ModelInfo& info);
std::string EncodeRecord(const CompressedSequenceInfo& info);
std::string EncodeRecord(const CheckpointInfo& info);

// kDataLoss when the bytes are no such record or a value in them is out of range: what comes from a
// damaged disk is checked like what comes from outside.
absl::StatusOr<SequenceInfo> DecodeSequenceRecord(const std::string& bytes);
absl::StatusOr<JobInfo> DecodeJobRecord(const std::string& bytes);
absl::StatusOr<ModelInfo> DecodeModelRecord(const std::string& bytes);
absl::StatusOr<CompressedSequenceInfo> DecodeCompressedSequenceRecord(const std::string& bytes);
absl::StatusOr<CheckpointInfo> DecodeCheckpointRecord(const std::string& bytes);

}  // namespace pleat
