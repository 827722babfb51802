// Functions of time as quantized cosine transforms.
#pragma once

#include <Eigen/Core>

#include "absl/status/status.h"
#include "binary_coder.h"

namespace pleat {

// One row per trajectory, one column per frame.
using TrajectoryMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// steps: of every row. Encoding reads `rows`, both directions leave the decoded values in it. The
// orthonormal DCT keeps squared errors. kInvalidArgument (encoding): a value is too large for its
// step. kDataLoss (decoding): the code is cut off.
absl::Status CodeTrajectories(const Eigen::Ref<const Eigen::VectorXd>& steps, BinaryCoder* coder,
                              TrajectoryMatrix* rows);

}  // namespace pleat
