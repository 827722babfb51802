#include "pleat/fitting/joint_refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/fitting/moments.h"
#include "pleat/fitting/pose_energy.h"
#include "pleat/fitting/pose_solvers.h"

namespace pleat {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// Moments over subtrees: S_ic = sum of the weights of bone c and its descendants at vertex i.
// With R_a the bones' world rotations, r~ a free translation per frame, q the joints,
//   v_i = r~ + sum_b W_ib R_b u_i + sum_c S_ic (R_parent(c) - R_c) q_parent(c).
struct SubtreeMoments {
  MatrixXd products;               // n_cd = sum_i S_ic S_id, J x J
  std::vector<MatrixXd> weighted;  // per bone c: column b = sum_i S_ic W_ib u_i (3 x J)
};

// Adds every bone's rows to its ancestors', leaves first.
template <typename Add>
void SumOverSubtrees(const Skeleton& skeleton, const Add& add_to_parent) {
  for (int b = skeleton.num_joints() - 1; b >= 1; --b) {
    if (skeleton.parent(b) >= 1) add_to_parent(b, skeleton.parent(b));
  }
}

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

// Normal equations of the joints, 3J x 3J and 3J.
struct JointSystem {
  MatrixXd matrix;
  Eigen::VectorXd right;
};

// What one frame with known rotations adds.
JointSystem FrameSystem(const RigMoments& moments, const SubtreeMoments& subtree,
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
  system.matrix -= to_translation * to_translation.transpose() / moments.num_vertices;
  system.right -= to_translation * total / moments.num_vertices;
  return system;
}

// The joints (3 x J) that minimise all frames' errors plus the pull to `first`.
Eigen::Matrix3Xd SolveJoints(const std::vector<JointSystem>& frames, const RigMoments& moments,
                             const Skeleton& skeleton, const Eigen::Matrix3Xd& first,
                             double prior) {
  JointSystem sum = frames[0];
  for (size_t t = 1; t < frames.size(); ++t) {
    sum.matrix += frames[t].matrix;
    sum.right += frames[t].right;
  }
  int num_inner = 0;
  for (int j = 0; j < skeleton.num_joints(); ++j) num_inner += !skeleton.children(j).empty();
  const double stiffness = prior * sum.matrix.trace() / (3.0 * std::max(1, num_inner));
  if (!(stiffness > 0)) return first;  // nothing bends
  const Eigen::Matrix3Xd centred = first.colwise() - moments.centre;
  sum.matrix.diagonal().array() += stiffness;
  sum.right += stiffness * centred.reshaped();
  const Eigen::VectorXd solved = sum.matrix.llt().solve(sum.right);
  return Eigen::Matrix3Xd(solved.reshaped(3, skeleton.num_joints())).colwise() + moments.centre;
}

absl::Status CheckInput(const MeshSequence& sequence, const Rig& rig,
                        const JointRefinementOptions& options) {
  if (rig.weights.num_vertices() != sequence.num_vertices() ||
      rig.rest_positions.cols() != sequence.num_vertices()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "joint refinement: the rig has ", rig.weights.num_vertices(), " vertices, the sequence ",
        sequence.num_vertices(), "; use the rig of this mesh"));
  }
  if (!(options.prior > 0) || options.num_rounds < 1 || options.max_frames < 1) {
    return absl::InvalidArgumentError(absl::StrCat(
        "joint refinement: prior (", options.prior, "), num_rounds (", options.num_rounds,
        ") and max_frames (", options.max_frames, ") must be positive"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Rig> RefineJoints(const MeshSequence& sequence, const Rig& rig,
                                 const JointRefinementOptions& options,
                                 JointRefinementSummary* summary, const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckInput(sequence, rig, options));
  const int num_frames = std::min(sequence.num_frames(), options.max_frames);
  const RigMoments moments = ComputeRigMoments(rig);
  const SubtreeMoments subtree = ComputeSubtreeMoments(moments, rig.skeleton);
  const Eigen::Matrix3Xd first = rig.skeleton.RestPositions();
  std::vector<FrameMoments> frames(num_frames);
  std::vector<ChainPose> poses(num_frames);
  std::vector<JointSystem> systems(num_frames);
  std::vector<double> energies(num_frames);
  JointRefinementSummary result;
  Rig refined = rig;
  // The last round only measures what the joints before it gave.
  for (int round = 0; round <= options.num_rounds; ++round) {
    const ChainMoments chain = ComputeChainMoments(moments, refined.skeleton);
    const PoseEnergy shared_energy(chain, refined.skeleton,
                                   1e-6 * chain.gram.trace() / (3 * chain.num_joints));
    ParallelFor(num_frames, options.num_threads, [&](int i) {
      if (progress.cancelled()) return;
      if (round == 0) {
        const int t =
            static_cast<int>(static_cast<int64_t>(i) * sequence.num_frames() / num_frames);
        frames[i] = ComputeFrameMoments(rig, moments, sequence.frame(t));
        poses[i] = ClosedFormWalk(moments, frames[i], rig.skeleton);
      }
      PoseEnergy energy = shared_energy;
      energy.SetFrame(ComputeChainCross(moments, frames[i], refined.skeleton),
                      frames[i].sum_squares);
      MinimizePose(energy, {.max_iterations = options.max_iterations}, &poses[i]);
      energies[i] = std::max(0.0, energy.DataValue(poses[i]));
      systems[i] = FrameSystem(moments, subtree, refined.skeleton, frames[i], poses[i]);
    });
    PLEAT_RETURN_IF_ERROR(progress.Report((round + 1.0) / (options.num_rounds + 1)));
    double sum = 0;
    for (const double energy : energies) sum += energy;
    result.rms_m = std::sqrt(sum / (moments.num_vertices * num_frames));
    if (round == options.num_rounds) break;
    result.round_rms_m.push_back(result.rms_m);
    refined.skeleton = refined.skeleton.WithRestPositions(
        SolveJoints(systems, moments, refined.skeleton, first, options.prior));
  }
  if (summary != nullptr) {
    const Eigen::Matrix3Xd moved = refined.skeleton.RestPositions() - first;
    for (Eigen::Index j = 0; j < moved.cols(); ++j) result.moved_m.push_back(moved.col(j).norm());
    *summary = std::move(result);
  }
  return refined;
}

}  // namespace pleat
