// How a skin stretches and bends: edges between a few points of the skinned mesh, each in the axes
// of its first point (docs/method/learner.md#skinned-edges).
//
//   e_ij = R_i^T (s_j - s_i) / l_ij
//
// s: skinned positions without details; R_i: the rotation of the blend at point i (BlendRotations).
// Turning or moving the whole body changes nothing.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// What a model file holds of them; the rest comes from its rig.
struct SkinEdgesParameters {
  std::vector<int> vertices;              // P points of the mesh
  std::vector<std::array<int, 2>> edges;  // E pairs of points, as places in `vertices`
  std::vector<float> lengths;             // E: l, meters, above 0
};

// Immutable: threads share it.
class SkinEdges {
 public:
  // The memory of one thread, reused without allocation.
  struct Workspace {
    Eigen::Matrix3Xd positions;                 // 3 x P
    std::vector<Eigen::Quaterniond> rotations;  // P
  };

  // kInvalidArgument when a vertex, an edge or a length is out of range.
  static absl::StatusOr<SkinEdges> Create(const Rig& rig, SkinEdgesParameters parameters);

  const SkinEdgesParameters& parameters() const { return parameters_; }
  int num_values() const { return 3 * static_cast<int>(parameters_.edges.size()); }
  size_t memory_bytes() const;

  // Writes the 3 E values of a pose, without an allocation after the first call. transforms: of the
  // rig's skeleton, without stretched bones.
  void Compute(const BoneTransforms& transforms, Workspace* workspace,
               Eigen::Ref<Eigen::VectorXf> values) const;

 private:
  SkinEdges(SkinEdgesParameters parameters, SkinWeights weights, Eigen::Matrix3Xd rest);

  SkinEdgesParameters parameters_;
  SkinWeights weights_;          // of the points
  Eigen::Matrix3Xd rest_;        // 3 x P
  std::vector<int> all_points_;  // 0 to P - 1
};

}  // namespace pleat
