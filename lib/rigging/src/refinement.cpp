#include "pleat/rigging/refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pleat/geometry/point_index.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

constexpr int kSamplesPerLeaf = 10;  // of the search tree

// Body segments as shares of the stature: R. Drillis, R. Contini, "Body segment parameters", 1966
// (as tabulated in D. Winter, "Biomechanics and Motor Control of Human Movement").
constexpr double kThigh = .245, kLowerLeg = .246, kTrunk = .818 - .530;  // shoulders above hips

Eigen::Matrix3Xd PositionsOf(const std::vector<MedialSample>& samples) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(samples.size()));
  for (size_t i = 0; i < samples.size(); ++i) {
    positions.col(static_cast<Eigen::Index>(i)) = samples[i].position;
  }
  return positions;
}

class RefinementObjective {
 public:
  RefinementObjective(const Eigen::Matrix3Xd& template_joints,
                      const std::vector<MedialSample>& medial_samples,
                      const RefinementOptions& options)
      : options_(options),
        template_joints_(template_joints),
        samples_(medial_samples),
        places_(PositionsOf(medial_samples), kSamplesPerLeaf) {}

  // Returns the energy at `joints` and fills the Gauss-Newton system. Gradient and matrix are
  // halves of the true ones, which leaves the step the same.
  double Evaluate(const Eigen::Matrix3Xd& joints, Eigen::MatrixXd* hessian,
                  Eigen::VectorXd* gradient) const {
    hessian->setZero(joints.size(), joints.size());
    gradient->setZero(joints.size());
    double energy = 0;
    for (int b = 1; b < kNumHumanJoints; ++b) {
      energy += Centering(joints, b, hessian, gradient);
      energy += Shape(joints, b, hessian, gradient);
    }
    energy += Proportions(joints, hessian, gradient);
    for (const int j : options_.held_joints) {
      gradient->segment<3>(3 * j).setZero();
      hessian->middleCols<3>(3 * j).setZero();
      hessian->middleRows<3>(3 * j).setZero();
      hessian->block<3, 3>(3 * j, 3 * j).setIdentity();
    }
    return energy;
  }

 private:
  static int Parent(int b) { return HumanTemplate().parent(b); }
  static bool IsLeaf(int b) { return HumanTemplate().children(b).empty(); }
  static bool CrossesTrunk(int b) {
    return b == kLeftUpperLeg || b == kRightUpperLeg || b == kLeftUpperArm || b == kRightUpperArm;
  }

  // The projector `across` turns with the bone, but its derivative is left out: it is small near
  // the medial surface, and a step that does not lower the energy is refused.
  double Centering(const Eigen::Matrix3Xd& joints, int b, Eigen::MatrixXd* hessian,
                   Eigen::VectorXd* gradient) const {
    if (samples_.empty()) return 0;
    const Eigen::Vector3d direction = (joints.col(b) - joints.col(Parent(b))).normalized();
    Eigen::Matrix3d across = Eigen::Matrix3d::Identity();
    if (!IsLeaf(b)) across -= direction * direction.transpose();
    double energy = 0;
    for (int k = 1; k <= options_.samples_per_bone; ++k) {
      const double share = static_cast<double>(k) / options_.samples_per_bone;
      const Eigen::Vector3d point = (1 - share) * joints.col(Parent(b)) + share * joints.col(b);
      const MedialSample& sample = samples_[places_.Nearest(point, nullptr)];
      const double clarity = std::min(1.0, options_.limb_radius / sample.depth);
      const Eigen::Matrix3d metric =
          options_.centering / options_.samples_per_bone * clarity * clarity * across;
      const Eigen::Vector3d residual = point - sample.position;
      energy += residual.dot(metric * residual);
      const int ends[2] = {Parent(b), b};
      const double factors[2] = {1 - share, share};
      for (int i = 0; i < 2; ++i) {
        gradient->segment<3>(3 * ends[i]) += factors[i] * metric * residual;
        for (int j = 0; j < 2; ++j) {
          hessian->block<3, 3>(3 * ends[i], 3 * ends[j]) += factors[i] * factors[j] * metric;
        }
      }
    }
    return energy;
  }

