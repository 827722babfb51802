// The squared distance between a skinned and an observed frame as a function of the pose, with
// gradient and Gauss-Newton matrix, from moments only (docs/method/fit.md#energy).
#pragma once

#include <Eigen/Core>

#include "pleat/fitting/moments.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

// World rotations of all bones side by side, P = [R_0 R_1 ... R_J-1], and the root's position
// relative to the frame's center. World rotations make the skinned vertices linear in the pose; the
// chain (one pivot per bone) is inside ChainMoments. R_0 has no influence on the mesh.
struct ChainPose {
  Eigen::Matrix3Xd rotations;  // 3 x 3J
  Eigen::Vector3d root_position = Eigen::Vector3d::Zero();

  int num_joints() const { return static_cast<int>(rotations.cols() / 3); }
  auto rotation(int a) const { return rotations.middleCols<3>(3 * a); }
  auto rotation(int a) { return rotations.middleCols<3>(3 * a); }

  // Moves along a tangent vector (3J + 3: per bone a rotation vector applied from the left,
  // R_a <- exp(w_a) R_a, then the root translation). Rotations are renormalized.
  void Move(const Eigen::VectorXd& step);
};

// Between the world rotations of a solver and the local ones of a Pose. `frame_center`: the
// center that root_position is relative to.
ChainPose ToChainPose(const Skeleton& skeleton, const Pose& pose,
                      const Eigen::Vector3d& frame_center);
Pose FromChainPose(const Skeleton& skeleton, const ChainPose& chain_pose,
                   const Eigen::Vector3d& frame_center);

// E(pose) = sum_i |v_i(pose) - y_i|^2 + bend_stiffness * sum_b |R_b - R_parent(b)|_F^2
//           + attraction_stiffness * sum_a |R_a - attraction_a|_F^2, square meters.
// The stiffness terms keep the moments' form: they only add to Gram and cross blocks. The bones
// from the root to leftUpperLeg and rightUpperLeg are one bone of the body, the pelvis: 100 times
// stiffer.
class PoseEnergy {
 public:
  // `chain` and `skeleton` must outlive this object. A tiny bend stiffness (square meters) makes
  // rotations that the data do not determine follow the parent's.
  PoseEnergy(const ChainMoments& chain, const Skeleton& skeleton, double bend_stiffness);

  // Chooses the observed frame: `cross` (3J x 3) of ComputeChainCross.
  void SetFrame(Eigen::MatrixXd cross, double sum_squares);
  // Adds the attraction of every rotation towards `target` (3 x 3J) to the current frame.
  void AddAttraction(const Eigen::Matrix3Xd& target, double stiffness);

  // Of data and stiffness terms.
  double Value(const ChainPose& pose) const;
  // Of the data alone.
  double DataValue(const ChainPose& pose) const;
  // gradient: 3J + 3; hessian: Gauss-Newton matrix 2 J^T J, (3J+3) x (3J+3). Unknowns as in
  // ChainPose::Move. Returns the value.
  double Linearize(const ChainPose& pose, Eigen::VectorXd* gradient,
                   Eigen::MatrixXd* hessian) const;

  const ChainMoments& chain() const { return chain_; }
  // Gram (3J x 3J) and cross (3J x 3) moments of the current frame, stiffness included.
  const Eigen::MatrixXd& frame_gram() const { return frame_gram_; }
  const Eigen::MatrixXd& frame_cross() const { return frame_cross_; }

 private:
  // G P^T + g r^T - C (3J x 3): block a = sum_i g_ia (v_i - y_i)^T.
  Eigen::MatrixXd ResidualMoments(const ChainPose& pose) const;

  const ChainMoments& chain_;
  Eigen::MatrixXd frame_gram_;   // 3J x 3J with stiffness and attraction of the current frame
  Eigen::MatrixXd gram_;         // the same without the attraction
  Eigen::MatrixXd cross_;        // 3J x 3, data
  Eigen::MatrixXd frame_cross_;  // 3J x 3, with attraction
  double sum_squares_ = 0;       // data
  double frame_constant_ = 0;    // with attraction
};

}  // namespace pleat
