// Each vertex has its own small interpolation problem, because one large one would be wrong twice.
// It would be dense in thousands of control vertices; and it would measure distances through the
// air, so that the sleeve would follow the hip beside it. Here a row of the matrix sees only the
// control vertices that are nearest *along the surface* (surface_neighbors.h), twenty by default.
//
// Within these the kernel sees plain distances between points z = [rest position; scaled features]:
// on points a Matern kernel is always positive definite, on distances along a surface it need not
// be. With the skinning weights as features, vertices that move with other bones are far apart even
// where they are close in the rest pose, which is where details change fastest.
//
// The weights of a row solve kriging with an unknown constant: with the kernel matrix K of the
// neighbors and the kernel values k at the vertex,
//
//   row = K^-1 k + m K^-1 1,   m = (1 - 1^T K^-1 k) / (1^T K^-1 1),
//
// so the row sums to 1, and displacements that are equal everywhere are carried over exactly. Both
// solves share one Cholesky factor. The kernel is long against the neighborhood (24 spacings), so K
// is close to singular; control vertices at one place would make it so, hence 1e-10 on its
// diagonal. In control vertices themselves the row is a single 1: exactness there does not depend
// on a solve.
//
// Refine() keeps the sparsity and learns the values. For vertex v with the displacements A of its
// neighbors and b of its own over the frames it minimizes |A w - b|^2 + l |w - w_kernel|^2, solved
// for the change w - w_kernel. The penalty l is a share of the mean squared displacement, one
// number for all vertices: a vertex that hardly moves keeps its kernel weights, since its data
// would be noise.
//
// Rows are independent and are computed in parallel; a batch of 512 is the grain at which
// cancellation is noticed. Building costs O(V m^3) for m neighbors and is paid once per character.

#include "pleat/geometry/rbf_upsampling.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/geometry/point_index.h"
#include "surface_neighbors.h"

