// The parts of section 9 of the model file that only the regional learner has, and what versions of
// the file differ in.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/bytes.h"
#include "pleat/learner/detail_model.h"

namespace pleat {

// Files before version 3 have one scale for all inputs, which stands before the matrices.
inline constexpr uint32_t kFirstWithInputScales = 3;
// Files before version 4 have one basis for all regions and all vertices.
inline constexpr uint32_t kFirstWithParts = 4;

// Reads that one scale; later versions have none.
absl::Status ReadOldInputScale(ByteReader* reader, uint32_t version, double* scale);
absl::Status ReadMeanAndScales(ByteReader* reader, uint32_t version, uint32_t num_inputs,
                               double old_scale, Eigen::VectorXd* mean, Eigen::VectorXd* scales);

void WriteRegional(const RegionalGpParameters& regional, ByteWriter* writer);
absl::StatusOr<RegionalGpParameters> ReadRegional(ByteReader* reader, uint32_t version);

void WriteFold(const std::vector<CoefficientFoldBlock>& fold, ByteWriter* writer);
absl::StatusOr<std::vector<CoefficientFoldBlock>> ReadFold(ByteReader* reader);

}  // namespace pleat
