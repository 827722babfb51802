#include "pleat/gp/scaling.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pleat {

double PositiveRoot(double square) { return square > 0 ? std::sqrt(square) : 1; }

void ScaleColumns(Eigen::MatrixXd* centered) {
  const double count = static_cast<double>(centered->rows()) - 1;
  const Eigen::VectorXd squares = centered->colwise().squaredNorm() / count;
  const double smallest = 1e-20 * (squares.size() > 0 ? squares.maxCoeff() : 0);  // rounding
  for (Eigen::Index d = 0; d < centered->cols(); ++d) {
    if (squares[d] > smallest) centered->col(d) /= std::sqrt(squares[d]);
  }
}

double MedianSquaredDistance(const Eigen::MatrixXd& distances) {
  std::vector<double> positive;
  positive.reserve(distances.rows() * (distances.rows() - 1) / 2);
  for (Eigen::Index j = 0; j < distances.cols(); ++j) {
    for (Eigen::Index i = j + 1; i < distances.rows(); ++i) {
      if (distances(i, j) > 0) positive.push_back(distances(i, j));
    }
  }
  if (positive.empty()) return 1;
  const auto middle = positive.begin() + positive.size() / 2;
  std::nth_element(positive.begin(), middle, positive.end());
  return *middle;
}

}  // namespace pleat
