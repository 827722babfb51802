#include "joint_step.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace pleat {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// Adds every bone's rows to those of its parent. Parents have lower indices, so counting down
// visits leaves first and each sum is complete when it is passed on.
template <typename Add>
void SumOverSubtrees(const Skeleton& skeleton, const Add& add_to_parent) {
  for (int b = skeleton.num_joints() - 1; b >= 1; --b) {
    if (skeleton.parent(b) >= 1) add_to_parent(b, skeleton.parent(b));
  }
}

}  // namespace

SubtreeMoments ComputeSubtreeMoments(const RigMoments& moments, const Skeleton& skeleton) {
  const int num_joints = moments.num_joints;
  SubtreeMoments subtree;
  subtree.products = MatrixXd::Zero(num_joints, num_joints);
  subtree.weighted.assign(num_joints, MatrixXd::Zero(3, num_joints));
  for (int k = 1; k < num_joints; ++k) {
    for (int l = 1; l < num_joints; ++l) {
      const Eigen::Matrix4d& block = moments.products[k * num_joints + l];
      subtree.products(k, l) = block(3, 3);
      subtree.weighted[k].col(l) = block.topRightCorner<3, 1>();
    }
  }
  SumOverSubtrees(skeleton, [&](int b, int parent) {
    subtree.products.row(parent) += subtree.products.row(b);
    subtree.weighted[parent] += subtree.weighted[b];
  });
  SumOverSubtrees(skeleton, [&](int b, int parent) {
    subtree.products.col(parent) += subtree.products.col(b);
  });
  return subtree;
}

JointSystem ComputeJointSystem(const RigMoments& moments, const SubtreeMoments& subtree,
                               const Skeleton& skeleton, const FrameMoments& frame,
                               const ChainPose& pose) {
  const int num_joints = moments.num_joints;
  JointSystem system{MatrixXd::Zero(3 * num_joints, 3 * num_joints),
                     Eigen::VectorXd::Zero(3 * num_joints)};
  std::vector<Vector3d> observed(num_joints, Vector3d::Zero());  // sum_i S_ic y_i
  Vector3d total = Vector3d::Zero();  // sum_i z_i, z_i = y_i - sum_b W_ib R_b u_i
  for (int b = 1; b < num_joints; ++b) {
    observed[b] = frame.cross[b].row(3).transpose();
    total -= pose.rotation(b) * moments.weighted[b].topRightCorner<3, 1>();
  }
  SumOverSubtrees(skeleton, [&](int b, int parent) { observed[parent] += observed[b]; });

  MatrixXd to_translation = MatrixXd::Zero(3 * num_joints, 3);
  std::vector<Matrix3d> difference(num_joints);
  for (int c = 1; c < num_joints; ++c) {
    const int j = skeleton.parent(c);
    difference[c] = pose.rotation(j) - pose.rotation(c);
    Vector3d target = observed[c];
    double subtree_weight = 0;
    for (int b = 1; b < num_joints; ++b) {
      target -= pose.rotation(b) * subtree.weighted[c].col(b);
      if (skeleton.parent(b) == 0) subtree_weight += subtree.products(c, b);  // weights sum to 1
    }
    system.right.segment<3>(3 * j) += difference[c].transpose() * target;
    to_translation.middleRows<3>(3 * j) += subtree_weight * difference[c].transpose();
    for (int d = 1; d <= c; ++d) {
      const int k = skeleton.parent(d);
      const Matrix3d block = subtree.products(c, d) * difference[c].transpose() * difference[d];
      system.matrix.block<3, 3>(3 * j, 3 * k) += block;
      if (d < c) system.matrix.block<3, 3>(3 * k, 3 * j) += block.transpose();
    }
  }
  // The Schur complement of the translations: each frame has V times the identity for its own.
  system.matrix -= to_translation * to_translation.transpose() / moments.num_vertices;
  system.right -= to_translation * total / moments.num_vertices;
  return system;
}

Eigen::Matrix3Xd SolveJoints(const std::vector<JointSystem>& frames, const RigMoments& moments,
                             const Skeleton& skeleton, const Eigen::Matrix3Xd& first, double prior,
                             const std::vector<int>& locked) {
  JointSystem sum = frames[0];
  for (size_t t = 1; t < frames.size(); ++t) {
    sum.matrix += frames[t].matrix;
    sum.right += frames[t].right;
  }
  int num_inner = 0;
  for (int j = 0; j < skeleton.num_joints(); ++j) num_inner += !skeleton.children(j).empty();
  const double stiffness = prior * sum.matrix.trace() / (3.0 * std::max(1, num_inner));
  if (!(stiffness > 0)) return first;  // nothing bends
  const Eigen::Matrix3Xd centered = first.colwise() - moments.center;
  sum.matrix.diagonal().array() += stiffness;
  sum.right += stiffness * centered.reshaped();
  for (const int j : locked) {  // known, hence moved to the right-hand side
    sum.right -= sum.matrix.middleCols<3>(3 * j) * centered.col(j);
    sum.matrix.middleCols<3>(3 * j).setZero();
    sum.matrix.middleRows<3>(3 * j).setZero();
    sum.matrix.block<3, 3>(3 * j, 3 * j).setIdentity();
  }
  for (const int j : locked) sum.right.segment<3>(3 * j) = centered.col(j);
  const Eigen::VectorXd solved = sum.matrix.llt().solve(sum.right);
  Eigen::Matrix3Xd joints =
      Eigen::Matrix3Xd(solved.reshaped(3, skeleton.num_joints())).colwise() + moments.center;
  for (const int j : locked) joints.col(j) = first.col(j);  // exactly, without rounding
  return joints;
}

}  // namespace pleat
