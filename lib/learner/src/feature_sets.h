// Sets of columns of a feature matrix.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <vector>

namespace pleat {

// True when `columns` holds at least one index, each in [0, num_columns) and above the one before.
inline bool IsFeatureSet(const std::vector<int>& columns, Eigen::Index num_columns) {
  return !columns.empty() && columns.front() >= 0 && columns.back() < num_columns &&
         std::adjacent_find(columns.begin(), columns.end(), std::greater_equal<>()) ==
             columns.end();
}

}  // namespace pleat