namespace pleat {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct WeightedControl {
  int control;
  double weight;
  bool operator<(const WeightedControl& other) const { return control < other.control; }
};
using Row = std::vector<WeightedControl>;

constexpr int kBatch = 512;  // vertices between two looks at cancellation

absl::Status CheckControls(int num_vertices, const std::vector<int>& control_vertices) {
  if (control_vertices.empty()) {
    return absl::InvalidArgumentError("upsampling: there are no control vertices");
  }
  std::vector<char> seen(num_vertices, 0);
  for (size_t c = 0; c < control_vertices.size(); ++c) {
    const int v = control_vertices[c];
    if (v < 0 || v >= num_vertices || seen[v]) {
      return absl::InvalidArgumentError(absl::StrCat("upsampling: control vertex ", c, " is ", v,
                                                     ", out of [0, ", num_vertices,
                                                     ") or listed twice"));
    }
    seen[v] = 1;
  }
  return absl::OkStatus();
}

absl::Status CheckBuild(const Topology& topology, const Eigen::Matrix3Xd& rest,
                        const std::vector<int>& control_vertices,
                        const RbfUpsamplingOptions& options) {
  const int num_vertices = topology.num_vertices();
  if (rest.cols() != num_vertices ||
      (options.features.size() > 0 && options.features.cols() != num_vertices)) {
    return absl::InvalidArgumentError(
        absl::StrCat("upsampling: ", rest.cols(), " rest positions and ", options.features.cols(),
                     " feature columns for a topology of ", num_vertices, " vertices"));
  }
  if (!rest.allFinite() || !options.features.allFinite()) {
    return absl::InvalidArgumentError("upsampling: a rest position or feature is not finite");
  }
  if (options.num_neighbors < 1 || !(options.kernel_length > 0) || !(options.feature_scale >= 0)) {
    return absl::InvalidArgumentError(
        "upsampling: num_neighbors and kernel_length must be positive, feature_scale at least 0");
  }
  return CheckControls(num_vertices, control_vertices);
}

// Returns rest positions and scaled features, one column per vertex (meters).
MatrixXd KernelCoordinates(const Eigen::Matrix3Xd& rest, const RbfUpsamplingOptions& options) {
  MatrixXd coordinates(3 + options.features.rows(), rest.cols());
  coordinates.topRows(3) = rest;
  if (options.features.size() > 0) {
    const double diagonal = (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm();
    coordinates.bottomRows(options.features.rows()) =
        options.feature_scale * diagonal * options.features;
  }
  return coordinates;
}

// Returns the mean distance of a control vertex to the nearest other one, in meters; 1 when there
// is none.
double MeanSpacing(const Eigen::Matrix3Xd& controls, const PointIndex& index) {
  if (controls.cols() < 2) return 1;
  double sum = 0;
  for (Eigen::Index c = 0; c < controls.cols(); ++c) {
    const auto nearest = index.NearestFew(controls.col(c), 2);
    sum += std::sqrt(nearest[1].second);
  }
  const double mean = sum / static_cast<double>(controls.cols());
  return mean > 0 ? mean : 1;
}

// Solves the kernel system of one vertex for the interpolation weights of `controls` (positions in
// control_vertices) at `vertex`, with constants reproduced. Columns of the row ascend, as Eigen's
// compressed rows need.
Row KernelRow(const MatrixXd& coordinates, const std::vector<int>& control_vertices,
              const std::vector<int>& controls, int vertex, double length) {
  const Eigen::Index m = static_cast<Eigen::Index>(controls.size());
  auto kernel = [&](int a, int b) {
    const double s = std::sqrt(3.0) / length * (coordinates.col(a) - coordinates.col(b)).norm();
    return (1 + s) * std::exp(-s);
  };
  MatrixXd gram(m, m);
  MatrixXd right(m, 2);  // kernel values at the vertex, ones
  for (Eigen::Index i = 0; i < m; ++i) {
    const int a = control_vertices[controls[i]];
    for (Eigen::Index j = 0; j < i; ++j) gram(i, j) = kernel(a, control_vertices[controls[j]]);
    gram(i, i) = 1 + 1e-10;  // control vertices at one place must not make the system singular
    right(i, 0) = kernel(a, vertex);
    right(i, 1) = 1;
  }
  const MatrixXd solved = gram.selfadjointView<Eigen::Lower>().llt().solve(right);
  const double multiplier = (1 - solved.col(0).sum()) / solved.col(1).sum();
  const VectorXd weights = solved.col(0) + multiplier * solved.col(1);
  Row row(m);
  for (Eigen::Index i = 0; i < m; ++i) row[i] = {controls[i], weights[i]};
  std::sort(row.begin(), row.end());
  return row;
}

RbfUpsampler::Matrix ToMatrix(const std::vector<Row>& rows, int num_controls) {
  RbfUpsampler::Matrix matrix(static_cast<Eigen::Index>(rows.size()), num_controls);
  std::vector<int> sizes(rows.size());
  for (size_t v = 0; v < rows.size(); ++v) sizes[v] = static_cast<int>(rows[v].size());
  matrix.reserve(sizes);
  for (size_t v = 0; v < rows.size(); ++v) {
    for (const WeightedControl& entry : rows[v]) {
      matrix.insert(static_cast<Eigen::Index>(v), entry.control) = static_cast<float>(entry.weight);
    }
  }
  matrix.makeCompressed();
  return matrix;
}

// Returns the position of every vertex in control_vertices, -1 for the others.
std::vector<int> ControlOfVertex(int num_vertices, const std::vector<int>& control_vertices) {
  std::vector<int> control_of(num_vertices, -1);
  for (size_t c = 0; c < control_vertices.size(); ++c) {
    control_of[control_vertices[c]] = static_cast<int>(c);
  }
  return control_of;
}

}  // namespace

absl::StatusOr<RbfUpsampler> RbfUpsampler::Build(const Topology& topology,
                                                 const Eigen::Matrix3Xd& rest,
                                                 const std::vector<int>& control_vertices,
                                                 const RbfUpsamplingOptions& options,
                                                 const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckBuild(topology, rest, control_vertices, options));
  const int num_vertices = topology.num_vertices();
  const auto neighbors =
      FindSurfaceNeighbors(topology, rest, control_vertices, options.num_neighbors);
  Eigen::Matrix3Xd control_positions(3, control_vertices.size());
  for (size_t c = 0; c < control_vertices.size(); ++c) {
    control_positions.col(c) = rest.col(control_vertices[c]);
  }
  const PointIndex index(control_positions);
  const double length = options.kernel_length * MeanSpacing(control_positions, index);
  const MatrixXd coordinates = KernelCoordinates(rest, options);
  const std::vector<int> control_of = ControlOfVertex(num_vertices, control_vertices);
  std::vector<Row> rows(num_vertices);
  PLEAT_RETURN_IF_ERROR(
      ParallelForPieces(num_vertices, kBatch, options.num_threads, progress, [&](int v) {
        if (control_of[v] >= 0) {
          rows[v] = {{control_of[v], 1.0}};
          return;
        }
        std::vector<int> controls;
        for (const SurfaceNeighbor& neighbor : neighbors[v]) controls.push_back(neighbor.source);
        if (controls.empty()) {
          for (const auto& [control, squared] :
               index.NearestFew(rest.col(v), options.num_neighbors)) {
            controls.push_back(control);
          }
        }
        rows[v] = KernelRow(coordinates, control_vertices, controls, v, length);
      }));
  return RbfUpsampler(ToMatrix(rows, static_cast<int>(control_vertices.size())));
}

