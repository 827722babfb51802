// Positions or normals in memory that somebody else owns, such as the vertex buffer of an engine.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace pleat {

// Three float32 for each vertex: those of vertex v begin at data + v * stride. What lies between
// them is never touched. The memory must hold (V - 1) * stride + 3 floats.
struct VertexRows {
  float* data = nullptr;
  ptrdiff_t stride = 3;  // in floats, at least 3

  float* row(ptrdiff_t v) const { return data + v * stride; }
  bool is_packed() const { return stride == 3; }
};

// The columns of a 3 x V matrix.
inline VertexRows RowsOf(Eigen::Matrix3Xf* matrix) { return {.data = matrix->data()}; }

}  // namespace pleat
