#include "pleat/skinning/rig.h"

#include <cassert>

namespace pleat {

void SkinVertices(const SkinWeights& weights, const Eigen::Ref<const Eigen::Matrix3Xd>& rest,
                  const BoneTransforms& transforms, Eigen::Matrix3Xd* positions) {
  assert(rest.cols() == weights.num_vertices());
  positions->resize(3, rest.cols());
  for (int v = 0; v < weights.num_vertices(); ++v) {
    const VertexInfluences& influences = weights.vertex(v);
    const Eigen::Vector3d point = rest.col(v);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int k = 0; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
      const int b = influences.bones[k];
      sum += influences.weights[k] * (transforms.linear[b] * point + transforms.translation[b]);
    }
    positions->col(v) = sum;
  }
}

void BlendRotations(const SkinWeights& weights, const std::vector<int>& vertices,
                    const BoneTransforms& transforms, std::vector<Eigen::Quaterniond>* rotations) {
  // Rigs have at most 256 joints, so the quaternions of the bones fit on the stack.
  constexpr int kMaxStackJoints = 256;
  const int num_joints = static_cast<int>(transforms.rotation.size());
  assert(num_joints <= kMaxStackJoints);
  Eigen::Vector4d bone_rotations[kMaxStackJoints];
  for (int b = 0; b < num_joints; ++b) {
    bone_rotations[b] = Eigen::Quaterniond(transforms.rotation[b]).coeffs();
  }
  rotations->resize(vertices.size());
  for (size_t i = 0; i < vertices.size(); ++i) {
    const VertexInfluences& influences = weights.vertex(vertices[i]);
    const Eigen::Vector4d& strongest = bone_rotations[influences.bones[0]];
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (int k = 0; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
      const Eigen::Vector4d& rotation = bone_rotations[influences.bones[k]];
      sum += (strongest.dot(rotation) < 0 ? -1.0 : 1.0) * influences.weights[k] * rotation;
    }
    (*rotations)[i].coeffs() = sum.normalized();
  }
}

}  // namespace pleat
