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

// Reads the one scale of all inputs that files before version 3 have; later ones have none.
absl::Status ReadOldInputScale(ByteReader* reader, uint32_t version, double* scale);
absl::Status ReadMeanAndScales(ByteReader* reader, uint32_t version, uint32_t num_inputs,
                               double old_scale, Eigen::VectorXd* mean, Eigen::VectorXd* scales);

// The most coefficients of a model. Whoever has a coefficient has its column of the fold, or of
// alpha, in the file as well; the limit stops counts that only want memory.
inline constexpr uint32_t kMaxCoefficients = 1 << 16;

void WriteRegional(const RegionalGpParameters& regional, ByteWriter* writer);
absl::StatusOr<RegionalGpParameters> ReadRegional(ByteReader* reader, uint32_t version);

void WriteFold(const std::vector<CoefficientFoldBlock>& fold, ByteWriter* writer);
absl::StatusOr<std::vector<CoefficientFoldBlock>> ReadFold(ByteReader* reader, uint32_t version);

}  // namespace pleat
