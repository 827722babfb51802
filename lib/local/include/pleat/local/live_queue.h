// The poses of one live session between their arrival and their frame.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "pleat/base/ring_queue.h"
#include "pleat/service/pose_service.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

// Poses whose memory is used again when their number changes.
class PoseList {
 public:
  size_t size() const { return size_; }
  const Pose* begin() const { return poses_.data(); }
  const Pose* end() const { return begin() + size_; }

  void clear() { size_ = 0; }
  void push_back(const Pose& pose) { Grown() = pose; }
  // The last one goes when there are more than `most`.
  void push_front(const Pose& pose, size_t most);
  void CopyFrom(const PoseList& other);

 private:
  Pose& Grown();  // the new last one

  std::vector<Pose> poses_;  // the first size_ count
  size_t size_ = 0;
};

// What one reply answers.
struct LiveTurn {
  uint64_t number = 0;
  absl::Status status{};  // not OK: why the pose cannot be shown
  PoseList poses;         // [0] is shown, [h] is h intervals earlier
  bool keyframe = false;  // asked for by this pose or one that it supersedes
  int num_superseded = 0;
  std::chrono::steady_clock::time_point arrived;
};

// Bounded whatever the client does: without latest_wins HasRoom says when to stop reading, with it
// a newer pose takes the place of the one that waits. All memory is allocated when the queue is
// made. Not thread-safe.
class LiveQueue {
 public:
  // depth: poses per query, 1 to kMaxPosesPerQuery. Poses without `num_joints` rotations get a
  // status.
  LiveQueue(const LiveRules& rules, int depth, int num_joints);

  bool HasRoom() const;
  // Copies what it needs.
  void Push(const LivePose& pose, std::chrono::steady_clock::time_point now);

  // `replies_received` of this session were read by the client; an older number changes nothing.
  // kInvalidArgument when there were not as many.
  absl::Status Acknowledge(uint64_t replies_received);

  bool empty() const { return waiting_.empty(); }
  // A pose waits and its reply may be sent now.
  bool ready() const;
  // The pose to answer next; call when ready. Counts its reply as sent.
  // `turn` keeps its memory.
  void Take(LiveTurn* turn);
  LiveTurn Take();

 private:
  absl::Status Check(const LivePose& pose) const;

  const LiveRules rules_;
  const size_t depth_;
  const size_t num_joints_;
  RingQueue<LiveTurn> waiting_;  // at most one with latest_wins
  PoseList recent_;              // newest first, at most depth_
  uint64_t num_sent_ = 0, num_acknowledged_ = 0;
};

}  // namespace pleat
