// How a sum over ten thousand vertices becomes a few products of small matrices. Skinning with a
// chain of joints looks nested: a vertex of the hand moves with the wrist, which moves with the
// elbow, and so on. Written with *world* rotations the nest opens. The end of bone a moves by R_a
// (q_a - q_parent(a)) against its beginning, and everything below bone a moves along. Summing along
// the chain gives
//
//   v_i = r + sum_a R_a g_ia,   g_ia = W_ia (u_i - q_parent(a)) + S_ia (q_a - q_parent(a)),
//
// with S_ia the weight that vertex i has in the subtree strictly below bone a. So subtree sums of
// weights carry the whole chain, the vectors g_ia do not depend on the pose, and v_i is linear in
// the rotations. Its square is quadratic in them with coefficients that are sums over vertices:
// G_ab = sum_i g_ia g_ib^T, g_a = sum_i g_ia, C_a = sum_i g_ia y_i^T and s = sum_i |y_i|^2. With P
// = [R_0 ... R_J-1],
//
//   E = tr(P G P^T) - 2 tr(P C) + 2 r . sum_a R_a g_a + V |r|^2 + s.
//
// There is no term of r with the y_i, since observations are centered. moments.cpp computes the
// coefficients; this file never sees a vertex, and an evaluation costs O(J^2) whatever V is.
//
// Derivatives follow from a turn of bone a from the left by w_a, dv_i / dw_a = -[R_a g_ia]x. With
// world rotations bones turn independently: turning bone a moves its end and shifts what is below,
// but turns nothing else. So a block of the Gauss-Newton matrix needs only G_ab, and the gradient
// only the residual moments M = G P^T + g r^T - C. The formulas are derived in
// docs/method/fit.md#gradient-and-gauss-newton-matrix and tested against sums over vertices.
//
// Terms that are quadratic in the rotations fit into the same form, as if a few points more had
// been observed: a stiffness between a bone and its parent adds +I and -I to blocks of G, an
// attraction to given rotations adds I to G and the target to C. So solvers know nothing of them.

#include "pleat/fitting/pose_energy.h"

#include <cassert>
#include <utility>

#include "pleat/math/rotations.h"

namespace pleat {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// Returns sum x cross y where `moment` = sum x y^T.
Vector3d CrossSum(const Matrix3d& moment) {
  return {moment(1, 2) - moment(2, 1), moment(2, 0) - moment(0, 2), moment(0, 1) - moment(1, 0)};
}

// Returns the energy of moments (gram, sums, cross, constant) at `pose`. The observations are
// centered, so sum_i y_i = 0 and no term of r with y is left.
double EnergyOf(const MatrixXd& gram, const Eigen::Matrix3Xd& sums, const MatrixXd& cross,
                double num_vertices, double constant, const ChainPose& pose) {
  const Eigen::Matrix3Xd& p = pose.rotations;
  const Vector3d& r = pose.root_position;
  Vector3d rotated_sums = Vector3d::Zero();
  for (int a = 0; a < pose.num_joints(); ++a) rotated_sums += pose.rotation(a) * sums.col(a);
  const MatrixXd difference = gram * p.transpose() - 2 * cross;
  return difference.cwiseProduct(p.transpose()).sum() + 2 * r.dot(rotated_sums) +
         num_vertices * r.squaredNorm() + constant;
}

}  // namespace

void ChainPose::Move(const Eigen::VectorXd& step) {
  for (int a = 0; a < num_joints(); ++a) {
    const Eigen::Quaterniond current(Matrix3d(rotation(a)));
    rotation(a) = (QuaternionFromExponentialMap(step.segment<3>(3 * a)) * current)
                      .normalized()
                      .toRotationMatrix();
  }
  root_position += step.tail<3>();
}

ChainPose ToChainPose(const Skeleton& skeleton, const Pose& pose,
                      const Eigen::Vector3d& frame_center) {
  const int num_joints = skeleton.num_joints();
  ChainPose result;
  result.rotations.resize(3, 3 * num_joints);
  for (int a = 0; a < num_joints; ++a) {
    const Matrix3d local = pose.rotations[a].toRotationMatrix();
    if (a == 0) {
      result.rotation(a) = local;
    } else {
      result.rotation(a) = result.rotation(skeleton.parent(a)) * local;
    }
  }
  result.root_position = pose.root_position - frame_center;
  return result;
}

Pose FromChainPose(const Skeleton& skeleton, const ChainPose& chain_pose,
                   const Eigen::Vector3d& frame_center) {
  const int num_joints = skeleton.num_joints();
  std::vector<Eigen::Quaterniond> world(num_joints);
  Pose pose;
  pose.root_position = chain_pose.root_position + frame_center;
  pose.rotations.resize(num_joints);
  for (int a = 0; a < num_joints; ++a) {
    world[a] = Eigen::Quaterniond(Matrix3d(chain_pose.rotation(a))).normalized();
    pose.rotations[a] =
        a == 0 ? world[a] : (world[skeleton.parent(a)].conjugate() * world[a]).normalized();
    if (pose.rotations[a].w() < 0) pose.rotations[a].coeffs() *= -1;  // one sign per rotation
  }
  return pose;
}

