// Smooth synthetic motion of any skeleton.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>
#include <vector>

#include "pleat/base/random.h"
#include "pleat/math/rotations.h"
#include "pleat/skeleton/pose_track.h"

namespace pleat {

// Smooth motion: every joint swings with its own two frequencies, the body walks in a curve.
inline PoseTrack MakeSmoothPoses(const Skeleton& skeleton, int num_frames, uint64_t seed,
                                 double amplitude_rad = 0.4) {
  Random random(seed);
  PoseTrack::Parts track;
  const int num_joints = skeleton.num_joints();
  std::vector<Eigen::Matrix<double, 3, 4>> waves(num_joints);  // amplitude, frequency, phase, rate
  for (auto& wave : waves) {
    for (int i = 0; i < 3; ++i) {
      wave.row(i) << random.Uniform(-1, 1), random.Uniform(0.05, 0.15), random.Uniform(0, 6.28),
          random.Uniform(0.2, 0.3);
    }
  }
  for (int t = 0; t < num_frames; ++t) {
    Pose pose = Pose::Rest(skeleton);
    pose.root_position +=
        Eigen::Vector3d(0.02 * t, 0.03 * std::sin(0.3 * t), 0.5 * std::cos(0.05 * t));
    for (int j = 0; j < num_joints; ++j) {
      Eigen::Vector3d w;
      for (int i = 0; i < 3; ++i) {
        w[i] = amplitude_rad * waves[j](i, 0) *
               (std::sin(waves[j](i, 1) * t + waves[j](i, 2)) + 0.3 * std::sin(waves[j](i, 3) * t));
      }
      if (j == 0) w += Eigen::Vector3d(0, 0.05 * t, 0);
      pose.rotations[j] = QuaternionFromExponentialMap(w);
    }
    track.poses.push_back(std::move(pose));
  }
  return PoseTrack::FromValid(std::move(track));
}

}  // namespace pleat
