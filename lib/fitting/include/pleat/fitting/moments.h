// The moments of a rig and of a frame: all that a pose fit needs to know about the vertices
// (docs/method/fit.md#moments). Computed once, they make the cost of a solver iteration independent
// of V.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/skeleton/skeleton.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// The moments of a rig, computed once. u_i = [rest position relative to `center`; 1], and W are the
// skinning weights (rows normalized to sum 1). They do not depend on the joints, so joints can be
// refined against them. Every sum over vertices, here and below, counts vertex i as
// Rig::fit_weights says, for which no formula has a letter of its own.
struct RigMoments {
  int num_joints = 0;
  double num_vertices = 0;                           // the sum of the fit weights
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // mean rest position, meters
  // U_kl = sum_i W_ik W_il u_i u_i^T at [k * num_joints + l]; blocks of bone 0 are zero.
  std::vector<Eigen::Matrix4d> products;
  // sum_i W_ik u_i u_i^T = sum_l U_kl.
  std::vector<Eigen::Matrix4d> weighted;
};

// The moments of a frame, from the only loop over vertices. Positions are relative to `center`,
// which keeps the sums small and makes sum_i y_i vanish.
struct FrameMoments {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // mean position of the frame, meters
  std::vector<Eigen::Matrix<double, 4, 3>> cross;    // Y_k = sum_i W_ik u_i y_i^T, per bone
  double sum_squares = 0;                            // sum_i |y_i|^2
};

// Computes the moments of `rig`, which must have vertices. O(V) with up to 16 products per vertex.
RigMoments ComputeRigMoments(const Rig& rig);

// Computes the moments of a frame. positions: 3 x V, meters (float32, as sequences hold them);
// `rig_moments` must be of the same rig.
FrameMoments ComputeFrameMoments(const Rig& rig, const RigMoments& rig_moments,
                                 const Eigen::Matrix3Xf& positions);

// The moments seen through the joint chain. With world rotations R_a of the bones and the root
// position r, linear blend skinning of a chain with pivots is linear in them:
//
//   v_i = r + sum_a R_a g_ia,   g_ia = W_ia (u_i - q_parent(a)) + S_ia (q_a - q_parent(a)),
//
// where S_ia is the summed weight of the strict descendants of a: bone a carries what it moves
// itself, and moves its end for all that hangs below. Entry a = 0 is 0, since the root has no bone.
struct ChainMoments {
  int num_joints = 0;
  double num_vertices = 0;
  Eigen::MatrixXd gram;   // 3J x 3J, block ab = sum_i g_ia g_ib^T
  Eigen::Matrix3Xd sums;  // 3 x J, column a = sum_i g_ia
};

// Folds the chain into the moments. This depends on the joints and is cheap, O(J^3) at most.
ChainMoments ComputeChainMoments(const RigMoments& moments, const Skeleton& skeleton);

// Returns the cross moments of the chain with a frame: 3J x 3, block a = sum_i g_ia y_i^T.
Eigen::MatrixXd ComputeChainCross(const RigMoments& moments, const FrameMoments& frame,
                                  const Skeleton& skeleton);

}  // namespace pleat
