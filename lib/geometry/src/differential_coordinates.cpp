#include "pleat/geometry/differential_coordinates.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "surface_neighbors.h"

namespace pleat {
namespace {

// Returns the pairs of control vertices (as positions in the list) whose cells touch, ascending.
std::vector<std::pair<int, int>> TouchingCells(const Topology& topology,
                                               const Eigen::Matrix3Xd& reference,
                                               const std::vector<int>& control_vertices) {
  const auto nearest = FindSurfaceNeighbors(topology, reference, control_vertices, 1);
  std::vector<std::pair<int, int>> pairs;
  for (int f = 0; f < topology.num_faces(); ++f) {
    const auto face = topology.face(f);
    for (size_t c = 0; c < face.size(); ++c) {
      const auto& a = nearest[face[c]];
      const auto& b = nearest[face[(c + 1) % face.size()]];
      if (a.empty() || b.empty() || a[0].source == b[0].source) continue;
      pairs.emplace_back(std::minmax(a[0].source, b[0].source));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

absl::Status CheckInput(const Topology& topology, const Eigen::Matrix3Xd& reference,
                        const std::vector<int>& control_vertices, double anchor) {
  if (reference.cols() != topology.num_vertices()) {
    return absl::InvalidArgumentError(absl::StrCat("differential coordinates: the reference has ",
                                                   reference.cols(), " vertices, the mesh has ",
                                                   topology.num_vertices()));
  }
  if (control_vertices.empty()) {
    return absl::InvalidArgumentError("differential coordinates: no control vertices");
  }
  for (const int v : control_vertices) {
    if (v >= 0 && v < topology.num_vertices()) continue;
    return absl::InvalidArgumentError(absl::StrCat("differential coordinates: control vertex ", v,
                                                   " is not in [0, ", topology.num_vertices(),
                                                   ")"));
  }
  if (anchor > 0) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("differential coordinates: the anchor ", anchor, " is not positive"));
}

}  // namespace

absl::StatusOr<DifferentialCoordinates> DifferentialCoordinates::Build(
    const Topology& topology, const Eigen::Matrix3Xd& reference,
    const std::vector<int>& control_vertices, double anchor) {
  if (absl::Status status = CheckInput(topology, reference, control_vertices, anchor);
      !status.ok()) {
    return status;
  }
  const auto count = static_cast<Eigen::Index>(control_vertices.size());
  DifferentialCoordinates result;
  result.num_neighbors_.assign(control_vertices.size(), 0);
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [a, b] : TouchingCells(topology, reference, control_vertices)) {
    ++result.num_neighbors_[a];
    ++result.num_neighbors_[b];
    entries.emplace_back(a, b, -1);
    entries.emplace_back(b, a, -1);
  }
  for (int i = 0; i < count; ++i) {
    entries.emplace_back(i, i, (1 + anchor) * std::max(1, result.num_neighbors_[i]));
  }
  result.matrix_.resize(count, count);
  result.matrix_.setFromTriplets(entries.begin(), entries.end());
  // Multiplied by the neighbor counts the matrix is symmetric and strictly diagonally dominant, so
  // it is positive definite and has an LDL^T factorization.
  result.factor_ =
      std::make_shared<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>(result.matrix_);
  return result;
}

Eigen::MatrixXd DifferentialCoordinates::Encode(
    const Eigen::Ref<const Eigen::MatrixXd>& displacements) const {
  Eigen::MatrixXd encoded(displacements.rows(), displacements.cols());
  for (Eigen::Index t = 0; t < displacements.rows(); ++t) {
    const Eigen::MatrixXd xyz =
        displacements.row(t).reshaped(3, displacements.cols() / 3).transpose();  // C x 3
    Eigen::MatrixXd differences = matrix_ * xyz;
    for (Eigen::Index i = 0; i < differences.rows(); ++i) {
      differences.row(i) /= std::max(1, num_neighbors_[i]);
    }
    encoded.row(t) = differences.transpose().reshaped().transpose();
  }
  return encoded;
}

Eigen::MatrixXd DifferentialCoordinates::DecodeColumns(
    const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  Eigen::MatrixXd decoded(columns.rows(), columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    Eigen::MatrixXd differences =
        columns.col(c).reshaped(3, columns.rows() / 3).transpose();  // C x 3
    for (Eigen::Index i = 0; i < differences.rows(); ++i) {
      differences.row(i) *= std::max(1, num_neighbors_[i]);
    }
    const Eigen::MatrixXd xyz = factor_->solve(differences);
    decoded.col(c) = xyz.transpose().reshaped();
  }
  return decoded;
}

}  // namespace pleat
