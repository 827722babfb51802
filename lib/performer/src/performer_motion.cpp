#include "performer_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "interpolation.h"
#include "pleat/base/random.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr double kEaseIn_s = .8;  // from standing still to moving

// A smooth random signal of time, within about -1..1: five sines of unrelated frequencies.
class SmoothNoise {
 public:
  SmoothNoise(Random* random, double mean_period_s) {
    for (Wave& wave : waves_) {
      wave.frequency = kTwoPi / (mean_period_s * random->Uniform(.55, 1.9));
      wave.phase = random->Uniform(0, kTwoPi);
    }
  }
  double operator()(double time_s) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(wave.frequency * time_s + wave.phase);
    return sum / 2.4;
  }

 private:
  struct Wave {
    double frequency, phase;
  };
  std::array<Wave, 5> waves_;
};

// Joint angles of one instant, radians; index 0 left, 1 right. Zero is the rest pose.
struct BodyAngles {
  std::array<double, 2> thigh_flexion{}, thigh_abduction{}, thigh_twist{}, knee{}, foot_pitch{};
  std::array<double, 2> arm_flexion{}, arm_abduction{}, arm_twist{}, elbow{};
  double pelvis_pitch = 0, pelvis_yaw = 0, pelvis_roll = 0;
  double chest_pitch = 0, chest_yaw = 0, chest_roll = 0;
  double head_pitch = 0, head_yaw = 0;
};

Quaterniond About(double angle, const Vector3d& axis) {
  return Quaterniond(Eigen::AngleAxisd(angle, axis));
}
Quaterniond EulerYxz(double yaw, double pitch, double roll) {
  return About(yaw, Vector3d::UnitY()) * About(pitch, Vector3d::UnitX()) *
         About(roll, Vector3d::UnitZ());
}

// Between sine and triangle: the standing leg passes at an even speed.
double EvenSwing(double phase) {
  constexpr double kRoundness = .94;
  return std::asin(kRoundness * std::sin(phase)) / std::asin(kRoundness);
}

// Gaussian average over time of the rows `axis` of `path` (3 x T), ends repeated.
void SmoothPath(double sigma_frames, int axis, Eigen::Matrix3Xd* path) {
  const int radius = static_cast<int>(std::ceil(3 * sigma_frames));
  const int num_frames = static_cast<int>(path->cols());
  const Eigen::VectorXd original = path->row(axis);
  for (int t = 0; t < num_frames; ++t) {
    double sum = 0, total = 0;
    for (int k = -radius; k <= radius; ++k) {
      const double weight = std::exp(-.5 * k * k / (sigma_frames * sigma_frames));
      sum += weight * original[std::clamp(t + k, 0, num_frames - 1)];
      total += weight;
    }
    (*path)(axis, t) = sum / total;
  }
}

class MotionGenerator {
 public:
  MotionGenerator(const Skeleton& skeleton, const MotionOptions& options)
      : skeleton_(skeleton), options_(options), random_(options.seed * 2654435761u + 17) {}

  PoseTrack Generate();

 private:
  BodyAngles Walk(double time_s) const;
  BodyAngles Dance(double time_s) const;
  Pose MakePose(const BodyAngles& angles, double ease) const;
  double TurnRate(double time_s, const Pose& pose) const;
  double JumpHeight(double time_s) const;
  void PlaceOnFloor(PoseTrack* track) const;

  const Skeleton& skeleton_;
  const MotionOptions& options_;
  Random random_;
  double phase_ = 0, heading_ = 0;
  const double tempo_ = random_.Uniform(.92, 1.08);
  const double jump_offset_s_ = random_.Uniform(0, 5);
  const SmoothNoise tempo_noise_{&random_, 5}, turn_{&random_, 4}, energy_{&random_, 6};
  const SmoothNoise crouch_{&random_, 3.5}, twist_{&random_, 4.5}, sway_{&random_, 3.8};
  const SmoothNoise side_{&random_, 4.2}, lean_{&random_, 5}, look_{&random_, 3};
  const std::array<SmoothNoise, 2> raise_{SmoothNoise{&random_, 5}, SmoothNoise{&random_, 5}};
  const std::array<SmoothNoise, 2> reach_{SmoothNoise{&random_, 3}, SmoothNoise{&random_, 3}};
  const std::array<SmoothNoise, 2> bend_{SmoothNoise{&random_, 3}, SmoothNoise{&random_, 3}};
};

