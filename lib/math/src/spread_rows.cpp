#include "pleat/math/spread_rows.h"

#include <algorithm>

namespace pleat {

std::vector<Eigen::Index> SpreadRows(Eigen::Index num_rows, Eigen::Index count) {
  std::vector<Eigen::Index> rows(std::min(num_rows, std::max<Eigen::Index>(count, 1)));
  for (size_t i = 0; i < rows.size(); ++i) {
    rows[i] = static_cast<Eigen::Index>(i) * num_rows / static_cast<Eigen::Index>(rows.size());
  }
  return rows;
}

}  // namespace pleat
