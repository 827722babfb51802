// Centering and scaling shared by the learners.
#pragma once

#include <Eigen/Core>

namespace pleat {

// Returns sqrt(square), or 1 when it is not positive and there is nothing to scale by.
double PositiveRoot(double square);

// Divides every column (already centered) by its standard deviation (N - 1); constant ones stay.
void ScaleColumns(Eigen::MatrixXd* centered);

// Returns the median of the positive entries below the diagonal of a matrix of squared distances (N
// x N, lower); 1 when there are none. Of an even count it is the upper one of the two in the
// middle.
double MedianSquaredDistance(const Eigen::MatrixXd& distances);

}  // namespace pleat
