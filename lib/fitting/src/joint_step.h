// One step of rig refinement: the rest joints that minimize the error of all frames while
// rotations and weights are held. Linear least squares in the moments of
// docs/method/fit.md#moments.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/fitting/moments.h"
#include "pleat/fitting/pose_energy.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// Moments over subtrees: S_ic = sum of the weights of bone c and its descendants at vertex i.
// With R_a the bones' world rotations, r~ a free translation per frame, q the joints,
//   v_i = r~ + sum_b W_ib R_b u_i + sum_c S_ic (R_parent(c) - R_c) q_parent(c).
struct SubtreeMoments {
  Eigen::MatrixXd products;               // n_cd = sum_i S_ic S_id, J x J
  std::vector<Eigen::MatrixXd> weighted;  // per bone c: column b = sum_i S_ic W_ib u_i (3 x J)
};

SubtreeMoments ComputeSubtreeMoments(const RigMoments& moments, const Skeleton& skeleton);

// Normal equations of the joints relative to RigMoments::center, 3J x 3J and 3J. The frame's
// translation is eliminated.
struct JointSystem {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
};

// What one frame with known rotations adds.
JointSystem ComputeJointSystem(const RigMoments& moments, const SubtreeMoments& subtree,
                               const Skeleton& skeleton, const FrameMoments& frame,
                               const ChainPose& pose);

// The joints (3 x J, meters) that minimize the sum of `frames` plus a pull to `first` whose
// stiffness is `prior` times the mean curvature of the error per joint. Leaves have no influence
// on the mesh and stay at `first`; so do the joints `locked`, exactly.
Eigen::Matrix3Xd SolveJoints(const std::vector<JointSystem>& frames, const RigMoments& moments,
                             const Skeleton& skeleton, const Eigen::Matrix3Xd& first, double prior,
                             const std::vector<int>& locked);

}  // namespace pleat
