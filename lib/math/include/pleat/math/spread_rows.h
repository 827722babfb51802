// Some of many rows or frames, for what would take too long on all of them.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pleat {

// Returns at most `count` (at least one) of `num_rows` rows, spread evenly, ascending. The first is
// 0.
std::vector<Eigen::Index> SpreadRows(Eigen::Index num_rows, Eigen::Index count);

}  // namespace pleat
