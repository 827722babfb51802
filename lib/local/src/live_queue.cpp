#include "pleat/local/live_queue.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"

namespace pleat {

Pose& PoseList::Grown() {
  if (size_ == poses_.size()) poses_.emplace_back();
  return poses_[size_++];
}

void PoseList::push_front(const Pose& pose, size_t most) {
  if (size_ < most) Grown();
  const auto end = poses_.begin() + static_cast<ptrdiff_t>(size_);
  std::rotate(poses_.begin(), end - 1, end);  // moves poses, which exchanges their memory
  poses_.front() = pose;
}

void PoseList::CopyFrom(const PoseList& other) {
  clear();
  for (const Pose& pose : other) push_back(pose);
}

LiveQueue::LiveQueue(const LiveRules& rules, int depth, int num_joints)
    : rules_(rules), depth_(depth), num_joints_(num_joints) {
  const LiveTurn turn = MakeTurn();
  recent_ = turn.poses;
  recent_.clear();
  waiting_ = RingQueue<LiveTurn>(std::vector<LiveTurn>(
      static_cast<size_t>(rules_.latest_wins ? 1 : rules_.max_in_flight), turn));
}

LiveTurn LiveQueue::MakeTurn() const {
  Pose pose;
  pose.rotations.resize(num_joints_);
  LiveTurn turn;
  for (size_t h = 0; h < depth_; ++h) turn.poses.push_back(pose);
  return turn;
}

bool LiveQueue::HasRoom() const {
  return rules_.latest_wins || static_cast<int>(waiting_.size()) < rules_.max_in_flight;
}

absl::Status LiveQueue::Check(const LivePose& pose) const {
  if (!pose.status.ok()) return pose.status;
  for (size_t h = 0; h <= pose.history.size(); ++h) {
    absl::Status status =
        CheckJointCount(h == 0 ? pose.pose : pose.history[h - 1], static_cast<int>(num_joints_));
    if (status.ok()) continue;
    if (h == 0) return status;
    return absl::InvalidArgumentError(
        absl::StrCat("pose.history[", h - 1, "]: ", absl::string_view(status.message())));
  }
  return absl::OkStatus();
}

void LiveQueue::Push(const LivePose& pose, std::chrono::steady_clock::time_point now) {
  absl::Status status = Check(pose);
  if (status.ok()) {  // a pose that cannot be shown must not become history
    if (pose.restart || !pose.history.empty()) recent_.clear();
    recent_.push_front(pose.pose, depth_);
    for (size_t h = 0; h < pose.history.size() && recent_.size() < depth_; ++h) {
      recent_.push_back(pose.history[h]);
    }
  }
  // A pose that replaces another one takes over its wish for a key frame: the client asked because
  // it cannot decode differences, and that has not changed.
  const bool supersedes = rules_.latest_wins && !waiting_.empty();
  LiveTurn& turn = supersedes ? waiting_.back() : waiting_.PushBack();
  turn.keyframe = pose.keyframe || (supersedes && turn.keyframe);
  turn.num_superseded = supersedes ? turn.num_superseded + 1 : 0;
  turn.number = pose.number;
  turn.status = std::move(status);
  turn.poses.CopyFrom(recent_);
  turn.arrived = now;
}

absl::Status LiveQueue::Acknowledge(uint64_t replies_received) {
  if (replies_received > num_sent_) {
    return absl::InvalidArgumentError(absl::StrCat("frames_received is ", replies_received,
                                                   ", but only ", num_sent_, " were sent"));
  }
  num_acknowledged_ = std::max(num_acknowledged_, replies_received);
  return absl::OkStatus();
}

bool LiveQueue::ready() const {
  if (waiting_.empty()) return false;
  return !rules_.latest_wins ||
         num_sent_ - num_acknowledged_ < static_cast<uint64_t>(rules_.max_in_flight);
}

void LiveQueue::Take(LiveTurn* turn) {
  const LiveTurn& first = waiting_.front();
  turn->number = first.number;
  turn->status = first.status;
  turn->poses.CopyFrom(first.poses);  // copied, not moved, so that the slot keeps its memory
  turn->keyframe = first.keyframe;
  turn->num_superseded = first.num_superseded;
  turn->arrived = first.arrived;
  waiting_.PopFront();
  ++num_sent_;
}

LiveTurn LiveQueue::Take() {
  LiveTurn turn;
  Take(&turn);
  return turn;
}

}  // namespace pleat