  // Length, angle and symmetry of bone b. A mirror pair is counted once, at its lower index.
  double Shape(const Eigen::Matrix3Xd& joints, int b, Eigen::MatrixXd* hessian,
               Eigen::VectorXd* gradient) const {
    const Eigen::Vector3d bone = joints.col(b) - joints.col(Parent(b));
    const Eigen::Vector3d target = template_joints_.col(b) - template_joints_.col(Parent(b));
    const double length = std::max(bone.norm(), 1e-9), target_length = target.norm();
    const Eigen::Vector3d direction = bone / length;

    const double length_residual = length / target_length - 1;
    const double length_weight = CrossesTrunk(b) ? options_.trunk_length : options_.length;
    AddRow(length_weight, length_residual, {{Parent(b), b}}, {direction / target_length}, hessian,
           gradient);
    double energy = length_weight * length_residual * length_residual;

    // |u - t|^2 = 2 (1 - cos) makes the angle a sum of squares.
    const Eigen::Vector3d angle_residual = direction - target / target_length;
    const Eigen::Matrix3d turn =
        (Eigen::Matrix3d::Identity() - direction * direction.transpose()) / length;
    for (int k = 0; k < 3; ++k) {
      AddRow(0.5 * options_.angle, angle_residual[k], {{Parent(b), b}}, {turn.row(k).transpose()},
             hessian, gradient);
    }
    energy += 0.5 * options_.angle * angle_residual.squaredNorm();

    const int mirror = HumanMirror()[b];
    if (mirror > b) {
      const Eigen::Vector3d other = joints.col(mirror) - joints.col(Parent(mirror));
      const double other_length = std::max(other.norm(), 1e-9);
      const double residual = (length - other_length) / target_length;
      AddRow(options_.symmetry, residual, {{Parent(b), b}, {Parent(mirror), mirror}},
             {direction / target_length, -other / (other_length * target_length)}, hessian,
             gradient);
      energy += options_.symmetry * residual * residual;
    }
    return energy;
  }

  // The legs in themselves and against the trunk.
  double Proportions(const Eigen::Matrix3Xd& joints, Eigen::MatrixXd* hessian,
                     Eigen::VectorXd* gradient) const {
    double template_leg = 0;
    for (const int b : {kLeftLowerLeg, kLeftFoot}) {
      template_leg += (template_joints_.col(b) - template_joints_.col(Parent(b))).norm();
    }
    double energy = 0;
    const auto add = [&](double residual, const std::vector<std::pair<int, int>>& bones,
                         const std::vector<Eigen::Vector3d>& slopes) {
      AddRow(options_.proportions, residual, bones, slopes, hessian, gradient);
      energy += options_.proportions * residual * residual;
    };
    const Eigen::Vector3d trunk = .5 * (joints.col(kLeftUpperArm) + joints.col(kRightUpperArm) -
                                        joints.col(kLeftUpperLeg) - joints.col(kRightUpperLeg));
    const double leg_per_trunk = (kThigh + kLowerLeg) / kTrunk / template_leg;
    double against_trunk = -leg_per_trunk * trunk.norm();
    const Eigen::Vector3d trunk_slope = -.5 * leg_per_trunk / std::max(trunk.norm(), 1e-9) * trunk;
    std::vector<std::pair<int, int>> bones = {{kLeftUpperLeg, kLeftUpperArm},
                                              {kRightUpperLeg, kRightUpperArm}};
    std::vector<Eigen::Vector3d> slopes = {trunk_slope, trunk_slope};
    for (const int knee : {kLeftLowerLeg, kRightLowerLeg}) {
      const int hip = Parent(knee), ankle = knee + 1;
      const Eigen::Vector3d thigh = joints.col(knee) - joints.col(hip);
      const Eigen::Vector3d shin = joints.col(ankle) - joints.col(knee);
      const double thigh_length = std::max(thigh.norm(), 1e-9);
      const double shin_length = std::max(shin.norm(), 1e-9);
      const Eigen::Vector3d thigh_slope = thigh / (thigh_length * template_leg);
      const Eigen::Vector3d shin_slope = shin / (shin_length * template_leg);
      const double thigh_share = kThigh / (kThigh + kLowerLeg);
      add(((1 - thigh_share) * thigh_length - thigh_share * shin_length) / template_leg,
          {{hip, knee}, {knee, ankle}},
          {(1 - thigh_share) * thigh_slope, -thigh_share * shin_slope});
      against_trunk += .5 * (thigh_length + shin_length) / template_leg;
      bones.insert(bones.end(), {{hip, knee}, {knee, ankle}});
      slopes.insert(slopes.end(), {.5 * thigh_slope, .5 * shin_slope});
    }
    if (!options_.hip_height) {
      add(against_trunk, bones, slopes);
      return energy;
    }
    const double residual =
        (.5 * (joints(1, kLeftUpperLeg) + joints(1, kRightUpperLeg)) - *options_.hip_height) /
        template_leg;
    energy += options_.proportions * residual * residual;
    Eigen::VectorXd row = Eigen::VectorXd::Zero(gradient->size());
    row[3 * kLeftUpperLeg + 1] = row[3 * kRightUpperLeg + 1] = .5 / template_leg;
    *gradient += options_.proportions * residual * row;
    hessian->noalias() += options_.proportions * row * row.transpose();
    return energy;
  }

