// Clips of the small figure with another rest pose: the truth for retargeting.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "formats/figure_character.h"
#include "pleat/formats/joint_clip.h"

namespace pleat {

// The same motion in the world, written by a program in which `rest` is the rest pose.
inline JointClip WithRest(const JointClip& clip, const Skeleton& skeleton, const Pose& rest) {
  PoseTrack::Parts parts{.fps = clip.fps};
  parts.poses = {rest};
  const JointClip still = ClipFromPoses(skeleton, *PoseTrack::Create(std::move(parts)));
  PlacedJoints at_rest, placed;
  PlaceJoints(still, 0, &at_rest);
  JointClip other = clip;
  for (size_t j = 0; j < clip.num_joints(); ++j) {
    const int parent = clip.joints[j].parent;
    other.joints[j].offset = at_rest.positions.col(static_cast<Eigen::Index>(j));
    if (parent >= 0) other.joints[j].offset -= at_rest.positions.col(parent);
  }
  for (size_t t = 0; t < clip.num_frames(); ++t) {
    PlaceJoints(clip, t, &placed);
    std::vector<Eigen::Quaterniond> world;
    for (size_t j = 0; j < clip.num_joints(); ++j) {
      const size_t entry = t * clip.num_joints() + j;
      const int parent = clip.joints[j].parent;
      world.push_back(placed.rotations[j] * at_rest.rotations[j].conjugate());
      other.rotations[entry] =
          parent < 0 ? world[j] : world[static_cast<size_t>(parent)].conjugate() * world[j];
      other.translations[entry] = parent < 0
                                      ? placed.positions.col(static_cast<Eigen::Index>(j)).eval()
                                      : other.joints[j].offset;
    }
  }
  return other;
}

// A pose whose bone points elsewhere than at rest, without a twist, as in a T-pose.
inline void Swing(const Skeleton& skeleton, const char* joint, const Eigen::Vector3d& direction,
                  Pose* pose) {
  const int bone = skeleton.FindJoint(joint);
  const Eigen::Vector3d rest =
      skeleton.rest_position(bone) - skeleton.rest_position(skeleton.parent(bone));
  pose->rotations[static_cast<size_t>(bone)] = Eigen::Quaterniond::FromTwoVectors(rest, direction);
}

}  // namespace pleat