namespace {

// The two bones from the root to the hips are one bone of the body, the pelvis. Under a skirt their
// vertices hardly tell them apart, and each would turn on its own, so they are held together much
// more stiffly than a joint (docs/method/fit.md#bend-stiffness).
constexpr double kPelvisStiffness = 100;

bool IsPelvisBone(const Skeleton& skeleton, int bone) {
  const std::string& name = skeleton.joint(bone).name;
  return skeleton.parent(bone) == 0 && (name == "leftUpperLeg" || name == "rightUpperLeg");
}

}  // namespace

PoseEnergy::PoseEnergy(const ChainMoments& chain, const Skeleton& skeleton, double bend_stiffness)
    : chain_(chain), gram_(chain.gram) {
  assert(skeleton.num_joints() == chain.num_joints);
  // |R_b - R_p|^2 = tr(P G' P^T) where G' has the blocks +I, +I, -I, -I: a point that both bones
  // share.
  for (int b = 1; b < chain.num_joints; ++b) {
    const double factor = IsPelvisBone(skeleton, b) ? kPelvisStiffness : 1;
    const Matrix3d stiffness = factor * bend_stiffness * Matrix3d::Identity();
    const int p = skeleton.parent(b);
    gram_.block<3, 3>(3 * b, 3 * b) += stiffness;
    gram_.block<3, 3>(3 * p, 3 * p) += stiffness;
    gram_.block<3, 3>(3 * b, 3 * p) -= stiffness;
    gram_.block<3, 3>(3 * p, 3 * b) -= stiffness;
  }
}

void PoseEnergy::SetFrame(MatrixXd cross, double sum_squares) {
  cross_ = std::move(cross);
  sum_squares_ = sum_squares;
  frame_gram_ = gram_;
  frame_cross_ = cross_;
  frame_constant_ = sum_squares;
}

void PoseEnergy::AddAttraction(const Eigen::Matrix3Xd& target, double stiffness) {
  frame_gram_.diagonal().array() += stiffness;
  frame_cross_ += stiffness * target.transpose();
  frame_constant_ += 3 * stiffness * chain_.num_joints;  // |R|_F^2 = 3
}

double PoseEnergy::Value(const ChainPose& pose) const {
  return EnergyOf(frame_gram_, chain_.sums, frame_cross_, chain_.num_vertices, frame_constant_,
                  pose);
}

double PoseEnergy::DataValue(const ChainPose& pose) const {
  return EnergyOf(chain_.gram, chain_.sums, cross_, chain_.num_vertices, sum_squares_, pose);
}

MatrixXd PoseEnergy::ResidualMoments(const ChainPose& pose) const {
  MatrixXd moments = frame_gram_ * pose.rotations.transpose() - frame_cross_;
  for (int a = 0; a < pose.num_joints(); ++a) {
    moments.middleRows<3>(3 * a) += chain_.sums.col(a) * pose.root_position.transpose();
  }
  return moments;
}

double PoseEnergy::Linearize(const ChainPose& pose, Eigen::VectorXd* gradient,
                             MatrixXd* hessian) const {
  const int num_joints = pose.num_joints();
  const int n = 3 * num_joints;
  gradient->resize(n + 3);
  hessian->resize(n + 3, n + 3);
  const MatrixXd residual_moments = ResidualMoments(pose);
  Vector3d rotated_sums = Vector3d::Zero();
  for (int a = 0; a < num_joints; ++a) {
    const Matrix3d rotation = pose.rotation(a);
    // d v_i / d w_a = -[x]x with x = R_a g_ia; hence dE/dw_a = 2 sum_i x cross (v_i - y_i).
    gradient->segment<3>(3 * a) = 2 * CrossSum(rotation * residual_moments.middleRows<3>(3 * a));
    const Vector3d rotated_sum = rotation * chain_.sums.col(a);
    rotated_sums += rotated_sum;
    hessian->block<3, 3>(3 * a, n) = 2 * CrossMatrix(rotated_sum);
    hessian->block<3, 3>(n, 3 * a) = hessian->block<3, 3>(3 * a, n).transpose();
    for (int b = 0; b <= a; ++b) {
      // sum_i [x]x^T [z]x = (sum x.z) I - sum z x^T, with M = sum x z^T = R_a G_ab R_b^T.
      const Matrix3d moment =
          rotation * frame_gram_.block<3, 3>(3 * a, 3 * b) * pose.rotation(b).transpose();
      const Matrix3d block = 2 * (moment.trace() * Matrix3d::Identity() - moment.transpose());
      hessian->block<3, 3>(3 * a, 3 * b) = block;
      hessian->block<3, 3>(3 * b, 3 * a) = block.transpose();
    }
  }
  const Vector3d& r = pose.root_position;
  gradient->tail<3>() = 2 * (rotated_sums + chain_.num_vertices * r);
  hessian->bottomRightCorner<3, 3>() = 2 * chain_.num_vertices * Matrix3d::Identity();
  return Value(pose);
}

}  // namespace pleat
