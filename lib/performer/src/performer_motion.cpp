#include "performer_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "footwork.h"
#include "interpolation.h"
#include "pleat/base/random.h"
#include "pleat/skeleton/human_template.h"
#include "smooth_noise.h"

namespace pleat {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr double kEaseIn_s = .8;    // time from standing still to moving
constexpr double kLookAhead_s = 3;  // planned beyond the end: steps aim at where the hips will be

Quaterniond About(double angle, const Vector3d& axis) {
  return Quaterniond(Eigen::AngleAxisd(angle, axis));
}
Quaterniond EulerYxz(double yaw, double pitch, double roll) {
  return About(yaw, Vector3d::UnitY()) * About(pitch, Vector3d::UnitX()) *
         About(roll, Vector3d::UnitZ());
}
Vector3d Forward(double heading) { return {std::sin(heading), 0, std::cos(heading)}; }
Vector3d Leftward(double heading) { return {std::cos(heading), 0, -std::sin(heading)}; }

// Angles of the body above the legs and height of the hips at one instant, radians and body
// heights; index 0 left, 1 right. Zero is the rest pose.
struct Bearing {
  double drop = 0, sway = 0;  // movement of the hips: down, to the left
  double pelvis_pitch = 0, pelvis_yaw = 0, pelvis_roll = 0;
  double chest_pitch = 0, chest_yaw = 0, chest_roll = 0;
  double head_pitch = 0, head_yaw = 0;
  std::array<double, 2> arm_flexion{}, arm_abduction{}, arm_twist{}, elbow{};
};

class MotionGenerator {
 public:
  MotionGenerator(const Skeleton& skeleton, const MotionOptions& options)
      : skeleton_(skeleton),
        options_(options),
        walk_(options.style == PerformerStyle::kWalk),
        random_(options.seed * 2654435761u + 17) {}

  PoseTrack Generate();

 private:
  Bearing Walk(double time_s, double phase) const;
  Bearing Dance(double time_s, double phase) const;
  Course PlanCourse(int num_frames) const;
  double TurnRate(double time_s, const Vector3d& at, double heading) const;
  Vector3d Velocity(double time_s, double heading) const;
  double JumpHeight(double time_s) const;
  void PoseUpperBody(const Bearing& bearing, double ease, Pose* pose) const;
  void PoseLegs(const std::array<FootTarget, 2>& feet, double ease, Pose* pose) const;

  const Skeleton& skeleton_;
  const MotionOptions& options_;
  const bool walk_;
  Random random_;
  const double tempo_ = random_.Uniform(.92, 1.08);
  const double jump_offset_s_ = random_.Uniform(0, 5);
  // Members are initialized in this order, and each draws from random_: the order is part of what a
  // seed means.
  const SmoothNoise tempo_noise_{&random_, 5}, turn_{&random_, 4}, spin_{&random_, 5};
  const SmoothNoise energy_{&random_, 6}, crouch_{&random_, 3.5}, twist_{&random_, 4.5};
  const SmoothNoise sway_{&random_, 3.8}, lean_{&random_, 5}, look_{&random_, 3};
  const std::array<SmoothNoise, 2> drift_{SmoothNoise{&random_, 5}, SmoothNoise{&random_, 5}};
  const std::array<SmoothNoise, 2> spread_{SmoothNoise{&random_, 4}, SmoothNoise{&random_, 4}};
  const std::array<SmoothNoise, 2> advance_{SmoothNoise{&random_, 4}, SmoothNoise{&random_, 4}};
  const std::array<SmoothNoise, 2> raise_{SmoothNoise{&random_, 5}, SmoothNoise{&random_, 5}};
  const std::array<SmoothNoise, 2> reach_{SmoothNoise{&random_, 3}, SmoothNoise{&random_, 3}};
  const std::array<SmoothNoise, 2> bend_{SmoothNoise{&random_, 3}, SmoothNoise{&random_, 3}};
};

// One instant of a walk. phase: 0 where the left heel meets the floor.
Bearing MotionGenerator::Walk(double time_s, double phase) const {
  const double standing = phase - kTwoPi * Footwork::kStance / 2;  // 0: left foot below the hips
  Bearing b;
  b.drop = .013 - .006 * std::cos(2 * standing);
  b.sway = .010 * std::cos(standing);
  b.pelvis_yaw = -.12 * std::cos(phase);
  b.pelvis_roll = .05 * std::cos(standing);
  b.pelvis_pitch = .04 + .03 * lean_(time_s);
  b.chest_yaw = -1.9 * b.pelvis_yaw + .06 * twist_(time_s);
  b.chest_roll = -.8 * b.pelvis_roll;
  b.chest_pitch = .02 * sway_(time_s);
  b.head_yaw = .9 * b.pelvis_yaw + .25 * look_(time_s);
  b.head_pitch = .06 * lean_(time_s + 1);
  const double vigor = 1 + .3 * energy_(time_s);
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1 : -1;
    b.arm_flexion[side] = -.36 * sign * vigor * std::cos(phase) + .05 * reach_[side](time_s);
    b.arm_abduction[side] = .02 + .05 * raise_[side](time_s);
    b.elbow[side] = .26 - .14 * sign * vigor * std::cos(phase) + .08 * bend_[side](time_s);
  }
  return b;
}

