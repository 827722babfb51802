#include "pleat/fitting/moments.h"

#include <array>
#include <cassert>

namespace pleat {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Matrix4x3d = Eigen::Matrix<double, 4, 3>;
using Matrix3x4d = Eigen::Matrix<double, 3, 4>;

// Returns the weights of one vertex in double precision, normalized to sum 1. Stored weights are
// float32 and sum to 1 only up to rounding; an energy that takes sums of weights out of its loops
// needs more.
std::array<double, kMaxInfluences> NormalizedWeights(const VertexInfluences& influences) {
  std::array<double, kMaxInfluences> weights;
  double total = 0;
  for (int k = 0; k < kMaxInfluences; ++k) total += weights[k] = influences.weights[k];
  for (double& weight : weights) weight /= total;
  return weights;
}

// Returns A_aa, which takes [x; 1] to x - pivot.
Matrix3x4d OwnBlock(const Vector3d& pivot) {
  Matrix3x4d block;
  block << Matrix3d::Identity(), -pivot;
  return block;
}

// Returns the strict descendants of every joint.
std::vector<std::vector<int>> StrictDescendants(const Skeleton& skeleton) {
  std::vector<std::vector<int>> descendants(skeleton.num_joints());
  for (int j = 1; j < skeleton.num_joints(); ++j) {
    for (int a = skeleton.parent(j); a >= 0; a = skeleton.parent(a)) descendants[a].push_back(j);
  }
  return descendants;
}

}  // namespace

RigMoments ComputeRigMoments(const Rig& rig) {
  const int num_joints = rig.skeleton.num_joints();
  const int num_vertices = rig.weights.num_vertices();
  assert(rig.rest_positions.cols() == num_vertices && num_vertices > 0);
  RigMoments moments;
  moments.num_joints = num_joints;
  moments.num_vertices =
      rig.fit_weights.size() == 0 ? num_vertices : rig.fit_weights.cast<double>().sum();
  moments.center = rig.rest_positions.rowwise().mean();
  moments.products.assign(static_cast<size_t>(num_joints) * num_joints, Eigen::Matrix4d::Zero());
  for (int v = 0; v < num_vertices; ++v) {
    const VertexInfluences& influences = rig.weights.vertex(v);
    const auto weights = NormalizedWeights(influences);
    Vector4d u;
    u << rig.rest_positions.col(v) - moments.center, 1;
    const Eigen::Matrix4d square = rig.fit_weight(v) * u * u.transpose();
    for (int k = 0; k < kMaxInfluences && weights[k] > 0; ++k) {
      for (int l = 0; l < kMaxInfluences && weights[l] > 0; ++l) {
        moments.products[influences.bones[k] * num_joints + influences.bones[l]] +=
            (weights[k] * weights[l]) * square;
      }
    }
  }
  moments.weighted.assign(num_joints, Eigen::Matrix4d::Zero());
  for (int k = 0; k < num_joints; ++k) {
    for (int l = 0; l < num_joints; ++l) {
      moments.weighted[k] += moments.products[k * num_joints + l];
    }
  }
  return moments;
}

FrameMoments ComputeFrameMoments(const Rig& rig, const RigMoments& rig_moments,
                                 const Eigen::Matrix3Xf& positions) {
  assert(positions.cols() == rig.rest_positions.cols());
  FrameMoments frame;
  Vector3d sum = Vector3d::Zero();
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    sum += rig.fit_weight(v) * positions.col(v).cast<double>();
  }
  frame.center = sum / rig_moments.num_vertices;
  frame.cross.assign(rig_moments.num_joints, Matrix4x3d::Zero());
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    const VertexInfluences& influences = rig.weights.vertex(static_cast<int>(v));
    const auto weights = NormalizedWeights(influences);
    const Vector3d y = positions.col(v).cast<double>() - frame.center;
    const double fit_weight = rig.fit_weight(v);
    frame.sum_squares += fit_weight * y.squaredNorm();
    Vector4d u;
    u << rig.rest_positions.col(v) - rig_moments.center, 1;
    const Matrix4x3d product = fit_weight * u * y.transpose();
    for (int k = 0; k < kMaxInfluences && weights[k] > 0; ++k) {
      frame.cross[influences.bones[k]] += weights[k] * product;
    }
  }
  return frame;
}

ChainMoments ComputeChainMoments(const RigMoments& moments, const Skeleton& skeleton) {
  const int num_joints = moments.num_joints;
  assert(skeleton.num_joints() == num_joints);
  const auto descendants = StrictDescendants(skeleton);
  // g_ia = sum_k W_ik A_ak u_i with A_aa = [I | -pivot], A_ak = [0 | offset] for descendants k of
  // a; so block ab of the Gram matrix is sum_kl A_ak U_kl A_bl^T.
  ChainMoments chain;
  chain.num_joints = num_joints;
  chain.num_vertices = moments.num_vertices;
  chain.gram = Eigen::MatrixXd::Zero(3 * num_joints, 3 * num_joints);
  chain.sums = Eigen::Matrix3Xd::Zero(3, num_joints);
  std::vector<Matrix4x3d> right(num_joints);  // sum_l U_kl A_bl^T for the current b
  for (int b = 1; b < num_joints; ++b) {
    const Vector3d& parent_position = skeleton.rest_position(skeleton.parent(b));
    const Matrix3x4d own = OwnBlock(parent_position - moments.center);
    const Vector3d offset = skeleton.rest_position(b) - parent_position;
    for (int k = 1; k < num_joints; ++k) {
      right[k] = moments.products[k * num_joints + b] * own.transpose();
      for (const int l : descendants[b]) {
        right[k] += moments.products[k * num_joints + l].col(3) * offset.transpose();
      }
      chain.sums.col(b) += right[k].row(3).transpose();  // weights add up to 1
    }
    for (int a = 1; a < num_joints; ++a) {
      const Vector3d& pivot_a = skeleton.rest_position(skeleton.parent(a));
      Matrix3d block = OwnBlock(pivot_a - moments.center) * right[a];
      const Vector3d offset_a = skeleton.rest_position(a) - pivot_a;
      for (const int k : descendants[a]) block += offset_a * right[k].row(3);
      chain.gram.block<3, 3>(3 * a, 3 * b) = block;
    }
  }
  return chain;
}

Eigen::MatrixXd ComputeChainCross(const RigMoments& moments, const FrameMoments& frame,
                                  const Skeleton& skeleton) {
  const int num_joints = moments.num_joints;
  Eigen::MatrixXd cross = Eigen::MatrixXd::Zero(3 * num_joints, 3);
  // The sums of the homogeneous row over strict descendants. A parent has a lower index than its
  // children, so counting down visits leaves first.
  std::vector<Eigen::RowVector3d> below(num_joints, Eigen::RowVector3d::Zero());
  for (int a = num_joints - 1; a >= 1; --a) {
    const int parent = skeleton.parent(a);
    const Vector3d& pivot = skeleton.rest_position(parent);
    cross.middleRows<3>(3 * a) = OwnBlock(pivot - moments.center) * frame.cross[a] +
                                 (skeleton.rest_position(a) - pivot) * below[a];
    below[parent] += below[a] + frame.cross[a].row(3);
  }
  return cross;
}

}  // namespace pleat
