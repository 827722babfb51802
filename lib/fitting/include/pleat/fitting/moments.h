// Moments of a rig and of a frame: all that a pose fit needs to know about the vertices
// (docs/method/fit.md#moments). Computed once, they make the cost of a solver iteration independent
// of V.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/skeleton/skeleton.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// Once per rig. u_i = [rest position relative to `center`; 1], W the skinning weights (rows
// normalized to sum 1). Independent of the joints, so joints can be refined against it.
struct RigMoments {
  int num_joints = 0;
  double num_vertices = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // mean rest position, meters
  // U_kl = sum_i W_ik W_il u_i u_i^T at [k * num_joints + l]; blocks of bone 0 are zero.
  std::vector<Eigen::Matrix4d> products;
  // sum_i W_ik u_i u_i^T = sum_l U_kl.
  std::vector<Eigen::Matrix4d> weighted;
};

// Once per frame, from the only loop over vertices. Positions are relative to `center`.
struct FrameMoments {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // mean position of the frame, meters
  std::vector<Eigen::Matrix<double, 4, 3>> cross;    // Y_k = sum_i W_ik u_i y_i^T, per bone
  double sum_squares = 0;                            // sum_i |y_i|^2
};

RigMoments ComputeRigMoments(const Rig& rig);

// `positions`: 3 x V, meters (float32, as sequences hold them); `rig_moments` of the same rig.
FrameMoments ComputeFrameMoments(const Rig& rig, const RigMoments& rig_moments,
                                 const Eigen::Matrix3Xf& positions);

// The moments seen through the joint chain. With world rotations R_a of the bones and the root
// position r, linear blend skinning of a chain with pivots is linear in them:
//   v_i = r + sum_a R_a g_ia,   g_ia = W_ia (u_i - q_parent(a)) + S_ia (q_a - q_parent(a)),
// S_ia the summed weights of the strict descendants of a. Entry a = 0 (the root has no bone) is 0.
struct ChainMoments {
  int num_joints = 0;
  double num_vertices = 0;
  Eigen::MatrixXd gram;   // 3J x 3J, block ab = sum_i g_ia g_ib^T
  Eigen::Matrix3Xd sums;  // 3 x J, column a = sum_i g_ia
};

ChainMoments ComputeChainMoments(const RigMoments& moments, const Skeleton& skeleton);

// 3J x 3, block a = sum_i g_ia y_i^T.
Eigen::MatrixXd ComputeChainCross(const RigMoments& moments, const FrameMoments& frame,
                                  const Skeleton& skeleton);

}  // namespace pleat
