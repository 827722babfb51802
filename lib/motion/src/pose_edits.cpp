#include "pose_edits.h"

#include <algorithm>
#include <cmath>

#include "pleat/math/rotations.h"

namespace pleat {
namespace {

// `rotation`, or the part of it that turns by no more than `max_rad`.
Eigen::Quaterniond CutAngle(const Eigen::Quaterniond& rotation, double max_rad) {
  const Eigen::Vector3d turn = ExponentialMapFromQuaternion(rotation);
  const double angle = turn.norm();
  return angle <= max_rad ? rotation : QuaternionFromExponentialMap(max_rad / angle * turn);
}

Eigen::Quaterniond TwistOf(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& axis) {
  const double along = rotation.vec().dot(axis);
  Eigen::Quaterniond twist;
  twist.w() = rotation.w();
  twist.vec() = along * axis;
  // A swing by 180 degrees has any twist.
  return twist.norm() > 1e-9 ? twist.normalized() : Eigen::Quaterniond::Identity();
}

Eigen::Quaterniond MirrorRotation(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& n) {
  Eigen::Quaterniond mirrored;
  mirrored.w() = rotation.w();
  mirrored.vec() = 2 * n * n.dot(rotation.vec()) - rotation.vec();
  return mirrored;
}

}  // namespace

void ScaleRotations(const std::vector<int>& joints, double factor, std::vector<Pose>* poses) {
  for (const int j : joints) {
    Eigen::Vector3d previous = Eigen::Vector3d::Zero();
    for (Pose& pose : *poses) {
      Eigen::Quaterniond& rotation = pose.rotations[static_cast<size_t>(j)];
      previous = UnwrapExponentialMap(ExponentialMapFromQuaternion(rotation), previous);
      rotation = QuaternionFromExponentialMap(factor * previous);
    }
  }
}

void OffsetRotations(const std::vector<int>& joints, const Eigen::Quaterniond& offset,
                     std::vector<Pose>* poses) {
  for (const int j : joints) {
    for (Pose& pose : *poses) {
      Eigen::Quaterniond& rotation = pose.rotations[static_cast<size_t>(j)];
      rotation = (offset * rotation).normalized();
    }
  }
}

void LimitRotations(const Skeleton& skeleton, const std::vector<int>& joints, double max_swing_rad,
                    double max_twist_rad, std::vector<Pose>* poses) {
  for (const int j : joints) {
    const int parent = skeleton.parent(j);
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();
    if (parent >= 0) axis = skeleton.rest_position(j) - skeleton.rest_position(parent);
    axis = axis.norm() > 0 ? axis.normalized().eval() : axis;
    for (Pose& pose : *poses) {
      Eigen::Quaterniond& rotation = pose.rotations[static_cast<size_t>(j)];
      Eigen::Quaterniond twist = Eigen::Quaterniond::Identity();
      if (axis.norm() > 0) twist = TwistOf(rotation, axis);
      const Eigen::Quaterniond swing = rotation * twist.conjugate();
      Eigen::Quaterniond limited = CutAngle(swing, max_swing_rad) * CutAngle(twist, max_twist_rad);
      limited.normalize();
      // What is within its limits keeps its bits.
      if (limited.angularDistance(rotation) < 1e-9) continue;
      if (limited.dot(rotation) < 0) limited.coeffs() *= -1;
      rotation = limited;
    }
  }
}

void SmoothRotations(const std::vector<int>& joints, double seconds, double fps,
                     const std::vector<int>& clip_starts, std::vector<Pose>* poses) {
  const double deviation = seconds * fps / 2;  // frames
  if (!(deviation > 0)) return;
  const auto num_frames = static_cast<int>(poses->size());
  const int reach = static_cast<int>(std::min<double>(std::ceil(3 * deviation), num_frames));
  const std::vector<Pose> before = *poses;
  for (const ClipRange& clip : ClipRanges(clip_starts, num_frames)) {
    for (int t = clip.begin; t < clip.end; ++t) {
      Pose& pose = (*poses)[static_cast<size_t>(t)];
      const int first = std::max(clip.begin, t - reach), last = std::min(clip.end - 1, t + reach);
      for (const int j : joints) {
        const auto joint = static_cast<size_t>(j);
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        double weights = 0;
        for (int s = first; s <= last; ++s) {
          const Pose& other = before[static_cast<size_t>(s)];
          const double weight = std::exp(-.5 * (s - t) * (s - t) / (deviation * deviation));
          const double sign = other.rotations[joint].dot(before[t].rotations[joint]) < 0 ? -1 : 1;
          sum += weight * sign * other.rotations[joint].coeffs();
          place += weight * other.root_position;
          weights += weight;
        }
        if (sum.norm() > 1e-9) pose.rotations[joint].coeffs() = sum.normalized();
        if (j == 0) pose.root_position = place / weights;
      }
    }
  }
}

void MirrorPoses(const BodyAxes& axes, const std::vector<int>& clip_starts,
                 std::vector<Pose>* poses) {
  for (const ClipRange& clip : ClipRanges(clip_starts, static_cast<int>(poses->size()))) {
    const double middle = axes.left.dot((*poses)[static_cast<size_t>(clip.begin)].root_position);
    for (int t = clip.begin; t < clip.end; ++t) {
      Pose& pose = (*poses)[static_cast<size_t>(t)];
      const Pose before = pose;
      pose.root_position -= 2 * (axes.left.dot(before.root_position) - middle) * axes.left;
      for (size_t j = 0; j < pose.rotations.size(); ++j) {
        const auto other = static_cast<size_t>(axes.mirror_joints[j]);
        pose.rotations[j] = MirrorRotation(before.rotations[other], axes.left);
      }
    }
  }
}

}  // namespace pleat
