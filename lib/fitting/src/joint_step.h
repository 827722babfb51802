// One step of rig refinement: the rest joints that minimize the error of all frames while rotations
// and weights are held. It is linear least squares in the moments of docs/method/fit.md#moments;
// the system is derived in docs/method/fit.md#joints.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/fitting/moments.h"
#include "pleat/fitting/pose_energy.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// The moments over subtrees: S_ic = the sum of the weights of bone c and its descendants at vertex
// i. With R_a the bones' world rotations, r~ a free translation per frame, and q the joints,
//
//   v_i = r~ + sum_b W_ib R_b u_i + sum_c S_ic (R_parent(c) - R_c) q_parent(c).
//
// So a joint shows itself by how differently the bones on its two sides turn.
struct SubtreeMoments {
  Eigen::MatrixXd products;               // n_cd = sum_i S_ic S_id, J x J
  std::vector<Eigen::MatrixXd> weighted;  // per bone c: column b = sum_i S_ic W_ib u_i (3 x J)
};

SubtreeMoments ComputeSubtreeMoments(const RigMoments& moments, const Skeleton& skeleton);

// The normal equations of the joints relative to RigMoments::center, 3J x 3J and 3J. The frame's
// translation is eliminated.
struct JointSystem {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
};

// Returns what one frame with known rotations adds to the normal equations.
JointSystem ComputeJointSystem(const RigMoments& moments, const SubtreeMoments& subtree,
                               const Skeleton& skeleton, const FrameMoments& frame,
                               const ChainPose& pose);

// Returns the joints (3 x J, meters) that minimize the sum of `frames` plus a pull to `first` whose
// stiffness is `prior` times the mean curvature of the error per joint. Leaves have no influence on
// the mesh and stay at `first`; so do the joints `locked`, exactly. `prior` must be positive and
// `frames` not empty.
Eigen::Matrix3Xd SolveJoints(const std::vector<JointSystem>& frames, const RigMoments& moments,
                             const Skeleton& skeleton, const Eigen::Matrix3Xd& first, double prior,
                             const std::vector<int>& locked);

}  // namespace pleat
