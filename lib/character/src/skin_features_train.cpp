// Points are spread over the rest mesh, and their cells' neighbors are the edges: about three for
// each point. The values of all edges in the frames of the training are a matrix of T x 3E numbers;
// for each region, those of the edges that lie in it, weighted by how much they do, give principal
// components. Weights, mean and the last scaling are folded into one matrix and one offset, so that
// a query is one product.
#include "skin_features_train.h"

#include <algorithm>
#include <cmath>

#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/geometry/surface_cells.h"
#include "pleat/gp/scaling.h"
#include "pleat/math/pca.h"

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

// The components of one region. values: frames x 3E.
SkinFeaturesParameters::Region TrainRegion(const Eigen::MatrixXd& values, const RegionEdges& region,
                                           int max_components, double whitening) {
  const auto num_edges = static_cast<Eigen::Index>(region.edges.size());
  Eigen::VectorXd weights(3 * num_edges);
  Eigen::MatrixXd data(values.rows(), 3 * num_edges);
  for (Eigen::Index e = 0; e < num_edges; ++e) {
    weights.segment<3>(3 * e).setConstant(region.weights[e]);
    data.middleCols<3>(3 * e) =
        region.weights[e] * values.middleCols<3>(3 * static_cast<Eigen::Index>(region.edges[e]));
  }
  const PrincipalComponents pca = ComputePca(data, {.max_components = max_components});
  SkinFeaturesParameters::Region result{region.edges, {}, {}};
  if (pca.basis.cols() == 0) {  // the skin never moves here: one component that stays zero
    result.weights = Eigen::MatrixXf::Zero(3 * num_edges, 1);
    result.offset = Eigen::VectorXf::Zero(1);
    return result;
  }
  const Eigen::VectorXd deviations =
      (pca.scores.colwise().squaredNorm() / double(pca.scores.rows())).cwiseSqrt().transpose();
  const Eigen::VectorXd factors = deviations.array().pow(-whitening);
  // One unit for the region: rows of mean squared norm 1.
  const double unit = deviations.cwiseProduct(factors).norm();
  const Eigen::MatrixXd projection =
      weights.asDiagonal() * pca.basis * (factors / unit).asDiagonal();
  result.weights = projection.cast<float>();
  result.offset =
      (pca.mean.transpose() * pca.basis * (factors / unit).asDiagonal()).transpose().cast<float>();
  return result;
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
  const Eigen::MatrixXd values =
      ValuesOf(edges, rig.skeleton, track, SpreadRows(track.num_frames(), options.max_frames),
               options.num_threads);
  parameters.regions.resize(regions.size());
  ParallelFor(static_cast<int>(regions.size()), options.num_threads, [&](int r) {
    const RegionEdges own = EdgesOf(parameters.edges, regions[r], options.smallest_weight);
    if (own.edges.empty()) return;
    parameters.regions[r] =
        TrainRegion(values, own, regions[r].max_skin_features, options.whitening);
  });
  return SkinFeatures::FromParameters(rig, std::move(parameters));
}

}  // namespace pleat
