#include "pleat/local/live_queue.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"

namespace pleat {

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

void LiveQueue::Push(LivePose pose, std::chrono::steady_clock::time_point now) {
  absl::Status status = Check(pose);
  if (status.ok()) {  // others must not become history
    if (pose.restart || !pose.history.empty()) recent_.clear();
    recent_.insert(recent_.begin(), std::move(pose.pose));
    for (Pose& earlier : pose.history) recent_.push_back(std::move(earlier));
    if (recent_.size() > depth_) recent_.resize(depth_);
  }
  LiveTurn turn{.number = pose.number,
                .status = std::move(status),
                .poses = recent_,
                .keyframe = pose.keyframe,
                .num_superseded = 0,
                .arrived = now};
  if (rules_.latest_wins && !waiting_.empty()) {
    turn.keyframe |= waiting_.back().keyframe;
    turn.num_superseded = waiting_.back().num_superseded + 1;
    waiting_.pop_back();
  }
  waiting_.push_back(std::move(turn));
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

LiveTurn LiveQueue::Take() {
  LiveTurn turn = std::move(waiting_.front());
  waiting_.pop_front();
  ++num_sent_;
  return turn;
}

}  // namespace pleat