BodyAngles MotionGenerator::Walk(double time_s) const {
  BodyAngles a;
  const double stride = .38 * (1 + .15 * energy_(time_s));
  for (int side = 0; side < 2; ++side) {
    const double phase = phase_ + side * std::numbers::pi;
    const double sign = side == 0 ? 1 : -1;
    const double swing = std::pow(std::max(0.0, std::cos(phase + .45)), 2);  // leg moves forward
    const double push =
        std::pow(std::max(0.0, -std::sin(phase - .25)), 3);  // heel leaves the floor
    a.thigh_flexion[side] = .08 + stride * EvenSwing(phase) + .30 * swing;
    a.knee[side] = .10 + 2.2 * stride * swing + .22 * push;
    a.foot_pitch[side] = a.thigh_flexion[side] - a.knee[side] + .75 * push - .18 * swing;
    a.thigh_abduction[side] = -.02;
    a.arm_flexion[side] = -.9 * stride * std::sin(phase) + .05 * reach_[side](time_s);
    a.arm_abduction[side] = .02 + .05 * raise_[side](time_s);
    a.elbow[side] = .28 - .35 * stride * std::sin(phase) + .08 * bend_[side](time_s);
    a.pelvis_roll += sign * .5 * -.07 * std::cos(phase);
    a.pelvis_yaw += sign * .5 * -.16 * std::sin(phase);
  }
  a.pelvis_pitch = .03 + .03 * lean_(time_s);
  a.chest_yaw = -1.9 * a.pelvis_yaw + .06 * twist_(time_s);
  a.chest_roll = -.8 * a.pelvis_roll;
  a.chest_pitch = .02 * sway_(time_s);
  a.head_yaw = .9 * a.pelvis_yaw + .25 * look_(time_s);
  a.head_pitch = .06 * lean_(time_s + 1);
  return a;
}

BodyAngles MotionGenerator::Dance(double time_s) const {
  BodyAngles a;
  const double energy = 1 + .30 * energy_(time_s);
  const double crouch =
      std::max(0.0, .16 + .20 * crouch_(time_s) + .09 * energy * (1 - std::cos(2 * phase_)));
  const double side_step = .12 * side_(time_s);
  for (int side = 0; side < 2; ++side) {
    const double phase = phase_ + side * std::numbers::pi;
    const double sign = side == 0 ? 1 : -1;
    const double lift = std::pow(std::max(0.0, std::sin(phase)), 2) * energy;
    const double stride = .18 * sway_(time_s + 2) * std::sin(phase + .6);
    a.thigh_flexion[side] = .85 * crouch + .48 * lift + stride;
    a.knee[side] = 1.75 * crouch + .85 * lift;
    a.foot_pitch[side] = a.thigh_flexion[side] - a.knee[side] - .25 * lift;
    a.thigh_abduction[side] = .05 + sign * side_step * std::sin(phase_) + .16 * lift;
    a.thigh_twist[side] = .12 * lift;
    a.arm_abduction[side] = std::clamp(.45 + .65 * raise_[side](time_s), -.03, 1.35);
    a.arm_flexion[side] = .45 * reach_[side](time_s) - .30 * std::sin(phase);
    a.arm_twist[side] = .25 * reach_[1 - side](time_s);
    a.elbow[side] = std::clamp(.45 + .50 * bend_[side](time_s), 0.0, 1.3);
    a.pelvis_roll += sign * .5 * .13 * energy * std::sin(phase);
    a.pelvis_yaw += sign * .5 * .26 * energy * std::sin(phase + .9);
  }
  a.pelvis_yaw += .18 * twist_(time_s);
  a.pelvis_pitch = .10 * lean_(time_s) + .25 * crouch;
  a.chest_yaw = -1.3 * a.pelvis_yaw + .25 * twist_(time_s + 3);
  a.chest_roll = -1.1 * a.pelvis_roll + .12 * sway_(time_s);
  a.chest_pitch = -.8 * a.pelvis_pitch + .10 * lean_(time_s + 2);
  a.head_yaw = .30 * look_(time_s);
  a.head_pitch = .12 * look_(time_s + 5);
  return a;
}

