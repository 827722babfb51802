// The check data of docs/method/learner.md#check-values: N poses (N x 102) and details (N x 1050,
// centimeters).
#pragma once

#include <Eigen/Core>
#include <fstream>
#include <string>
#include <vector>

#include "support/shared_data.h"

namespace pleat {

// Comma-separated numbers, one row per line.
inline Eigen::MatrixXd ReadCsv(const std::string& path) {
  std::ifstream file(path);
  std::vector<double> values;
  std::string line;
  int num_rows = 0;
  while (std::getline(file, line)) {
    if (line.empty()) continue;
    ++num_rows;
    for (const char* at = line.c_str(); *at;) {
      char* end = nullptr;
      values.push_back(std::strtod(at, &end));
      at = *end == ',' ? end + 1 : end;
    }
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<RowMajor>(values.data(), num_rows, num_rows ? values.size() / num_rows : 0);
}

// Mean over rows of |error of a vertex|^2, square root: the outputs are triples x, y, z.
inline double RmsVertexError(const Eigen::MatrixXd& predicted, const Eigen::MatrixXd& truth) {
  return std::sqrt((predicted - truth).squaredNorm() * 3 / double(truth.size()));
}

}  // namespace pleat
