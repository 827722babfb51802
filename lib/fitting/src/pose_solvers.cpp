#include "pleat/fitting/pose_solvers.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "pleat/math/rotations.h"

namespace pleat {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// Returns sum_i W_ib (u_i - rest_pivot)(y_i - pivot)^T from the moments; u and y are relative to
// their centers.
Matrix3d CovarianceAbout(const RigMoments& moments, const FrameMoments& frame, int b,
                         const Vector3d& rest_pivot, const Vector3d& pivot) {
  const Eigen::Matrix4d& rest = moments.weighted[b];
  const auto& cross = frame.cross[b];
  return cross.topRows<3>() - rest_pivot * cross.row(3) -
         rest.topRightCorner<3, 1>() * pivot.transpose() +
         rest(3, 3) * rest_pivot * pivot.transpose();
}

// Returns the rotation about fixed pivots that fits `covariance` = sum source target^T. Directions
// that the points do not determine (a thin or empty bone) follow `fallback`: it enters as points
// with a small share of the weight, plus a floor for a bone without any vertex.
Matrix3d FitRotation(const Matrix3d& covariance, double spread, const Matrix3d& fallback) {
  constexpr double kFallbackShare = 1e-3;
  return NearestRotation(covariance.transpose() + (kFallbackShare * spread + 1e-12) * fallback);
}

// Fits the bones that hang on the root rigidly and returns their rotation and the root's position.
void FitRoot(const RigMoments& moments, const FrameMoments& frame, const Skeleton& skeleton,
             Matrix3d* rotation, Vector3d* root_position) {
  Matrix3d covariance = Matrix3d::Zero();
  Vector3d rest_sum = Vector3d::Zero(), sum = Vector3d::Zero();
  double weight = 0;
  for (const int b : skeleton.children(0)) {
    covariance += frame.cross[b].topRows<3>();
    rest_sum += moments.weighted[b].topRightCorner<3, 1>();
    sum += frame.cross[b].row(3).transpose();
    weight += moments.weighted[b](3, 3);
  }
  *rotation = Matrix3d::Identity();
  *root_position = skeleton.rest_position(0) - moments.center;
  // Nothing hangs on the root, so it stays where the rest pose has it relative to the center.
  if (!(weight > 1e-9)) return;
  covariance -= rest_sum * sum.transpose() / weight;
  *rotation = NearestRotation(covariance.transpose());
  *root_position = *rotation * (*root_position - rest_sum / weight) + sum / weight;
}

}  // namespace

ChainPose ClosedFormWalk(const RigMoments& moments, const FrameMoments& frame,
                         const Skeleton& skeleton) {
  const int num_joints = skeleton.num_joints();
  ChainPose pose;
  pose.rotations.resize(3, 3 * num_joints);
  Matrix3d root_rotation;
  FitRoot(moments, frame, skeleton, &root_rotation, &pose.root_position);
  pose.rotation(0) = root_rotation;
  Eigen::Matrix3Xd joints(3, num_joints);  // posed, relative to the frame's center
  joints.col(0) = pose.root_position;
  for (int b = 1; b < num_joints; ++b) {
    const int parent = skeleton.parent(b);
    const Vector3d rest_pivot = skeleton.rest_position(parent) - moments.center;
    const Matrix3d covariance = CovarianceAbout(moments, frame, b, rest_pivot, joints.col(parent));
    const Eigen::Matrix4d& rest = moments.weighted[b];
    const double spread = rest.diagonal().head<3>().sum() -
                          2 * rest_pivot.dot(rest.topRightCorner<3, 1>()) +
                          rest(3, 3) * rest_pivot.squaredNorm();
    pose.rotation(b) = FitRotation(covariance, spread, pose.rotation(parent));
    joints.col(b) = joints.col(parent) +
                    pose.rotation(b) * (skeleton.rest_position(b) - skeleton.rest_position(parent));
  }
  return pose;
}