  // Adds one residual that depends on bones (from, to), with derivative `slopes` by to - from.
  static void AddRow(double weight, double residual, const std::vector<std::pair<int, int>>& bones,
                     const std::vector<Eigen::Vector3d>& slopes, Eigen::MatrixXd* hessian,
                     Eigen::VectorXd* gradient) {
    std::vector<std::pair<int, Eigen::Vector3d>> row;  // of the few joints that it depends on
    const auto add = [&](int joint, const Eigen::Vector3d& slope) {
      const auto known = std::ranges::find(row, joint, &std::pair<int, Eigen::Vector3d>::first);
      if (known == row.end()) {
        row.emplace_back(joint, slope);
      } else {
        known->second += slope;
      }
    };
    for (size_t i = 0; i < bones.size(); ++i) {
      add(bones[i].first, -slopes[i]);
      add(bones[i].second, slopes[i]);
    }
    for (const auto& [i, slope] : row) {
      gradient->segment<3>(3 * i) += weight * residual * slope;
      for (const auto& [j, other] : row) {
        hessian->block<3, 3>(3 * i, 3 * j) += weight * slope * other.transpose();
      }
    }
  }

  const RefinementOptions& options_;
  const Eigen::Matrix3Xd& template_joints_;
  const std::vector<MedialSample>& samples_;
  PointIndex places_;
};

}  // namespace

Eigen::Matrix3Xd RefineEmbedding(const Eigen::Matrix3Xd& joints,
                                 const Eigen::Matrix3Xd& template_joints,
                                 const std::vector<MedialSample>& medial_samples,
                                 const RefinementOptions& options) {
  const RefinementObjective objective(template_joints, medial_samples, options);
  Eigen::Matrix3Xd current = joints;
  Eigen::MatrixXd hessian, moved_hessian;
  Eigen::VectorXd gradient, moved_gradient;
  double damping = 1e-3;
  double energy = objective.Evaluate(current, &hessian, &gradient);
  for (int iteration = 0; iteration < options.max_iterations && damping < 1e8; ++iteration) {
    Eigen::MatrixXd damped = hessian;
    damped.diagonal() *= 1 + damping;
    const Eigen::VectorXd step = damped.ldlt().solve(-gradient);
    const Eigen::Matrix3Xd moved =
        current + Eigen::Map<const Eigen::Matrix3Xd>(step.data(), 3, current.cols());
    // Most steps are taken, so that the system there is needed.
    const double moved_energy = objective.Evaluate(moved, &moved_hessian, &moved_gradient);
    if (!(moved_energy < energy)) {
      damping *= 10;
      continue;
    }
    const bool converged = energy - moved_energy < 1e-6 * energy;
    current = moved;
    damping = std::max(1e-9, damping * 0.1);
    energy = moved_energy;
    std::swap(hessian, moved_hessian);
    std::swap(gradient, moved_gradient);
    if (converged) break;
  }
  return current;
}

}  // namespace pleat
