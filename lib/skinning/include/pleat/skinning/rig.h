// A rig, which is a skeleton, skinning weights and the mesh in the rest pose; and linear blend
// skinning.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/skeleton/pose.h"
#include "pleat/skeleton/skeleton.h"
#include "pleat/skinning/skin_weights.h"

namespace pleat {

struct Rig {
  Skeleton skeleton;
  SkinWeights weights;
  Eigen::Matrix3Xd rest_positions;  // 3 x V, meters, rest pose
  // V, mean 1: how much each vertex counts in a pose fit, or empty when all count alike. Cloth says
  // little about the bones below it.
  Eigen::VectorXf fit_weights{};

  double fit_weight(Eigen::Index v) const {
    return fit_weights.size() == 0 ? 1 : double{fit_weights[v]};
  }
};

// Linear blend skinning: column v of `positions` = sum_b w_vb (linear_b rest_v + translation_b).
// rest, positions: 3 x V. It does not allocate when `positions` has the right size.
void SkinVertices(const SkinWeights& weights, const Eigen::Ref<const Eigen::Matrix3Xd>& rest,
                  const BoneTransforms& transforms, Eigen::Matrix3Xd* positions);

// Computes the rotation of every vertex's own blend (a unit quaternion: the weighted mean of its
// bones' rotations, with signs aligned with the strongest bone), the axes of "local" details
// (docs/method/details.md#axes). Only for the vertices `vertices`, in that order.
void BlendRotations(const SkinWeights& weights, const std::vector<int>& vertices,
                    const BoneTransforms& transforms, std::vector<Eigen::Quaterniond>* rotations);

}  // namespace pleat