Pose MotionGenerator::MakePose(const BodyAngles& a, double ease) const {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  Pose pose = Pose::Rest(skeleton_);
  const auto eased = [ease](const Quaterniond& q) {
    return Quaterniond::Identity().slerp(ease, q);
  };
  pose.rotations[kHips] =
      About(heading_, y) * eased(EulerYxz(a.pelvis_yaw, a.pelvis_pitch, a.pelvis_roll));
  // The trunk's turn is shared by its two bones; the head bone takes the rest.
  const Quaterniond half_trunk =
      eased(EulerYxz(a.chest_yaw / 2, a.chest_pitch / 2, a.chest_roll / 2));
  pose.rotations[kSpine] = half_trunk;
  pose.rotations[kChest] = half_trunk;
  pose.rotations[kHead] = eased(EulerYxz(a.head_yaw, a.head_pitch, 0));
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1 : -1;
    const int leg = side == 0 ? kLeftUpperLeg : kRightUpperLeg;
    pose.rotations[leg + 1] =
        eased(About(sign * a.thigh_abduction[side], z) * About(-a.thigh_flexion[side], x) *
              About(sign * a.thigh_twist[side], y));
    pose.rotations[leg + 2] = eased(About(std::max(0.0, a.knee[side]), x));
    pose.rotations[leg + 3] = eased(About(a.foot_pitch[side], x));
    const int arm = side == 0 ? kLeftUpperArm : kRightUpperArm;
    // The collar bone takes a quarter of a raised arm.
    pose.rotations[arm] = eased(About(sign * .25 * std::max(0.0, a.arm_abduction[side]), z));
    pose.rotations[arm + 1] =
        eased(About(sign * .75 * a.arm_abduction[side], z) * About(-a.arm_flexion[side], x) *
              About(sign * a.arm_twist[side], y));
    pose.rotations[arm + 2] = eased(About(-a.elbow[side], x));
  }
  return pose;
}

double MotionGenerator::TurnRate(double time_s, const Pose& pose) const {
  const bool walk = options_.style == PerformerStyle::kWalk;
  double rate = (walk ? .45 : .55) * turn_(time_s);
  if (!walk) {  // now and then a spin
    const double burst = Smoothstep(.55, 1.0, std::abs(turn_(time_s + 11)));
    rate += 3.0 * burst * (turn_(time_s + 11) > 0 ? 1 : -1);
  }
  // Far from the start the way bends back to it.
  const Vector3d& at = pose.root_position;
  const double distance = std::hypot(at.x(), at.z());
  const double away = std::remainder(std::atan2(-at.x(), -at.z()) - heading_, kTwoPi);
  return rate + (walk ? .9 : .3) * Smoothstep(1.5, 3.5, distance) * std::sin(away);
}

double MotionGenerator::JumpHeight(double time_s) const {
  if (options_.style == PerformerStyle::kWalk) return 0;
  constexpr double kEvery_s = 5.5, kFlight_s = .34, kTop = .055;  // body heights
  const double since = std::fmod(time_s + jump_offset_s_, kEvery_s) - 2;
  if (since <= 0 || since >= kFlight_s) return 0;
  const double u = since / kFlight_s;
  return 4 * kTop * u * (1 - u);
}

