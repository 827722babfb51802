// The last poses of a motion that is still going on, at any frame rate: a game, a hand on a joint.
#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/status.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

// Remembers poses with their times and gives the history of the newest one at the intervals that a
// model was trained with, so that velocities mean the same at any frame rate, a varying one
// included (docs/method/fit.md#history). PoseHistory does this for tracks, which know the future;
// here a pose that is older than the first one is the first one. Serves one thread and allocates
// nothing after it was made.
class RecentMotion {
 public:
  // interval_seconds: the time between the frames of the model's training, above 0. depth: the
  // number of poses in a history with the newest one, at least 1.
  RecentMotion(int num_joints, double interval_seconds, int depth);

  // Adds the newest pose, which must be valid for the skeleton (CheckPose, CheckJointCount). The
  // seconds count from anywhere. kInvalidArgument when they are not finite or not above those of
  // the pose before; the motion is then unchanged.
  absl::Status Add(double seconds, const Pose& pose);

  // Forgets all poses, as after a cut or a teleport.
  void Restart() { count_ = 0; }

  bool empty() const { return count_ == 0; }

  // Sets poses[0] to the newest pose and poses[h] to the pose h intervals earlier. The pointers are
  // valid until the next call of a member that is not const. There must be a pose (asserted).
  void History(std::vector<const Pose*>* poses);

 private:
  struct Entry {
    double seconds = 0;
    Pose pose;
  };
  // The entry that is `age` entries older than the newest one, whose age is 0.
  const Entry& Past(size_t age) const {
    return entries_[(newest_ + entries_.size() - age) % entries_.size()];
  }
  // Returns the pose at `seconds`, interpolated into *between where it is none of the entries.
  const Pose* At(double seconds, Pose* between) const;

  double interval_seconds_;
  std::vector<Entry> entries_;  // a ring
  size_t newest_ = 0, count_ = 0;
  std::vector<Pose> between_;  // depth: the poses that lie between entries
};

}  // namespace pleat
