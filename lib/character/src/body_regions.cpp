#include "body_regions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pleat {
namespace {

// Leaves out the regions that no control vertex has a share in.
std::vector<BodyRegion> WithControl(std::vector<BodyRegion> regions, int num_vertices,
                                    const std::vector<int>& control_vertices) {
  std::vector<char> is_control(static_cast<size_t>(num_vertices), 0);
  for (const int v : control_vertices) is_control[v] = 1;
  std::erase_if(regions, [&](const BodyRegion& region) {
    return std::ranges::none_of(region.vertices, [&](int v) { return is_control[v] != 0; });
  });
  return regions;
}

// The points that are clustered: rest positions, and skinning weights as so many meters that bones
// keep vertices apart which only lie near each other. One column for each vertex.
Eigen::MatrixXf ClusterPoints(const Rig& rig) {
  constexpr float kMetersOfWeight = .25f;
  const int num_vertices = rig.weights.num_vertices();
  Eigen::MatrixXf points = Eigen::MatrixXf::Zero(3 + rig.weights.num_joints(), num_vertices);
  points.topRows<3>() = rig.rest_positions.cast<float>();
  for (int v = 0; v < num_vertices; ++v) {
    const VertexInfluences& influences = rig.weights.vertex(v);
    for (int k = 0; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
      points(3 + influences.bones[k], v) += kMetersOfWeight * influences.weights[k];
    }
  }
  return points;
}

// Squared distances of a point to all centers.
Eigen::VectorXf Distances(const Eigen::MatrixXf& centers, const Eigen::VectorXf& point) {
  return (centers.colwise() - point).colwise().squaredNorm().transpose();
}

// Farthest-point sampling, then a few rounds of k-means.
Eigen::MatrixXf FindCenters(const Eigen::MatrixXf& points, int count) {
  constexpr int kRounds = 8;
  Eigen::MatrixXf centers(points.rows(), 0);
  Eigen::VectorXf nearest =
      Eigen::VectorXf::Constant(points.cols(), std::numeric_limits<float>::infinity());
  for (Eigen::Index next = 0; centers.cols() < count && nearest[next] > 0;) {
    centers.conservativeResize(Eigen::NoChange, centers.cols() + 1);
    centers.rightCols<1>() = points.col(next);
    nearest = nearest.cwiseMin(Distances(points, points.col(next)));
    nearest.maxCoeff(&next);
  }
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(centers.rows(), centers.cols());
    Eigen::VectorXd sizes = Eigen::VectorXd::Zero(centers.cols());
    for (Eigen::Index v = 0; v < points.cols(); ++v) {
      Eigen::Index own = 0;
      Distances(centers, points.col(v)).minCoeff(&own);
      sums.col(own) += points.col(v).cast<double>();
      sizes[own] += 1;
    }
    for (Eigen::Index k = 0; k < centers.cols(); ++k) {
      if (sizes[k] > 0) centers.col(k) = (sums.col(k) / sizes[k]).cast<float>();
    }
  }
  return centers;
}

// The mean squared distance of the points to their centers: how wide shares fall off.
double MeanSquare(const Eigen::MatrixXf& points, const Eigen::MatrixXf& centers) {
  double sum = 0;
  for (Eigen::Index v = 0; v < points.cols(); ++v) {
    sum += Distances(centers, points.col(v)).minCoeff();
  }
  return sum / static_cast<double>(points.cols());
}

// The shares of one point: at most four, of at least .02 of the largest before they sum to 1.
std::vector<std::pair<int, float>> SharesOf(const Eigen::VectorXf& distances, double mean_square) {
  constexpr double kSmallest = .02;
  constexpr size_t kMost = 4;
  const double nearest = distances.minCoeff();
  std::vector<std::pair<int, float>> shares;
  for (Eigen::Index k = 0; k < distances.size(); ++k) {
    const double share = mean_square > 0 ? std::exp(-.5 * (distances[k] - nearest) / mean_square)
                                         : static_cast<double>(distances[k] == nearest);
    if (share >= kSmallest) shares.emplace_back(static_cast<int>(k), static_cast<float>(share));
  }
  std::stable_sort(shares.begin(), shares.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  if (shares.size() > kMost) shares.resize(kMost);
  float sum = 0;
  for (const auto& [patch, share] : shares) sum += share;
  for (auto& [patch, share] : shares) share /= sum;
  return shares;
}

// The bones that move a patch by more than a tenth, or else the one that moves it most.
std::set<int> BonesOf(const BodyRegion& region, const SkinWeights& weights) {
  constexpr double kSmallest = .1;
  std::vector<double> sums(static_cast<size_t>(weights.num_joints()), 0);
  double total = 0;
  for (size_t i = 0; i < region.vertices.size(); ++i) {
    const VertexInfluences& influences = weights.vertex(region.vertices[i]);
    for (int k = 0; k < kMaxInfluences; ++k) {
      sums[influences.bones[k]] += double(region.weights[i]) * influences.weights[k];
    }
    total += region.weights[i];
  }
  std::set<int> bones;
  for (size_t b = 0; b < sums.size(); ++b) {
    if (sums[b] > kSmallest * total) bones.insert(static_cast<int>(b));
  }
  if (bones.empty()) {
    bones.insert(static_cast<int>(std::max_element(sums.begin(), sums.end()) - sums.begin()));
  }
  return bones;
}

}  // namespace

std::vector<BodyRegion> BoneRegions(const Rig& rig, const std::vector<int>& control_vertices) {
  std::vector<BodyRegion> regions(static_cast<size_t>(rig.skeleton.num_joints()));
  for (int v = 0; v < rig.weights.num_vertices(); ++v) {
    const VertexInfluences& influences = rig.weights.vertex(v);
    for (int k = 0; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
      BodyRegion& region = regions[influences.bones[k]];
      // A rig of a user may name a bone twice.
      if (!region.vertices.empty() && region.vertices.back() == v) {
        region.weights.back() += influences.weights[k];
        continue;
      }
      region.vertices.push_back(v);
      region.weights.push_back(influences.weights[k]);
    }
  }
  for (size_t b = 0; b < regions.size(); ++b) regions[b].bones = {static_cast<int>(b)};
  return WithControl(std::move(regions), rig.weights.num_vertices(), control_vertices);
}

std::vector<BodyRegion> PatchRegions(const Rig& rig, const std::vector<int>& control_vertices,
                                     int count) {
  const Eigen::MatrixXf points = ClusterPoints(rig);
  const Eigen::MatrixXf centers = FindCenters(points, count);
  const double mean_square = MeanSquare(points, centers);
  std::vector<BodyRegion> regions(static_cast<size_t>(centers.cols()));
  for (Eigen::Index v = 0; v < points.cols(); ++v) {
    for (const auto& [patch, share] : SharesOf(Distances(centers, points.col(v)), mean_square)) {
      regions[patch].vertices.push_back(static_cast<int>(v));
      regions[patch].weights.push_back(share);
    }
  }
  for (BodyRegion& region : regions) {
    if (!region.vertices.empty()) region.bones = BonesOf(region, rig.weights);
  }
  return WithControl(std::move(regions), rig.weights.num_vertices(), control_vertices);
}

}  // namespace pleat
