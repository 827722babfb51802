// Nearest training frame: the simplest baseline of the evaluation.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pleat {

// For each of M query rows (M x D) the index of the training row (N x D, N > 0) at the smallest
// Euclidean distance; the first of equals.
std::vector<int> NearestRows(const Eigen::Ref<const Eigen::MatrixXd>& training,
                             const Eigen::Ref<const Eigen::MatrixXd>& queries);

}  // namespace pleat
