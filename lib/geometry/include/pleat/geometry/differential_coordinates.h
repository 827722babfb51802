// Differential coordinates of displacements on a subset of the vertices: every displacement against
// the mean of its neighbors'. The paper (section III-C) tried them for its details;
// docs/method/details.md#differential-coordinates says how they fared here.
//
//   delta_i = (1 + anchor) d_i - mean of d_j over the neighbors j of i
//
// Source: O. Sorkine, "Differential representations for mesh processing", CGF 25(4), 2006, with
// uniform weights. Differences alone leave a constant open; the anchor, a small share of the
// displacement itself, closes it and makes the map invertible.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// Immutable; copies share the factorization.
class DifferentialCoordinates {
 public:
  // Builds the map and factors it. Two control vertices are neighbors when an edge joins the cells
  // of vertices that are nearest to them along the surface; with all vertices as control vertices
  // these are the mesh's edges. reference: 3 x V, meters. The error is kInvalidArgument when the
  // counts of `topology` and `reference` differ, there is no control vertex or one is out of range,
  // or `anchor` is not positive.
  static absl::StatusOr<DifferentialCoordinates> Build(const Topology& topology,
                                                       const Eigen::Matrix3Xd& reference,
                                                       const std::vector<int>& control_vertices,
                                                       double anchor = .01);

  int num_control_vertices() const { return static_cast<int>(matrix_.rows()); }  // C
  const std::vector<int>& num_neighbors() const { return num_neighbors_; }       // C

  // Turns displacements into differential coordinates, T x 3C both (x, y, z of the first vertex, of
  // the second, ...).
  Eigen::MatrixXd Encode(const Eigen::Ref<const Eigen::MatrixXd>& displacements) const;
  // The inverse for columns: 3C x r to 3C x r, as the mean and the basis of details have them.
  Eigen::MatrixXd DecodeColumns(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

 private:
  DifferentialCoordinates() = default;

  std::vector<int> num_neighbors_;
  Eigen::SparseMatrix<double> matrix_;  // C x C, symmetric: the map times the neighbor counts
  std::shared_ptr<const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>> factor_;
};

}  // namespace pleat
