// Parts of square matrices.
#pragma once

#include <Eigen/Core>

namespace pleat {

// The lower triangle with its diagonal, zeros above.
inline Eigen::MatrixXd Lower(const Eigen::MatrixXd& m) { return m.triangularView<Eigen::Lower>(); }

}  // namespace pleat
