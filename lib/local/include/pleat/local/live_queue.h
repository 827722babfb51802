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

// A list of poses that keeps the memory of poses it no longer holds, for those that come later.
class PoseList {
 public:
  size_t size() const { return size_; }
  const Pose* begin() const { return poses_.data(); }
  const Pose* end() const { return begin() + size_; }

  void clear() { size_ = 0; }
  void push_back(const Pose& pose) { Grown() = pose; }
  // Drops the last pose when there would be more than `most`.
  void push_front(const Pose& pose, size_t most);
  void CopyFrom(const PoseList& other);

 private:
  Pose& Grown();  // adds a last pose, which holds old values, and returns it

  std::vector<Pose> poses_;  // the list is the first size_ of them; the rest is memory
  size_t size_ = 0;
};

// What one reply answers.
struct LiveTurn {
  uint64_t number = 0;     // the number that the client gave to the pose
  absl::Status status{};   // not OK: why the pose cannot be shown
  PoseList poses;          // [0] is shown, [h] is h training-frame intervals earlier
  bool keyframe = false;   // asked for by this pose or by one that it supersedes
  int num_superseded = 0;  // poses that it replaced and that get no reply
  std::chrono::steady_clock::time_point arrived;
};

// The queue is bounded whatever the client does. Without latest_wins, HasRoom says when the caller
// must stop reading. With latest_wins, a newer pose takes the place of the one that waits, and what
// is bounded is the number of replies that the client has not acknowledged. All memory for poses is
// allocated when the queue is made. Not thread-safe.
//
// The history of a pose is what was pushed before it, whether it was answered or superseded, so
// that speeds stay right when a client sends more poses than are shown. Poses that cannot be shown
// do not become history.
class LiveQueue {
 public:
  // depth: the poses of a query with its history, 1 to kMaxPosesPerQuery. A pose, or a pose of its
  // history, that does not have `num_joints` rotations gets a status that says so.
  LiveQueue(const LiveRules& rules, int depth, int num_joints);

  bool HasRoom() const;
  // Call it when HasRoom(). `pose` is copied; `now` is when it arrived.
  void Push(const LivePose& pose, std::chrono::steady_clock::time_point now);

  // Notes that the client has read the first `replies_received` replies of this session. A number
  // smaller than an earlier one changes nothing. kInvalidArgument when fewer replies were sent.
  absl::Status Acknowledge(uint64_t replies_received);

  bool empty() const { return waiting_.empty(); }
  // Says whether a pose waits and its reply may be sent now.
  bool ready() const;
  // Returns a turn with memory for the longest history, for Take to fill again and again.
  LiveTurn MakeTurn() const;
  // Takes out the pose to answer next and counts its reply as sent. Call it when a pose waits.
  // `turn` is overwritten and keeps its memory.
  void Take(LiveTurn* turn);
  LiveTurn Take();

 private:
  absl::Status Check(const LivePose& pose) const;

  const LiveRules rules_;
  const size_t depth_;
  const size_t num_joints_;
  RingQueue<LiveTurn> waiting_;  // at most one with latest_wins
  PoseList recent_;              // what becomes history: newest first, at most depth_
  // Counts of replies. Only latest_wins looks at their difference, the replies in flight.
  uint64_t num_sent_ = 0, num_acknowledged_ = 0;
};

}  // namespace pleat
