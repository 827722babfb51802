// Catalogue rows as bytes: what the server's store keeps beside a file. Protocol Buffers inside, so
// that rows written by an older version stay readable; no *.pb.h needed by the caller.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "pleat/service/compressed_sequence_service.h"
#include "pleat/service/job_service.h"
#include "pleat/service/model_service.h"
#include "pleat/service/sequence_service.h"

namespace pleat {

std::string EncodeRecord(const SequenceInfo& info);
std::string EncodeRecord(const JobInfo& info);
std::string EncodeRecord(const ModelInfo& info);
std::string EncodeRecord(const CompressedSequenceInfo& info);

// kDataLoss when the bytes are no such record.
absl::StatusOr<SequenceInfo> DecodeSequenceRecord(const std::string& bytes);
absl::StatusOr<JobInfo> DecodeJobRecord(const std::string& bytes);
absl::StatusOr<ModelInfo> DecodeModelRecord(const std::string& bytes);
absl::StatusOr<CompressedSequenceInfo> DecodeCompressedSequenceRecord(const std::string& bytes);

}  // namespace pleat
