#include "pleat/rigging/heat_weights.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/mesh/bounds.h"
#include "pleat/rigging/bone_visibility.h"

namespace pleat {
namespace {

constexpr double kToleranceFraction = 0.002;  // share of the diagonal: visibility, about 4 mm
constexpr double kLeastWeight = .01;
constexpr double kMinDistanceFraction = 1e-4;  // share of the diagonal: keeps c / d^2 finite

// Returns a third of the area of the triangles around each vertex, W.
Eigen::VectorXd VertexAreas(const SolidSurface& surface) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(surface.positions.cols());
  for (int f = 0; f < surface.triangles.cols(); ++f) {
    const Eigen::Vector3d a = surface.positions.col(surface.triangles(0, f));
    const Eigen::Vector3d ab = surface.positions.col(surface.triangles(1, f)) - a;
    const Eigen::Vector3d ac = surface.positions.col(surface.triangles(2, f)) - a;
    const double third = ab.cross(ac).norm() / 6;
    for (int k = 0; k < 3; ++k) areas[surface.triangles(k, f)] += third;
  }
  return areas;
}

// Returns -L, the positive semi-definite cotangent matrix, as triplets.
std::vector<Eigen::Triplet<double>> CotangentTriplets(const SolidSurface& surface) {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(12 * surface.triangles.cols() + surface.positions.cols());
  for (int f = 0; f < surface.triangles.cols(); ++f) {
    Eigen::Vector3d corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = surface.positions.col(surface.triangles(k, f));
    const double longest =
        std::max({(corners[1] - corners[0]).squaredNorm(), (corners[2] - corners[1]).squaredNorm(),
                  (corners[0] - corners[2]).squaredNorm()});
    // One floor for the three cotangents of a sliver keeps its matrix semi-definite; a floor for
    // each would not.
    const double doubled_area =
        std::max((corners[1] - corners[0]).cross(corners[2] - corners[0]).norm(), 1e-3 * longest);
    for (int k = 0; k < 3; ++k) {
      const int i = surface.triangles((k + 1) % 3, f), j = surface.triangles((k + 2) % 3, f);
      const double half_cotangent =
          0.5 * (corners[(k + 1) % 3] - corners[k]).dot(corners[(k + 2) % 3] - corners[k]) /
          doubled_area;
      triplets.emplace_back(i, i, half_cotangent);
      triplets.emplace_back(j, j, half_cotangent);
      triplets.emplace_back(i, j, -half_cotangent);
      triplets.emplace_back(j, i, -half_cotangent);
    }
  }
  return triplets;
}

// Heat reaches everywhere, but nobody paints weights under a hundredth.
void DropTails(Eigen::MatrixXd::RowXpr weights) {
  const double least = kLeastWeight * weights.sum();
  weights = (weights.array() < least).select(0, weights);
}

// Gives components none of whose vertices sees a bone their nearest bones, through the air. Such a
// component would have H = 0 everywhere and make the system singular.
void HeatColdComponents(const SolidSurface& surface, const Skeleton& skeleton,
                        const Eigen::Matrix3Xd& joints, std::vector<NearestBones>* nearest,
                        HeatWeightsSummary* summary) {
  std::vector<char> is_warm(surface.report.num_components, 0);
  for (int f = 0; f < surface.triangles.cols(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (!(*nearest)[surface.triangles(k, f)].bones.empty()) {
        is_warm[surface.triangle_components[f]] = 1;
      }
    }
  }
  for (int f = 0; f < surface.triangles.cols(); ++f) {
    if (is_warm[surface.triangle_components[f]]) continue;
    for (int k = 0; k < 3; ++k) {
      const int v = surface.triangles(k, f);
      if (!(*nearest)[v].bones.empty()) continue;
      (*nearest)[v] = FindNearestBones(skeleton, joints, surface.positions.col(v));
    }
  }
  summary->num_cold_components = static_cast<int>(std::count(is_warm.begin(), is_warm.end(), 0));
}

}  // namespace

