#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "body_mesh.h"
#include "interpolation.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

using Eigen::Vector3d;

constexpr double kDiffusionLength = .016;  // half width of a joint's blend, body heights

double SegmentDistance(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d axis = b - a;
  const double t = std::clamp((p - a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - a - t * axis).norm();
}

// A vertex may only follow bones of its own region: the hand beside the hip must not stick to it.
std::span<const int> RegionBones(BodyRegion region) {
  static constexpr int kTorso[] = {kSpine,         kChest,        kHead,         kLeftUpperArm,
                                   kRightUpperArm, kLeftUpperLeg, kRightUpperLeg};
  static constexpr int kLeftArm[] = {kLeftLowerArm, kLeftHand};
  static constexpr int kRightArm[] = {kRightLowerArm, kRightHand};
  static constexpr int kLeftLeg[] = {kLeftLowerLeg, kLeftFoot, kLeftToes};
  static constexpr int kRightLeg[] = {kRightLowerLeg, kRightFoot, kRightToes};
  switch (region) {
    case BodyRegion::kLeftArm:
      return kLeftArm;
    case BodyRegion::kRightArm:
      return kRightArm;
    case BodyRegion::kLeftLeg:
      return kLeftLeg;
    case BodyRegion::kRightLeg:
      return kRightLeg;
    default:
      return kTorso;
  }
}

int NearestBone(const CharacterShape& shape, BodyRegion region, const Vector3d& p) {
  int nearest = 0;
  double best = std::numeric_limits<double>::infinity();
  for (int b : RegionBones(region)) {
    const Skeleton& skeleton = shape.skeleton();
    const double distance =
        SegmentDistance(p, skeleton.rest_position(skeleton.parent(b)), skeleton.rest_position(b));
    if (distance < best) {
      best = distance;
      nearest = b;
    }
  }
  return nearest;
}

// Returns the weights before diffusion, V x num_joints.
Eigen::MatrixXd AssignBones(const CharacterShape& shape, const TriangleSoup& mesh) {
  const int num_vertices = static_cast<int>(mesh.positions.size());
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(num_vertices, kNumHumanJoints);
  for (int v = 0; v < num_vertices; ++v) {
    const Vector3d& p = mesh.positions[v];
    const BodyRegion region = shape.NearestRegion(p);
    if (region == BodyRegion::kSkirt) {
      const double s = std::clamp(shape.skirt().Fraction(p.y()), 0.0, 1.0);
      const double off_leg = Smoothstep(.002, .022, shape.LegDistance(p));
      weights.row(v) = SkirtBoneWeights(p.x(), s, off_leg).transpose();
    } else {
      weights(v, NearestBone(shape, region, p)) = 1;
    }
  }
  return weights;
}

// Returns M + c L with the cotangent Laplacian L and lumped areas M, and fills `areas`.
Eigen::SparseMatrix<double> DiffusionMatrix(const TriangleSoup& mesh, double coefficient,
                                            Eigen::VectorXd* areas) {
  const int num_vertices = static_cast<int>(mesh.positions.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(mesh.triangles.size() * 12 + num_vertices);
  *areas = Eigen::VectorXd::Zero(num_vertices);
  for (const std::array<int, 3>& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      const int i = t[(c + 1) % 3], j = t[(c + 2) % 3];
      const Vector3d u = mesh.positions[i] - mesh.positions[t[c]];
      const Vector3d w = mesh.positions[j] - mesh.positions[t[c]];
      const double double_area = u.cross(w).norm();
      // Clamped at 0 (obtuse corners), so that diffusion never makes a weight negative.
      const double half_cotangent = std::max(u.dot(w), 0.0) / (2 * std::max(double_area, 1e-15));
      (*areas)[t[c]] += double_area / 6;
      const double value = coefficient * half_cotangent;
      entries.emplace_back(i, i, value);
      entries.emplace_back(j, j, value);
      entries.emplace_back(i, j, -value);
      entries.emplace_back(j, i, -value);
    }
  }
  for (int v = 0; v < num_vertices; ++v) entries.emplace_back(v, v, (*areas)[v]);
  Eigen::SparseMatrix<double> matrix(num_vertices, num_vertices);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

Eigen::VectorXd SkirtBoneWeights(double x, double s, double off_leg) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(kNumHumanJoints);
  const double left = Smoothstep(-.09, .09, x);
  const double waist = .6 * (1 - Smoothstep(0, .25, s));
  // The bell follows the thighs only in part; its underside meets them at the legs.
  const double thighs = (1 - waist) * Smoothstep(.15, 1, s) * (1 - .60 * off_leg);
  const double pelvis = 1 - waist - thighs;
  weights[kSpine] = waist;
  weights[kLeftUpperLeg] = pelvis * left;
  weights[kRightUpperLeg] = pelvis * (1 - left);
  weights[kLeftLowerLeg] = thighs * left;
  weights[kRightLowerLeg] = thighs * (1 - left);
  return weights;
}

absl::StatusOr<SkinWeights> BuildBodyWeights(const CharacterShape& shape,
                                             const TriangleSoup& mesh) {
  Eigen::MatrixXd weights = AssignBones(shape, mesh);
  Eigen::VectorXd areas;
  const Eigen::SparseMatrix<double> matrix =
      DiffusionMatrix(mesh, kDiffusionLength * kDiffusionLength / 2, &areas);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) {
    return absl::InternalError("performer: the weights could not be diffused over the surface");
  }
  for (int step = 0; step < 2; ++step) {  // two implicit Euler steps: smooth at the start, too
    weights = solver.solve(Eigen::MatrixXd(areas.asDiagonal() * weights));
  }
  weights = (weights.array() < .004).select(0, weights);
  return SkinWeights::FromDense(weights);
}

}  // namespace pleat
