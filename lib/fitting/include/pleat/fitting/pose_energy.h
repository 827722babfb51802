// The squared distance between a skinned and an observed frame as a function of the pose, with
// gradient and Gauss-Newton matrix, from moments only (docs/method/fit.md#energy).
#pragma once

#include <Eigen/Core>

#include "pleat/fitting/moments.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

// A pose as the solver sees it: the world rotations of all bones side by side, P = [R_0 R_1 ...
// R_J-1], and the root's position relative to the frame's center. World rotations make the skinned
// vertices linear in the pose; the chain (one pivot per bone) is inside ChainMoments. R_0 has no
// influence on the mesh.
struct ChainPose {
  Eigen::Matrix3Xd rotations;  // 3 x 3J
  Eigen::Vector3d root_position = Eigen::Vector3d::Zero();

  int num_joints() const { return static_cast<int>(rotations.cols() / 3); }
  auto rotation(int a) const { return rotations.middleCols<3>(3 * a); }
  auto rotation(int a) { return rotations.middleCols<3>(3 * a); }

  // Moves along a tangent vector with 3J + 3 entries: per bone a rotation vector applied from the
  // left, R_a <- exp(w_a) R_a, then the translation of the root. Rotations are renormalized, since
  // products of rotations drift.
  void Move(const Eigen::VectorXd& step);
};

// Convert between the world rotations of a solver and the local ones of a Pose. `frame_center` is
// the center that root_position is relative to. Quaternions of the Pose have w >= 0.
ChainPose ToChainPose(const Skeleton& skeleton, const Pose& pose,
                      const Eigen::Vector3d& frame_center);
Pose FromChainPose(const Skeleton& skeleton, const ChainPose& chain_pose,
                   const Eigen::Vector3d& frame_center);

// The energy
//
//   E(pose) = sum_i |v_i(pose) - y_i|^2 + bend_stiffness * sum_b f_b |R_b - R_parent(b)|_F^2
//             + attraction_stiffness * sum_a |R_a - attraction_a|_F^2          square meters
//
// The stiffness terms keep the form of the moments: they only add to Gram and cross blocks. f_b is
// 1, but 100 for the bones from the root to leftUpperLeg and rightUpperLeg: they are one bone of
// the body, the pelvis (docs/method/fit.md#bend-stiffness).
//
// An object holds the frame that was set last. The const functions may be called from several
// threads; to work on several frames at once, copy it, which costs a few matrices of 3J x 3J.
class PoseEnergy {
 public:
  // `chain` must outlive this object and its copies. A tiny bend stiffness (square meters) makes
  // rotations that the data do not determine follow the parent's.
  PoseEnergy(const ChainMoments& chain, const Skeleton& skeleton, double bend_stiffness);

  // Chooses the observed frame: `cross` (3J x 3) is that of ComputeChainCross. Drops all
  // attractions.
  void SetFrame(Eigen::MatrixXd cross, double sum_squares);
  // Adds an attraction of every rotation towards `target` (3 x 3J) to the current frame.
  void AddAttraction(const Eigen::Matrix3Xd& target, double stiffness);

  // Returns the energy of data and stiffness terms.
  double Value(const ChainPose& pose) const;
  // Returns the energy of the data alone. Rounding may make it slightly negative where the fit is
  // perfect, as it is a difference of large sums.
  double DataValue(const ChainPose& pose) const;
  // Returns the value and fills the gradient (3J + 3) and the Gauss-Newton matrix 2 J^T J, (3J+3) x
  // (3J+3), with the unknowns of ChainPose::Move.
  double Linearize(const ChainPose& pose, Eigen::VectorXd* gradient,
                   Eigen::MatrixXd* hessian) const;

  const ChainMoments& chain() const { return chain_; }
  // Gram (3J x 3J) and cross (3J x 3) moments of the current frame, stiffness and attractions
  // included.
  const Eigen::MatrixXd& frame_gram() const { return frame_gram_; }
  const Eigen::MatrixXd& frame_cross() const { return frame_cross_; }

 private:
  // Returns G P^T + g r^T - C (3J x 3): block a = sum_i g_ia (v_i - y_i)^T.
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