absl::StatusOr<Eigen::MatrixXd> SolveHeatEquilibrium(
    const SolidSurface& surface, const InsideTest& inside, const Skeleton& skeleton,
    const Eigen::Matrix3Xd& joints, const HeatWeightsOptions& options, HeatWeightsSummary* summary,
    const Progress& progress) {
  HeatWeightsSummary local_summary;
  if (!summary) summary = &local_summary;
  *summary = {};
  if (skeleton.num_joints() < 2 || joints.cols() != skeleton.num_joints()) {
    return absl::InvalidArgumentError(absl::StrCat("heat weights need a bone: the skeleton has ",
                                                   skeleton.num_joints(), " joints, ",
                                                   joints.cols(), " positions"));
  }
  const int num_vertices = static_cast<int>(surface.positions.cols());
  const double diagonal =
      options.body_diagonal > 0 ? options.body_diagonal : BoundsDiagonal(surface.positions);
  const double tolerance = std::max(kToleranceFraction * diagonal, options.surface_tolerance);
  std::vector<NearestBones> nearest(num_vertices);
  ParallelFor(num_vertices, options.num_threads, [&](int v) {
    if (progress.cancelled()) return;
    nearest[v] = FindNearestBones(skeleton, joints, surface.positions.col(v), &inside, tolerance);
  });
  PLEAT_RETURN_IF_ERROR(progress.Report(0.7));
  for (const NearestBones& bones : nearest) summary->num_hidden_vertices += bones.bones.empty();
  HeatColdComponents(surface, skeleton, joints, &nearest, summary);

  const Eigen::VectorXd areas = VertexAreas(surface);
  std::vector<Eigen::Triplet<double>> triplets = CotangentTriplets(surface);
  Eigen::MatrixXd heat = Eigen::MatrixXd::Zero(num_vertices, skeleton.num_joints());
  for (int v = 0; v < num_vertices; ++v) {
    if (nearest[v].bones.empty()) continue;
    const double distance = std::max(nearest[v].distance, kMinDistanceFraction * diagonal);
    const double transfer = options.heat_constant * areas[v] / (distance * distance);
    triplets.emplace_back(v, v, transfer);
    for (int b : nearest[v].bones) heat(v, b) = transfer / nearest[v].bones.size();
  }
  Eigen::SparseMatrix<double> system(num_vertices, num_vertices);
  system.setFromTriplets(triplets.begin(), triplets.end());
  // One factorization serves all bones: they differ in the right side only.
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(system);
  if (solver.info() != Eigen::Success) {
    return absl::FailedPreconditionError("the heat equilibrium of the surface could not be solved");
  }
  PLEAT_RETURN_IF_ERROR(progress.Report(0.9));
  const Eigen::MatrixXd weights = solver.solve(heat);
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return weights;
}

absl::StatusOr<SkinWeights> WeightsOfInput(const SolidSurface& surface,
                                           const Eigen::MatrixXd& surface_weights,
                                           const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                           const Skeleton& skeleton,
                                           const Eigen::Matrix3Xd& joints) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(positions.cols(), surface_weights.cols());
  for (int v = 0; v < positions.cols(); ++v) {
    const int source = surface.vertex_from_input[v];
    if (source >= 0) {
      dense.row(v) = surface_weights.row(source);
      DropTails(dense.row(v));
    } else {
      for (int b : FindNearestBones(skeleton, joints, positions.col(v)).bones) {
        dense(v, b) = 1;
      }
    }
  }
  return SkinWeights::FromDense(dense);
}

absl::StatusOr<SkinWeights> WeightsFromShell(const BodyShell& shell, const TriangleTree& tree,
                                             const Eigen::MatrixXd& shell_weights,
                                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                             int num_threads) {
  Eigen::MatrixXd dense(positions.cols(), shell_weights.cols());
  PLEAT_RETURN_IF_ERROR(
      ParallelForPieces(static_cast<int>(positions.cols()), 4096, num_threads, {}, [&](int v) {
        const SurfacePoint nearest = tree.ClosestPoint(positions.col(v));
        const Eigen::Vector3i corners = shell.triangles.col(nearest.triangle);
        Eigen::Vector3d shares;  // by the areas opposite to the corners
        for (int k = 0; k < 3; ++k) {
          const Eigen::Vector3d a = shell.positions.col(corners[(k + 1) % 3]);
          const Eigen::Vector3d b = shell.positions.col(corners[(k + 2) % 3]);
          shares[k] = (a - nearest.position).cross(b - nearest.position).norm();
        }
        const double sum = shares.sum();
        if (!(sum > 0)) shares.setOnes();
        shares /= shares.sum();
        dense.row(v) = shares[0] * shell_weights.row(corners[0]) +
                       shares[1] * shell_weights.row(corners[1]) +
                       shares[2] * shell_weights.row(corners[2]);
        DropTails(dense.row(v));
      }));
  return SkinWeights::FromDense(dense);
}

absl::StatusOr<SkinWeights> ComputeHeatWeights(const Topology& topology,
                                               const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                               const Skeleton& skeleton,
                                               const HeatWeightsOptions& options,
                                               HeatWeightsSummary* summary,
                                               const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(const SolidSurface surface, PrepareSolidSurface(topology, positions));
  const TriangleTree tree(surface.positions, surface.triangles);
  const WindingNumber winding_number(tree);
  const Eigen::Matrix3Xd joints = skeleton.RestPositions();
  PLEAT_ASSIGN_OR_RETURN(const Eigen::MatrixXd weights,
                         SolveHeatEquilibrium(surface, {&tree, &winding_number, nullptr}, skeleton,
                                              joints, options, summary, progress));
  return WeightsOfInput(surface, weights, positions, skeleton, joints);
}

}  // namespace pleat
