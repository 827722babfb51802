// Points are spread over the rest mesh, and their cells' neighbors are the edges: about three for
// each point. The values of all edges in the frames of the training are a matrix of T x 3E numbers;
// for each region, those of the edges that lie in it, weighted by how much they do, give principal
// components. Weights, mean and the last scaling are folded into one matrix and one offset, so that
// a query is one product. The matrix is rounded to 8 bits before the learner sees what it gives.
#include "skin_features_train.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/geometry/surface_cells.h"
#include "pleat/math/pca.h"
#include "pleat/math/spread_rows.h"

namespace pleat {
namespace {

// Values of the edges in some frames, frames x 3E.
Eigen::MatrixXd ValuesOf(const SkinEdges& edges, const Skeleton& skeleton, const PoseTrack& track,
                         const std::vector<Eigen::Index>& frames, int num_threads) {
  Eigen::MatrixXd values(frames.size(), edges.num_values());
  constexpr int kItemFrames = 32;
  const int count = static_cast<int>(frames.size());
  ParallelFor((count + kItemFrames - 1) / kItemFrames, num_threads, [&](int item) {
    SkinEdges::Workspace workspace;
    BoneTransforms transforms;
    Eigen::VectorXf row(edges.num_values());
    for (int i = item * kItemFrames; i < std::min(count, (item + 1) * kItemFrames); ++i) {
      ComputeBoneTransforms(skeleton, track.pose(static_cast<int>(frames[i])), {}, &transforms);
      edges.Compute(transforms, &workspace, row);
      values.row(i) = row.transpose().cast<double>();
    }
  });
  return values;
}

// The edges of a region and, for each, how much it lies in it: the mean share of its ends.
struct RegionEdges {
  std::vector<int> edges;
  std::vector<double> weights;
};

RegionEdges EdgesOf(const SkinEdgesParameters& p, const BodyRegion& region,
                    double smallest_weight) {
  std::vector<double> shares;  // of the points
  for (const int v : p.vertices) {
    const auto found = std::ranges::lower_bound(region.vertices, v);
    const bool has_share = found != region.vertices.end() && *found == v;
    shares.push_back(has_share ? region.weights[found - region.vertices.begin()] : 0);
  }
  RegionEdges result;
  for (size_t e = 0; e < p.edges.size(); ++e) {
    const auto [first, second] = p.edges[e];
    const double weight = .5 * (shares[first] + shares[second]);
    if (!(weight > smallest_weight)) continue;
    result.edges.push_back(static_cast<int>(e));
    result.weights.push_back(weight);
  }
  return result;
}

// The components of one region. values: frames x 3E, centered; center: 3E.
absl::StatusOr<SkinFeaturesParameters::Region> TrainRegion(const Eigen::MatrixXd& values,
                                                           const Eigen::VectorXf& center,
                                                           const RegionEdges& region,
                                                           int max_components, double whitening) {
  const auto num_edges = static_cast<Eigen::Index>(region.edges.size());
  Eigen::VectorXd weights(3 * num_edges), own_center(3 * num_edges);
  Eigen::MatrixXd data(values.rows(), 3 * num_edges);
  for (Eigen::Index e = 0; e < num_edges; ++e) {
    const Eigen::Index first = 3 * static_cast<Eigen::Index>(region.edges[e]);
    weights.segment<3>(3 * e).setConstant(region.weights[e]);
    own_center.segment<3>(3 * e) = center.segment<3>(first).cast<double>();
    data.middleCols<3>(3 * e) = region.weights[e] * values.middleCols<3>(first);
  }
  const PrincipalComponents pca = ComputePca(data, {.max_components = max_components});
  // Where the skin never moves, one component stays zero.
  Eigen::MatrixXd projection = Eigen::MatrixXd::Zero(1, 3 * num_edges);
  if (pca.basis.cols() > 0) {
    const Eigen::VectorXd deviations =
        (pca.scores.colwise().squaredNorm() / double(pca.scores.rows())).cwiseSqrt().transpose();
    const Eigen::VectorXd factors = deviations.array().pow(-whitening);
    // One unit for the region: rows of mean squared norm 1.
    const double unit = deviations.cwiseProduct(factors).norm();
    projection = (factors / unit).asDiagonal() * pca.basis.transpose() * weights.asDiagonal();
  }
  // One plane will do for each column: the learner is trained with the features as they come out.
  const Eigen::VectorXd any_step =
      Eigen::VectorXd::Constant(3 * num_edges, std::numeric_limits<double>::infinity());
  PLEAT_ASSIGN_OR_RETURN(CoefficientFoldBlock block,
                         CoefficientFoldBlock::Round(0, {{0, static_cast<int>(projection.rows())}},
                                                     projection, any_step));
  const Eigen::VectorXd offset = block.Dense() * own_center;
  return SkinFeaturesParameters::Region{region.edges, std::move(block.weights),
                                        offset.cast<float>()};
}

}  // namespace

absl::StatusOr<SkinFeatures> TrainSkinFeatures(const Topology& topology, const Rig& rig,
                                               const PoseTrack& track,
                                               const std::vector<BodyRegion>& regions,
                                               const SkinFeaturesOptions& options) {
  SkinFeaturesParameters parameters;
  const SurfaceCells cells = MakeSurfaceCells(topology, rig.rest_positions, options.num_points);
  parameters.edges.vertices = cells.centers;
  for (const auto& [first, second] : cells.neighbors) {
    const double length = (rig.rest_positions.col(cells.centers[first]) -
                           rig.rest_positions.col(cells.centers[second]))
                              .norm();
    parameters.edges.edges.push_back({first, second});
    parameters.edges.lengths.push_back(static_cast<float>(length));
  }
  PLEAT_ASSIGN_OR_RETURN(const SkinEdges edges, SkinEdges::Create(rig, parameters.edges));
  Eigen::MatrixXd values =
      ValuesOf(edges, rig.skeleton, track, SpreadRows(track.num_frames(), options.max_frames),
               options.num_threads);
  parameters.center = values.colwise().mean().transpose().cast<float>();
  values.rowwise() -= parameters.center.cast<double>().transpose();
  parameters.regions.resize(regions.size());
  std::vector<absl::Status> statuses(regions.size());
  ParallelFor(static_cast<int>(regions.size()), options.num_threads, [&](int r) {
    const RegionEdges own = EdgesOf(parameters.edges, regions[r], options.smallest_weight);
    if (own.edges.empty()) return;
    auto region = TrainRegion(values, parameters.center, own, regions[r].max_skin_features,
                              options.whitening);
    statuses[r] = region.status();
    if (region.ok()) parameters.regions[r] = *std::move(region);
  });
  for (const absl::Status& status : statuses) PLEAT_RETURN_IF_ERROR(status);
  return SkinFeatures::FromParameters(rig, std::move(parameters));
}

}  // namespace pleat
