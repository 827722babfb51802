// Section 9 of the model file: the learned detail.
#pragma once

#include "absl/status/statusor.h"
#include "pleat/base/bytes.h"
#include "pleat/learner/detail_model.h"

namespace pleat {

void WriteDetail(const DetailModelParameters& parameters, ByteWriter* writer);
// version: the version of the file. Version 1 has a basis of floats, which is rounded as finely as
// planes allow. max_unfolded_bytes: the limit for each whitener, which the file holds as a triangle
// and memory as a square. Errors are those of DecodeModel.
absl::StatusOr<DetailModelParameters> ReadDetail(ByteReader* reader, uint32_t version,
                                                 uint64_t max_unfolded_bytes);

}  // namespace pleat
