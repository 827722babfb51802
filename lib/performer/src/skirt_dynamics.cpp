// Extended position-based dynamics: M. Macklin, M. Mueller, N. Chentanez, "XPBD: position-based
// simulation of compliant constrained dynamics", MIG 2016, with small steps of one iteration
// (Macklin et al., "Small steps in physics simulation", SCA 2019). Masses are 1, so a compliance is
// 1 / (angular frequency squared). Constraints are solved one after the other in the order of
// links_, on one thread: the order shows in the result.
#include "skirt_dynamics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "body_mesh.h"
#include "pleat/base/status.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

using Eigen::Vector3d;

constexpr double kStretchCompliance = 2e-7, kShearCompliance = 6e-5, kBendCompliance = 1.2e-3;
constexpr double kHemFrequency = 3.2;     // rad/s at which the hem swings about the skinned bell
constexpr double kWaistFrequency = 45.0;  // rad/s
constexpr double kDamping = 1.0;          // 1/s, against the moving bell
constexpr double kAirDrag = .6;           // 1/s, against still air
constexpr double kLegMargin = .015;       // cloth over skin, body heights
constexpr double kStep_s = 1. / 400;      // longest substep

// Returns the Catmull-Rom weights of four neighbors at fraction u.
std::array<double, 4> CubicWeights(double u) {
  return {((-.5 * u + 1) * u - .5) * u, (1.5 * u - 2.5) * u * u + 1, ((-1.5 * u + 2) * u + .5) * u,
          (.5 * u - .5) * u * u};
}

}  // namespace

SkirtDynamics::SkirtDynamics(const CharacterShape& shape) : shape_(shape) {
  constexpr int kNumParticles = kNumStrands * kNumRings;
  rest_.resize(3, kNumParticles);
  bone_weights_.resize(kNumHumanJoints, kNumParticles);
  share_of_way_.resize(kNumParticles);
  for (int ring = 0; ring < kNumRings; ++ring) {
    const double s = static_cast<double>(ring) / (kNumRings - 1);
    for (int strand = 0; strand < kNumStrands; ++strand) {
      const int id = Id(ring, strand);
      rest_.col(id) = shape.skirt().Point(2 * std::numbers::pi * strand / kNumStrands, s);
      bone_weights_.col(id) = SkirtBoneWeights(rest_(0, id), s, 1);
      share_of_way_[id] = s;
    }
  }
  strand_tangents_.resize(3, kNumParticles);
  for (int ring = 0; ring < kNumRings; ++ring) {
    for (int strand = 0; strand < kNumStrands; ++strand) {
      const int id = Id(ring, strand);
      strand_tangents_.col(id) = (rest_.col(Id(std::min(ring + 1, kNumRings - 1), strand)) -
                                  rest_.col(Id(std::max(ring - 1, 0), strand)))
                                     .normalized();
      AddLink(id, Id(ring, strand + 1), kStretchCompliance);
      AddLink(id, Id(ring, strand + 2), kBendCompliance);
      if (ring + 1 < kNumRings) {
        AddLink(id, Id(ring + 1, strand), kStretchCompliance);
        AddLink(id, Id(ring + 1, strand + 1), kShearCompliance);
        AddLink(id, Id(ring + 1, strand - 1), kShearCompliance);
      }
      if (ring + 2 < kNumRings) AddLink(id, Id(ring + 2, strand), kBendCompliance);
    }
  }
}

void SkirtDynamics::AddLink(int a, int b, double compliance) {
  links_.push_back({a, b, (rest_.col(a) - rest_.col(b)).norm(), compliance});
}

// The skinned bell, the legs and the forces at one pose. They are measured at whole frames;
// Simulate() interpolates them for the substeps.
void SkirtDynamics::MeasureSurroundings(const Pose& pose, double gravity, Surroundings* out) const {
  const Skeleton& skeleton = shape_.skeleton();
  BoneTransforms bones;
  ComputeBoneTransforms(skeleton, pose, {}, &bones);
  out->targets.setZero(3, rest_.cols());
  for (int id = 0; id < rest_.cols(); ++id) {
    for (int b = 1; b < skeleton.num_joints(); ++b) {
      const double weight = bone_weights_(b, id);
      if (weight > 0) {
        out->targets.col(id) += weight * (bones.linear[b] * rest_.col(id) + bones.translation[b]);
      }
    }
  }
  const auto joint = [&](int j) { return Vector3d(bones.joint_positions.col(j)); };
  out->legs.clear();
  for (int hip : {kLeftUpperLeg, kRightUpperLeg}) {
    out->legs.push_back({joint(hip), joint(hip + 1), .040 + kLegMargin});
    out->legs.push_back({joint(hip + 1), joint(hip + 2), .030 + kLegMargin});
  }
  // The cloth's tension carries its weight along the strands; across them the flare of the rest
  // shape does, which turns with the hips. So the rest shape is at rest.
  const Vector3d down(0, -gravity, 0);
  out->forces.resize(3, rest_.cols());
  for (int id = 0; id < rest_.cols(); ++id) {
    const Vector3d tangent = strand_tangents_.col(id);
    const Vector3d support = -(down - down.dot(tangent) * tangent);
    out->forces.col(id) = down + bones.rotation[0] * support;
  }
}