// One instant of a dance: the same cycle of steps, with larger and less regular movements above it.
Bearing MotionGenerator::Dance(double time_s, double phase) const {
  const double standing = phase - kTwoPi * Footwork::kStance / 2;
  const double energy = 1 + .30 * energy_(time_s);
  Bearing b;
  b.drop = std::max(.008, .025 + .024 * crouch_(time_s) - .012 * energy * std::cos(2 * standing));
  b.sway = .032 * energy * std::cos(standing);
  b.pelvis_yaw = -.17 * energy * std::cos(phase) + .22 * twist_(time_s);
  b.pelvis_roll = -.12 * energy * std::cos(standing) + .04 * sway_(time_s + 1);
  b.pelvis_pitch = .10 * lean_(time_s) + 1.2 * b.drop;
  b.chest_yaw = -1.3 * b.pelvis_yaw + .25 * twist_(time_s + 3);
  b.chest_roll = -1.1 * b.pelvis_roll + .12 * sway_(time_s);
  b.chest_pitch = -.8 * b.pelvis_pitch + .10 * lean_(time_s + 2);
  b.head_yaw = .30 * look_(time_s);
  b.head_pitch = .12 * look_(time_s + 5);
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1 : -1;
    b.arm_abduction[side] = std::clamp(.45 + .65 * raise_[side](time_s), -.02, 1.35);
    b.arm_flexion[side] = .45 * reach_[side](time_s) - .28 * sign * std::cos(phase);
    b.arm_twist[side] = .25 * reach_[1 - side](time_s);
    b.elbow[side] = std::clamp(.45 + .50 * bend_[side](time_s), 0.0, 1.3);
  }
  return b;
}

double MotionGenerator::TurnRate(double time_s, const Vector3d& at, double heading) const {
  double rate = (walk_ ? .40 : .45) * turn_(time_s);
  if (!walk_) {  // now and then a spin
    const double burst = spin_(time_s);
    rate += 1.5 * Smoothstep(.5, .9, std::abs(burst)) * (burst > 0 ? 1 : -1);
  }
  // Far from the start the way bends back to it.
  const double away = std::remainder(std::atan2(-at.x(), -at.z()) - heading, kTwoPi);
  return rate + (walk_ ? .8 : .2) * Smoothstep(1.5, 3.5, at.norm()) * std::sin(away);
}

Vector3d MotionGenerator::Velocity(double time_s, double heading) const {
  if (walk_) return (.53 + .06 * energy_(time_s)) * Forward(heading);  // body heights per second
  return .16 * (drift_[0](time_s) * Leftward(heading) + drift_[1](time_s) * Forward(heading));
}

double MotionGenerator::JumpHeight(double time_s) const {
  if (walk_) return 0;
  constexpr double kEvery_s = 5.5, kFlight_s = .36, kTop = .055;  // body heights
  const double since = std::fmod(time_s + jump_offset_s_, kEvery_s) - 2;
  if (since <= 0 || since >= kFlight_s) return 0;
  const double u = since / kFlight_s;
  return 4 * kTop * u * (1 - u) * Smoothstep(kEaseIn_s, 2 * kEaseIn_s, time_s);
}

// Integrates heading and path over time. Steps are taken faster in a turn, and everything eases in
// from standing still, so that frame 0 is the rest pose.
Course MotionGenerator::PlanCourse(int num_frames) const {
  const double cycles_per_s = (walk_ ? .90 : .74) * tempo_;
  Course course;
  double cycles = 0, heading = 0;
  Vector3d at = Vector3d::Zero();
  for (int t = 0; t < num_frames; ++t) {
    const double time_s = t / options_.fps;
    const double ease = Smoothstep(0, kEaseIn_s, time_s);
    course.cycles.push_back(cycles);
    course.liveliness.push_back(ease);
    course.path.push_back(at);
    course.heading.push_back(heading);
    course.lift.push_back(walk_ ? .035 : std::max(.03, .075 + .045 * energy_(time_s + 2)));
    for (int side = 0; side < 2; ++side) {
      const double sign = side == 0 ? 1 : -1;
      course.offsets[side].push_back(
          walk_ ? Vector3d(-.035 * sign, 0, .02)
                : Vector3d(sign * .035 * spread_[side](time_s), 0, .05 * advance_[side](time_s)));
    }
    const double step_s = ease / options_.fps;
    const double turn = TurnRate(time_s, at, heading);
    heading += step_s * turn;
    at += step_s * Velocity(time_s, heading);
    cycles += step_s * cycles_per_s * (1 + .12 * tempo_noise_(time_s) + .25 * std::abs(turn));
  }
  return course;
}

