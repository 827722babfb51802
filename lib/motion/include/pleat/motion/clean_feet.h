// Feet that stand still while they stand (docs/method/motion.md#feet).
#pragma once

#include <array>

#include "absl/status/statusor.h"
#include "pleat/motion/foot_contacts.h"
#include "pleat/motion/leg_joints.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

struct CleanFeetOptions {
  double blend_seconds = .15;  // over which a foot comes to where it stands, and leaves
  double max_lowering = .05;   // of the root, in leg lengths, where a foot is out of reach
  double max_height_m = .1;    // a foot that stands further from the floor stands on something
};

struct CleanFeetSummary {
  FootSliding before{}, after{};
  double max_move_m = 0;         // of an ankle
  double max_lowering_m = 0;     // of the root
  int num_unreached_frames = 0;  // in which a leg is too short for where its foot should stand
};

// Holds the ball or the heel of each foot where it stands, and puts no foot below the floor. Legs
// follow by two-bone inverse kinematics and feet keep their rotations. Clips of the track are
// cleaned one by one. contacts: left and right, T entries each (asserted), such as those of the
// clip that was retargeted, or DetectContacts of the track itself.
absl::StatusOr<PoseTrack> CleanFeet(const Skeleton& skeleton, const PoseTrack& track,
                                    const std::array<FootContacts, 2>& contacts,
                                    const CleanFeetOptions& options, CleanFeetSummary* summary);

// The contacts of the feet of a track, as DetectContacts finds them in each of its clips.
std::array<FootContacts, 2> TrackContacts(const Skeleton& skeleton, const LegJoints& legs,
                                          const PoseTrack& track);

// By how much feet that stand are higher than at rest: the median over the contacts, or without any
// the lowest that a foot ever is.
double HeightOfFeet(const LegJoints& legs, const Skeleton& skeleton,
                    const std::array<FootPath, 2>& paths,
                    const std::array<FootContacts, 2>& contacts);

}  // namespace pleat
