// Rows of floats filled up to whole registers, so that AddWeightedRows leaves no column over.
#pragma once

#include <Eigen/Core>

namespace pleat {

inline constexpr Eigen::Index kRegisterFloats = 16;  // of the widest registers

// The length of a row of `count` numbers, filled up.
inline Eigen::Index FilledUp(Eigen::Index count) {
  return (count + kRegisterFloats - 1) / kRegisterFloats * kRegisterFloats;
}

using RowMajorFloats = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace pleat