void MotionGenerator::PoseUpperBody(const Bearing& b, double ease, Pose* pose) const {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const auto eased = [ease](const Quaterniond& q) {
    return Quaterniond::Identity().slerp(ease, q);
  };
  // The trunk's turn is shared by its two bones.
  const Quaterniond half_trunk =
      eased(EulerYxz(b.chest_yaw / 2, b.chest_pitch / 2, b.chest_roll / 2));
  pose->rotations[kSpine] = half_trunk;
  pose->rotations[kChest] = half_trunk;
  pose->rotations[kHead] = eased(EulerYxz(b.head_yaw, b.head_pitch, 0));
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1 : -1;
    const int arm = side == 0 ? kLeftUpperArm : kRightUpperArm;
    // The collar bone takes a quarter of a raised arm.
    pose->rotations[arm] = eased(About(sign * .25 * std::max(0.0, b.arm_abduction[side]), z));
    pose->rotations[arm + 1] =
        eased(About(sign * .75 * b.arm_abduction[side], z) * About(-b.arm_flexion[side], x) *
              About(sign * b.arm_twist[side], y));
    pose->rotations[arm + 2] = eased(About(-b.elbow[side], x));
  }
}

// The legs follow the feet: two-bone inverse kinematics in the axes of the pelvis, then the foot's
// own turn against that of the leg.
void MotionGenerator::PoseLegs(const std::array<FootTarget, 2>& feet, double ease,
                               Pose* pose) const {
  const Quaterniond& pelvis = pose->rotations[kHips];
  for (int side = 0; side < 2; ++side) {
    const int leg = side == 0 ? kLeftUpperLeg : kRightUpperLeg;
    const Vector3d& hip = skeleton_.rest_position(leg);
    const Vector3d thigh = skeleton_.rest_position(leg + 1) - hip;
    const Vector3d shin = skeleton_.rest_position(leg + 2) - skeleton_.rest_position(leg + 1);
    const Vector3d hip_world =
        pose->root_position + pelvis * (hip - skeleton_.rest_position(kHips));
    const LegAngles angles =
        SolveLeg(thigh, shin, pelvis.conjugate() * (feet[side].ankle - hip_world));
    const Quaterniond foot =
        About(feet[side].yaw, Vector3d::UnitY()) * About(feet[side].pitch, Vector3d::UnitX());
    const auto eased = [ease](const Quaterniond& q) {
      return Quaterniond::Identity().slerp(ease, q);
    };
    pose->rotations[leg + 1] = eased(angles.Thigh());
    pose->rotations[leg + 2] = eased(angles.Knee());
    pose->rotations[leg + 3] = eased((pelvis * angles.Thigh() * angles.Knee()).conjugate() * foot);
  }
}

PoseTrack MotionGenerator::Generate() {
  const Course course =
      PlanCourse(options_.num_frames + static_cast<int>(std::ceil(kLookAhead_s * options_.fps)));
  const Footwork footwork(skeleton_, course, walk_ ? .75 : .45);
  PoseTrack::Parts track{.fps = options_.fps};
  for (int t = 0; t < options_.num_frames; ++t) {
    const double time_s = t / options_.fps;
    const double ease = course.liveliness[t];
    const double heading = course.heading[t];
    const double phase = kTwoPi * (course.cycles[t] + Footwork::kStart[0]);
    const Bearing bearing = walk_ ? Walk(time_s, phase) : Dance(time_s, phase);
    const double jump = JumpHeight(time_s);
    std::array<FootTarget, 2> feet = {footwork.At(0, t), footwork.At(1, t)};
    for (FootTarget& foot : feet) foot.ankle.y() += jump;

    Pose pose = Pose::Rest(skeleton_);
    pose.root_position += course.path[t] + ease * bearing.sway * Leftward(heading) +
                          (jump - ease * bearing.drop) * Vector3d::UnitY();
    pose.rotations[kHips] = About(heading, Vector3d::UnitY()) *
                            EulerYxz(ease * bearing.pelvis_yaw, ease * bearing.pelvis_pitch,
                                     ease * bearing.pelvis_roll);
    PoseUpperBody(bearing, ease, &pose);
    PoseLegs(feet, ease, &pose);
    track.poses.push_back(std::move(pose));
  }
  return PoseTrack::FromValid(std::move(track));
}

}  // namespace

PoseTrack GenerateMotion(const Skeleton& skeleton, const MotionOptions& options) {
  return MotionGenerator(skeleton, options).Generate();
}

}  // namespace pleat