// Moves the root so that the lowest foot stands on the floor and, horizontally, stays where it is;
// smoothed, because a body does not jerk when the weight changes feet.
void MotionGenerator::PlaceOnFloor(PoseTrack* track) const {
  constexpr double kSharpness = .006;  // body heights: how clearly one foot is "the lower"
  constexpr double kSmoothing_s = .09, kHeightSmoothing_s = .04;
  constexpr std::array<int, 4> kContacts = {kLeftFoot, kLeftToes, kRightFoot, kRightToes};
  const int num_frames = track->num_frames();
  BoneTransforms bones;
  std::array<Vector3d, 4> previous;
  Eigen::Matrix3Xd path(3, num_frames);
  Vector3d travelled = skeleton_.rest_position(0);
  for (int t = 0; t < num_frames; ++t) {
    Pose& pose = track->poses[t];
    pose.root_position = skeleton_.rest_position(0);
    ComputeBoneTransforms(skeleton_, pose, {}, &bones);
    std::array<double, 4> heights;
    for (int c = 0; c < 4; ++c) {
      heights[c] =
          bones.joint_positions(1, kContacts[c]) - skeleton_.rest_position(kContacts[c]).y();
    }
    const double lowest = *std::min_element(heights.begin(), heights.end());
    double total = 0, height = 0;
    Vector3d slide = Vector3d::Zero();
    for (int c = 0; c < 4; ++c) {
      const Vector3d contact = bones.joint_positions.col(kContacts[c]);
      const double weight = std::exp((lowest - heights[c]) / kSharpness);
      total += weight;
      height += weight * heights[c];
      if (t > 0) slide += weight * (contact - previous[c]);
      previous[c] = contact;
    }
    travelled -= slide / total;
    path.col(t) = Vector3d(travelled.x(), pose.root_position.y() - height / total, travelled.z());
  }
  for (int axis : {0, 2}) SmoothPath(kSmoothing_s * options_.fps, axis, &path);
  SmoothPath(kHeightSmoothing_s * options_.fps, 1, &path);
  for (int t = 0; t < num_frames; ++t) {
    const double time_s = t / options_.fps;
    path(1, t) += JumpHeight(time_s) * Smoothstep(kEaseIn_s, 2 * kEaseIn_s, time_s);
    track->poses[t].root_position = path.col(t) - path.col(0) + skeleton_.rest_position(0);
  }
}

PoseTrack MotionGenerator::Generate() {
  const bool walk = options_.style == PerformerStyle::kWalk;
  const double beat = kTwoPi * (walk ? .88 : .78) * tempo_;  // rad/s
  PoseTrack track;
  track.fps = options_.fps;
  Vector3d strolled = Vector3d::Zero();  // rough path, only to know when to turn back
  // Frames beyond the end, so that smoothing the path treats a short clip as part of a longer one.
  const int num_padded = options_.num_frames + static_cast<int>(std::ceil(options_.fps));
  for (int t = 0; t < num_padded; ++t) {
    const double time_s = t / options_.fps;
    const double ease = Smoothstep(0, kEaseIn_s, time_s);
    track.poses.push_back(MakePose(walk ? Walk(time_s) : Dance(time_s), ease));
    Pose there;
    there.root_position = strolled;
    const double step_s = ease / options_.fps;
    phase_ += step_s * beat * (1 + .12 * tempo_noise_(time_s));
    heading_ += step_s * TurnRate(time_s, there);
    if (walk) strolled += step_s * .7 * Vector3d(std::sin(heading_), 0, std::cos(heading_));
  }
  PlaceOnFloor(&track);
  track.poses.resize(options_.num_frames);
  return track;
}

}  // namespace

PoseTrack GenerateMotion(const Skeleton& skeleton, const MotionOptions& options) {
  return MotionGenerator(skeleton, options).Generate();
}

}  // namespace pleat
