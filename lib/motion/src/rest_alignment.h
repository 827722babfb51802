// What turns each bone of a character from its rest into the rest of another skeleton
// (docs/method/motion.md#rest-poses).
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "pleat/formats/joint_clip.h"
#include "pleat/motion/default_joint_map.h"
#include "pleat/motion/foot_contacts.h"
#include "pleat/motion/landmarks.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// The shortest rotation that turns the direction `from` into `to`; the identity when one of them is
// zero.
Eigen::Matrix3d ShortestTurn(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

struct AlignmentInputs {
  const JointClip& clip;  // with Y up
  const Skeleton& skeleton;
  const std::vector<ResolvedBone>& bones;
  Landmarks target;                             // of the skeleton
  const std::array<FootContacts, 2>& contacts;  // of the clip
};

struct RestAlignment {
  // For each of the bones: the world rotation of bone b is that of the joint that it turns with,
  // times this.
  std::vector<Eigen::Matrix3d> turns;
  bool stands = true;  // the rest of the clip is that of a standing body
  std::vector<std::string> warnings;
};
RestAlignment AlignRests(const AlignmentInputs& inputs);

}  // namespace pleat
