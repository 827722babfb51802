#include "detail_regions.h"

#include <algorithm>
#include <cassert>
#include <set>
#include <utility>

#include "pleat/skeleton/pose_features.h"

namespace pleat {
namespace {

// Says whether two bones share a joint: a parent and its child do, and children of one parent.
bool AreNeighbors(const Skeleton& skeleton, int a, int b) {
  return skeleton.parent(a) == b || skeleton.parent(b) == a ||
         skeleton.parent(a) == skeleton.parent(b);
}

// Returns `bones` together with their neighbors.
std::set<int> Grown(const Skeleton& skeleton, const std::set<int>& bones) {
  std::set<int> grown = bones;
  for (int candidate = 1; candidate < skeleton.num_joints(); ++candidate) {
    for (const int bone : bones) {
      if (AreNeighbors(skeleton, bone, candidate)) grown.insert(candidate);
    }
  }
  return grown;
}

// Returns the columns of the feature row that belong to `bone` in pose `h` of the history. The root
// has no features and must not be asked for.
std::vector<int> ColumnsOf(int h, int bone, int num_joints, const TrainOptions& options) {
  const int values = NumCoordinates(options.rotations);
  std::vector<int> columns;
  for (int i = 0; i < values; ++i) {
    columns.push_back((h * (num_joints - 1) + bone - 1) * values + i);
  }
  return columns;
}

// Returns the columns that belong to `bones` in every pose of the history.
std::vector<int> ColumnsOf(const std::set<int>& bones, int num_joints,
                           const TrainOptions& options) {
  std::vector<int> columns;
  for (int h = 0; h < options.history; ++h) {
    for (const int bone : bones) {
      const std::vector<int> more = ColumnsOf(h, bone, num_joints, options);
      columns.insert(columns.end(), more.begin(), more.end());
    }
  }
  return columns;
}

// Returns a region's shares of the details of the control vertices, times `share`.
DetailRegion SharesOfControl(const BodyRegion& region, const std::vector<int>& control_vertices,
                             double share) {
  DetailRegion result;
  std::vector<double> weights;
  size_t i = 0;
  for (size_t c = 0; c < control_vertices.size(); ++c) {
    while (i < region.vertices.size() && region.vertices[i] < control_vertices[c]) ++i;
    if (i == region.vertices.size()) break;
    if (region.vertices[i] != control_vertices[c]) continue;
    for (int axis = 0; axis < 3; ++axis) {
      result.rows.push_back(3 * static_cast<int>(c) + axis);
      weights.push_back(share * region.weights[i]);
    }
  }
  result.weights =
      Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
  return result;
}

}  // namespace

std::vector<DetailRegion> DetailRegions(const std::vector<BodyRegion>& body,
                                        const Skeleton& skeleton,
                                        const std::vector<int>& control_vertices, double share,
                                        const TrainOptions& options) {
  const int num_joints = skeleton.num_joints();
  std::set<int> all;
  for (int bone = 1; bone < num_joints; ++bone) all.insert(bone);
  std::vector<DetailRegion> regions;
  for (const BodyRegion& part : body) {
    DetailRegion region = SharesOfControl(part, control_vertices, share);
    region.max_components = part.max_components;
    for (std::set<int> moving : {all, Grown(skeleton, part.bones), part.bones}) {
      moving.erase(0);  // the root moves vertices but has no features
      if (moving.empty()) continue;
      std::vector<int> columns = ColumnsOf(moving, num_joints, options);
      const auto& sets = region.feature_sets;
      if (std::find(sets.begin(), sets.end(), columns) != sets.end()) continue;
      region.feature_sets.push_back(std::move(columns));
    }
    regions.push_back(std::move(region));
  }
  return regions;
}

void AddSkinFeatureSets(const SkinFeatures& features, int first_column,
                        std::vector<DetailRegion>* regions) {
  assert(features.num_regions() == static_cast<int>(regions->size()));
  for (int r = 0; r < features.num_regions(); ++r) {
    std::vector<int> columns;
    for (int i = features.region_begin(r); i < features.region_end(r); ++i) {
      columns.push_back(first_column + i);
    }
    if (!columns.empty()) (*regions)[r].feature_sets.push_back(std::move(columns));
  }
}

std::vector<std::vector<int>> FeatureGroups(int num_joints, const TrainOptions& options) {
  std::vector<std::vector<int>> groups;
  for (int h = 0; h < options.history; ++h) {
    for (int bone = 1; bone < num_joints; ++bone) {
      groups.push_back(ColumnsOf(h, bone, num_joints, options));
    }
  }
  return groups;
}

}  // namespace pleat