void WalkSweep(const PoseEnergy& energy, const Skeleton& skeleton, ChainPose* pose) {
  const int num_joints = skeleton.num_joints();
  const ChainMoments& chain = energy.chain();
  const MatrixXd& gram = energy.frame_gram();
  const MatrixXd& cross = energy.frame_cross();
  // First the whole body rigidly, which is easy since the observations are centered.
  Matrix3d covariance = Matrix3d::Zero();
  Vector3d rotated_sums = Vector3d::Zero();
  for (int a = 0; a < num_joints; ++a) {
    covariance += pose->rotation(a) * cross.middleRows<3>(3 * a);
    rotated_sums += pose->rotation(a) * chain.sums.col(a);
  }
  const Matrix3d whole = NearestRotation(covariance.transpose());
  pose->rotations = whole * pose->rotations;
  pose->root_position = -(whole * rotated_sums) / chain.num_vertices;

  std::vector<char> inside(num_joints);
  for (int b = 1; b < num_joints; ++b) {
    inside.assign(num_joints, 0);
    inside[b] = 1;
    for (int k = b + 1; k < num_joints; ++k) inside[k] = inside[skeleton.parent(k)];
    // sum_i x_i (y_i - a_i)^T with x_i the part of v_i that turns with b, a_i the rest.
    Matrix3d moving = Matrix3d::Zero();
    for (int k = b; k < num_joints; ++k) {
      if (!inside[k]) continue;
      Matrix3d target =
          cross.middleRows<3>(3 * k) - chain.sums.col(k) * pose->root_position.transpose();
      for (int l = 0; l < num_joints; ++l) {
        if (!inside[l]) target -= gram.block<3, 3>(3 * k, 3 * l) * pose->rotation(l).transpose();
      }
      moving += pose->rotation(k) * target;
    }
    if (moving.norm() < 1e-12) continue;  // a bone that moves nothing
    const Matrix3d turn = NearestRotation(moving.transpose());
    for (int k = b; k < num_joints; ++k) {
      if (inside[k]) pose->rotation(k) = (turn * pose->rotation(k)).eval();
    }
  }
  pose->Move(Eigen::VectorXd::Zero(3 * num_joints + 3));  // renormalize
}

PoseSolverSummary MinimizePose(const PoseEnergy& energy, const PoseSolverOptions& options,
                               ChainPose* pose) {
  constexpr double kMinDamping = 1e-9, kMaxDamping = 1e9;
  PoseSolverSummary summary;
  Eigen::VectorXd gradient;
  MatrixXd hessian, damped;
  summary.energy = energy.Linearize(*pose, &gradient, &hessian);
  // Below this the energy is rounding noise: it is a difference of sums of the size of the Gram
  // matrix.
  const double noise = 1e-14 * energy.frame_gram().trace();
  double damping = 1e-4;
  ChainPose trial = *pose;
  while (summary.num_iterations < options.max_iterations) {
    ++summary.num_iterations;
    damped = hessian;
    // The floor carries rotations that nothing determines (the root's, without stiffness).
    const double floor = 1e-9 * hessian.diagonal().maxCoeff();
    damped.diagonal() += damping * hessian.diagonal().cwiseMax(floor);
    const Eigen::LLT<MatrixXd> factor(damped);
    bool accepted = false;
    if (factor.info() == Eigen::Success) {
      trial = *pose;
      trial.Move(-factor.solve(gradient));
      const double value = energy.Value(trial);
      if (value < summary.energy) {
        const double decrease = summary.energy - value;
        const bool small = decrease <= options.tolerance * std::abs(value) + noise;
        *pose = trial;
        summary.energy = value;
        accepted = true;
        if (small) {
          summary.converged = true;
          return summary;
        }
        damping = std::max(kMinDamping, damping * 0.1);
        energy.Linearize(*pose, &gradient, &hessian);
      }
    }
    if (!accepted) {
      damping *= 8;
      if (damping > kMaxDamping || gradient.squaredNorm() <= noise * noise) {
        summary.converged = true;  // no descent left above rounding
        return summary;
      }
    }
  }
  return summary;
}

}  // namespace pleat
