// The poses of one live session between their arrival and their frame.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <vector>

#include "absl/status/status.h"
#include "pleat/service/pose_service.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

// What one reply answers.
struct LiveTurn {
  uint64_t number = 0;
  absl::Status status{};    // not OK: why the pose cannot be shown
  std::vector<Pose> poses;  // [0] is shown, [h] is h intervals earlier
  bool keyframe = false;    // asked for by this pose or one that it supersedes
  int num_superseded = 0;
  std::chrono::steady_clock::time_point arrived;
};

// Bounded whatever the client does: without latest_wins HasRoom says when to stop reading, with it
// a newer pose takes the place of the one that waits. Not thread-safe.
class LiveQueue {
 public:
  // depth: poses per query, 1 to kMaxPosesPerQuery. Poses without `num_joints` rotations get a
  // status.
  LiveQueue(const LiveRules& rules, int depth, int num_joints)
      : rules_(rules), depth_(depth), num_joints_(num_joints) {}

  bool HasRoom() const;
  void Push(LivePose pose, std::chrono::steady_clock::time_point now);

  // `replies_received` of this session were read by the client; an older number changes nothing.
  // kInvalidArgument when there were not as many.
  absl::Status Acknowledge(uint64_t replies_received);

  bool empty() const { return waiting_.empty(); }
  // A pose waits and its reply may be sent now.
  bool ready() const;
  // The pose to answer next; call when ready. Counts its reply as sent.
  LiveTurn Take();

 private:
  absl::Status Check(const LivePose& pose) const;

  const LiveRules rules_;
  const size_t depth_;
  const size_t num_joints_;
  std::deque<LiveTurn> waiting_;  // at most one with latest_wins
  std::vector<Pose> recent_;      // newest first, at most depth_
  uint64_t num_sent_ = 0, num_acknowledged_ = 0;
};

}  // namespace pleat