// Pushes particles out of the capsules of the legs. The first ring is pinned and stays. Later
// capsules may push back into earlier ones, which the next substep corrects.
void SkirtDynamics::Collide(const std::vector<Capsule>& legs) {
  for (int id = kNumStrands; id < positions_.cols(); ++id) {
    Vector3d x = positions_.col(id);
    for (const Capsule& leg : legs) {
      const Vector3d axis = leg.b - leg.a;
      const double t = std::clamp((x - leg.a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
      const Vector3d away = x - leg.a - t * axis;
      const double distance = away.norm();
      if (distance < leg.radius && distance > 1e-9) x += (leg.radius / distance - 1) * away;
    }
    positions_.col(id) = x;
  }
}

// One substep: forces, then the constraints (links, the pull to the bell, the legs), then
// velocities from the change of positions, which is where collisions and constraints take effect on
// them.
void SkirtDynamics::Step(const Surroundings& now, double step_s) {
  const Eigen::Matrix3Xd before = positions_;
  const double inverse_step2 = 1 / (step_s * step_s);
  for (int id = kNumStrands; id < positions_.cols(); ++id) {
    const Vector3d velocity = velocities_.col(id);
    velocities_.col(id) +=
        step_s * (now.forces.col(id) - kDamping * (velocity - now.target_velocities.col(id)) -
                  kAirDrag * velocity);
    positions_.col(id) += step_s * velocities_.col(id);
  }
  positions_.leftCols(kNumStrands) = now.targets.leftCols(kNumStrands);  // waistband
  for (const Link& link : links_) {
    const double mass_a = link.a < kNumStrands ? 0 : 1, mass_b = link.b < kNumStrands ? 0 : 1;
    if (mass_a + mass_b == 0) continue;
    const Vector3d difference = positions_.col(link.a) - positions_.col(link.b);
    const double length = std::max(difference.norm(), 1e-9);
    const double multiplier =
        (length - link.rest_length) / (mass_a + mass_b + link.compliance * inverse_step2) / length;
    positions_.col(link.a) -= mass_a * multiplier * difference;
    positions_.col(link.b) += mass_b * multiplier * difference;
  }
  for (int id = kNumStrands; id < positions_.cols(); ++id) {
    const double s = share_of_way_[id];
    // The pull to the skinned bell falls from the waist to the hem: cloth follows the hips above
    // and swings below. It is an XPBD constraint of rest length zero; the limit keeps a violent
    // dance from tearing the skirt off.
    const double frequency = kHemFrequency + (kWaistFrequency - kHemFrequency) * std::pow(1 - s, 3);
    Vector3d offset = positions_.col(id) - now.targets.col(id);
    offset *= 1 - 1 / (1 + inverse_step2 / (frequency * frequency));
    const double limit = kMaxDisplacement * std::sqrt(s);
    if (offset.norm() > limit) offset *= limit / offset.norm();
    positions_.col(id) = now.targets.col(id) + offset;
  }
  Collide(now.legs);
  velocities_ = (positions_ - before) / step_s;
}

// Starts in pose 0 on the skinned bell with all velocities zero.
absl::StatusOr<std::vector<Eigen::Matrix3Xf>> SkirtDynamics::Simulate(const PoseTrack& track,
                                                                      double gravity,
                                                                      const Progress& progress) {
  const int num_substeps = std::max(1, static_cast<int>(std::ceil(1 / (track.fps() * kStep_s))));
  const double step_s = 1 / (track.fps() * num_substeps);
  Surroundings from, to, now;
  MeasureSurroundings(track.pose(0), gravity, &from);
  positions_ = from.targets;
  velocities_.setZero(3, positions_.cols());
  std::vector<Eigen::Matrix3Xf> displacements;
  displacements.push_back(Eigen::Matrix3Xf::Zero(3, positions_.cols()));
  for (int t = 1; t < track.num_frames(); ++t) {
    MeasureSurroundings(track.pose(t), gravity, &to);
    now = to;
    now.target_velocities = (to.targets - from.targets) * track.fps();
    for (int i = 1; i <= num_substeps; ++i) {
      const double u = static_cast<double>(i) / num_substeps;
      now.targets = from.targets + u * (to.targets - from.targets);
      now.forces = from.forces + u * (to.forces - from.forces);
      for (size_t leg = 0; leg < now.legs.size(); ++leg) {
        now.legs[leg].a = from.legs[leg].a + u * (to.legs[leg].a - from.legs[leg].a);
        now.legs[leg].b = from.legs[leg].b + u * (to.legs[leg].b - from.legs[leg].b);
      }
      Step(now, step_s);
    }
    displacements.push_back((positions_ - to.targets).cast<float>());
    std::swap(from, to);
    PLEAT_RETURN_IF_ERROR(progress.Report((t + 1.) / track.num_frames()));
  }
  return displacements;
}

SkirtSample SkirtDynamics::Locate(const Vector3d& rest_point) const {
  const SkirtShape& skirt = shape_.skirt();
  const double theta = std::atan2(rest_point.x(), rest_point.z() - skirt.center_z);
  const double along = theta / (2 * std::numbers::pi) * kNumStrands;
  const double down = std::clamp(skirt.Fraction(rest_point.y()), 0.0, 1.0) * (kNumRings - 1);
  const double strand = std::floor(along);
  const double ring = std::min(std::floor(down), kNumRings - 2.0);
  const std::array<double, 4> across = CubicWeights(along - strand);
  const std::array<double, 4> downward = CubicWeights(down - ring);
  SkirtSample sample;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const int r = std::clamp(static_cast<int>(ring) + i - 1, 0, kNumRings - 1);
      sample.ids[4 * i + j] = Id(r, static_cast<int>(strand) + j - 1);
      sample.weights[4 * i + j] = static_cast<float>(downward[i] * across[j]);
    }
  }
  return sample;
}

}  // namespace pleat
