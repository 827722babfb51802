// Centering and scaling shared by the learners.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pleat {

// sqrt(square), or 1 when it is not positive: nothing to scale by.
double PositiveRoot(double square);

// Divides every column (already centered) by its standard deviation (N - 1); constant ones stay.
void ScaleColumns(Eigen::MatrixXd* centered);

// Median of the entries below the diagonal of a matrix of squared distances (N x N, lower),
// positive entries only; 1 when there are none.
double MedianSquaredDistance(const Eigen::MatrixXd& distances);

// At most `count` (at least one) of `num_rows` rows, spread evenly, ascending.
std::vector<Eigen::Index> SpreadRows(Eigen::Index num_rows, Eigen::Index count);

}  // namespace pleat