absl::StatusOr<RbfUpsampler> RbfUpsampler::FromRows(int num_controls,
                                                    const std::vector<int32_t>& row_starts,
                                                    const std::vector<int32_t>& columns,
                                                    const std::vector<float>& values) {
  if (num_controls < 1 || row_starts.empty() || row_starts.front() != 0 ||
      columns.size() != values.size() ||
      row_starts.back() != static_cast<int64_t>(columns.size())) {
    return absl::InvalidArgumentError(
        absl::StrCat("upsampling matrix: ", row_starts.size(), " row starts, ", columns.size(),
                     " columns and ", values.size(), " values do not describe a matrix"));
  }
  for (size_t v = 0; v + 1 < row_starts.size(); ++v) {
    bool valid = row_starts[v] <= row_starts[v + 1];
    for (int32_t i = row_starts[v]; valid && i < row_starts[v + 1]; ++i) {
      valid = i < static_cast<int64_t>(columns.size()) && columns[i] >= 0 &&
              columns[i] < num_controls && std::isfinite(values[i]) &&
              (i == row_starts[v] || columns[i - 1] < columns[i]);
    }
    if (!valid) {
      return absl::InvalidArgumentError(absl::StrCat(
          "upsampling matrix: row ", v, " is damaged (starts, column order or a value)"));
    }
  }
  Matrix matrix = Eigen::Map<const Matrix>(static_cast<Eigen::Index>(row_starts.size()) - 1,
                                           num_controls, static_cast<Eigen::Index>(values.size()),
                                           row_starts.data(), columns.data(), values.data());
  return RbfUpsampler(std::move(matrix));
}

absl::StatusOr<RbfUpsampler> RbfUpsampler::Refine(const Eigen::Ref<const MatrixXd>& displacements,
                                                  const std::vector<int>& control_vertices,
                                                  const UpsamplingRefinementOptions& options,
                                                  const Progress& progress) const {
  PLEAT_RETURN_IF_ERROR(CheckControls(num_vertices(), control_vertices));
  if (displacements.cols() != 3 * matrix_.rows() || displacements.rows() < 1 ||
      static_cast<Eigen::Index>(control_vertices.size()) != matrix_.cols()) {
    return absl::InvalidArgumentError(
        absl::StrCat("upsampling: displacements of ", displacements.rows(), " x ",
                     displacements.cols(), " and ", control_vertices.size(),
                     " control vertices for a matrix of ", matrix_.rows(), " x ", matrix_.cols()));
  }
  if (!displacements.allFinite() || !(options.ridge > 0) || options.max_frames < 1) {
    return absl::InvalidArgumentError(
        "upsampling: displacements must be finite, ridge and max_frames positive");
  }
  // One contiguous block of 3T samples per vertex, from at most max_frames frames: a regression
  // then reads whole columns.
  const Eigen::Index num_frames = std::min<Eigen::Index>(displacements.rows(), options.max_frames);
  MatrixXd samples(3 * num_frames, matrix_.rows());
  for (Eigen::Index i = 0; i < num_frames; ++i) {
    const Eigen::Index t = i * displacements.rows() / num_frames;
    for (Eigen::Index v = 0; v < matrix_.rows(); ++v) {
      samples.block<3, 1>(3 * i, v) = displacements.block<1, 3>(t, 3 * v).transpose();
    }
  }
  const double ridge = options.ridge * samples.squaredNorm() / static_cast<double>(matrix_.rows());
  const std::vector<int> control_of = ControlOfVertex(num_vertices(), control_vertices);
  Matrix refined = matrix_;
  PLEAT_RETURN_IF_ERROR(
      ParallelForPieces(num_vertices(), kBatch, options.num_threads, progress, [&](int v) {
        if (control_of[v] >= 0 || !(ridge > 0)) return;
        const int begin = refined.outerIndexPtr()[v];
        const int m = refined.outerIndexPtr()[v + 1] - begin;
        MatrixXd inputs(samples.rows(), m);
        for (int i = 0; i < m; ++i) {
          inputs.col(i) = samples.col(control_vertices[refined.innerIndexPtr()[begin + i]]);
        }
        // The row is overwritten in place. Its memory belongs to no other row, so no lock is
        // needed.
        Eigen::Map<Eigen::VectorXf> weights(refined.valuePtr() + begin, m);
        const VectorXd prior = weights.cast<double>();
        MatrixXd gram = MatrixXd::Zero(m, m);
        gram.selfadjointView<Eigen::Lower>().rankUpdate(inputs.transpose());
        gram.diagonal().array() += ridge;
        const VectorXd residual = samples.col(v) - inputs * prior;
        const VectorXd change =
            gram.selfadjointView<Eigen::Lower>().llt().solve(inputs.transpose() * residual);
        weights = (prior + change).cast<float>();
      }));
  return RbfUpsampler(std::move(refined));
}

void RbfUpsampler::Apply(const Eigen::Ref<const Eigen::VectorXf>& control,
                         Eigen::VectorXf* full) const {
  full->resize(3 * matrix_.rows());
  for (Eigen::Index v = 0; v < matrix_.rows(); ++v) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (Matrix::InnerIterator entry(matrix_, v); entry; ++entry) {
      sum += entry.value() * control.segment<3>(3 * entry.col());
    }
    full->segment<3>(3 * v) = sum;
  }
}

void RbfUpsampler::Apply(const Eigen::Ref<const VectorXd>& control, VectorXd* full) const {
  full->resize(3 * matrix_.rows());
  for (Eigen::Index v = 0; v < matrix_.rows(); ++v) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Matrix::InnerIterator entry(matrix_, v); entry; ++entry) {
      sum += static_cast<double>(entry.value()) * control.segment<3>(3 * entry.col());
    }
    full->segment<3>(3 * v) = sum;
  }
}

}  // namespace pleat
