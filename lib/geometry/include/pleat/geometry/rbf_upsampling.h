// Carries displacements of the control vertices to all vertices, by radial basis functions centered
// on the control vertices (docs/method/details.md#upsampling; paper, section III-C).
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/topology.h"

namespace pleat {

struct RbfUpsamplingOptions {
  // The number of control vertices per vertex, the nearest along the surface: nothing bleeds from
  // an arm to the body beside it. The error flattens at 16-24.
  int num_neighbors = 20;
  // The length of the kernel in mean spacings of the control vertices. Long kernels approach a
  // polyharmonic spline: best on captured clothes among lengths of 2 to 32.
  double kernel_length = 24;
  // Extra coordinates of every vertex (F x V, or empty), such as the skinning weights, in which
  // kernel distances are measured besides the rest position: details change fastest where the
  // weights do. With the weights the error on captured clothes falls by a quarter.
  Eigen::MatrixXd features = {};
  // A distance of 1 in feature space counts like this share of the rest pose's diagonal.
  double feature_scale = 0.11;
  int num_threads = 0;  // 0 = one per core; the result does not depend on it
};

struct UpsamplingRefinementOptions {
  // The strength of the pull towards the kernel weights, relative to the mean squared displacement.
  double ridge = 3e-3;
  int max_frames = 256;  // evenly spaced ones are used of a longer animation
  int num_threads = 0;   // 0 = one per core; the result does not depend on it
};

// A linear map, the same for x, y and z: one sparse V x C matrix. Immutable.
class RbfUpsampler {
 public:
  using Matrix = Eigen::SparseMatrix<float, Eigen::RowMajor>;

  // Builds the map by local interpolation with the Matern kernel (1 + s) exp(-s), s = sqrt(3) d /
  // length, and a constant, so that rows add up to 1 and control vertices are met exactly. rest: 3
  // x V, meters; control_vertices: C distinct vertex indices. A component without control vertices
  // follows the nearest ones through the air. The error is kInvalidArgument for counts or indices
  // that do not fit, and kCancelled.
  static absl::StatusOr<RbfUpsampler> Build(const Topology& topology, const Eigen::Matrix3Xd& rest,
                                            const std::vector<int>& control_vertices,
                                            const RbfUpsamplingOptions& options = {},
                                            const Progress& progress = {});

  // Takes the parts of a stored matrix (compressed rows): row_starts V + 1, columns and values one
  // entry per stored weight. The error is kInvalidArgument unless starts ascend from 0 to the entry
  // count, columns of a row ascend within [0, num_controls) and values are finite.
  static absl::StatusOr<RbfUpsampler> FromRows(int num_controls,
                                               const std::vector<int32_t>& row_starts,
                                               const std::vector<int32_t>& columns,
                                               const std::vector<float>& values);

  // Returns a map with the same neighbors but weights learned from an animation: per vertex the
  // ridge regression of its displacements on those of its neighbors, pulled towards the kernel
  // weights. displacements: T x 3V (x, y, z of vertex 0, of vertex 1, ...), control_vertices as in
  // Build. It stays exact at the control vertices. On held-out frames of captured clothes the error
  // falls to 40 %. The error is kInvalidArgument for sizes that do not fit, and kCancelled.
  absl::StatusOr<RbfUpsampler> Refine(const Eigen::Ref<const Eigen::MatrixXd>& displacements,
                                      const std::vector<int>& control_vertices,
                                      const UpsamplingRefinementOptions& options = {},
                                      const Progress& progress = {}) const;

  // Applies the map. control: 3C, full: 3V (x, y, z of the first, ...). It does not allocate once
  // `full` has its size. Sums run in the order of columns, so results are the same everywhere.
  void Apply(const Eigen::Ref<const Eigen::VectorXf>& control, Eigen::VectorXf* full) const;
  void Apply(const Eigen::Ref<const Eigen::VectorXd>& control, Eigen::VectorXd* full) const;

  int num_vertices() const { return static_cast<int>(matrix_.rows()); }
  int num_controls() const { return static_cast<int>(matrix_.cols()); }
  const Matrix& matrix() const { return matrix_; }  // V x C, compressed

 private:
  // Swapped in: Eigen 3.4 cannot move a sparse matrix.
  explicit RbfUpsampler(Matrix matrix) { matrix_.swap(matrix); }
  Matrix matrix_;
};

}  // namespace pleat
