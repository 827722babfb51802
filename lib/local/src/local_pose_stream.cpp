#include "local_pose_stream.h"

#include <new>
#include <utility>

#include "absl/status/status.h"

namespace pleat {

LocalPoseStream::LocalPoseStream(std::unique_ptr<LocalPoseSession> session, const LiveRules& rules,
                                 PoseBatcher* batcher, LiveListener* listener)
    : batcher_(batcher),
      listener_(listener),
      session_(std::move(session)),
      queue_(rules, session_->model().options().history,
             session_->model().skeleton().num_joints()) {}

bool LocalPoseStream::HasRoom() const {
  std::lock_guard lock(mutex_);
  return queue_.HasRoom();
}

void LocalPoseStream::Push(const LivePose& pose) {
  std::lock_guard lock(mutex_);
  queue_.Push(pose, std::chrono::steady_clock::now());
}

absl::Status LocalPoseStream::Acknowledge(uint64_t num_replies) {
  std::lock_guard lock(mutex_);
  return queue_.Acknowledge(num_replies);
}

bool LocalPoseStream::empty() const {
  std::lock_guard lock(mutex_);
  return queue_.empty();
}

bool LocalPoseStream::ready() const {
  std::lock_guard lock(mutex_);
  return queue_.ready();
}

bool LocalPoseStream::Prepare(PoseQuery* query) {
  {
    std::lock_guard lock(mutex_);
    queue_.Take(&turn_);
  }
  start_ = std::chrono::steady_clock::now();
  if (!turn_.status.ok()) return false;
  poses_.clear();
  for (const Pose& pose : turn_.poses) poses_.push_back(&pose);
  *query = session_->QueryOf(&poses_);
  return true;
}

absl::Status LocalPoseStream::Encode(const PoseQuery& query, double evaluate_us) {
  try {
    if (!reply_.frame.ok()) reply_.frame.emplace();
    return session_->Encode(query, evaluate_us, &*reply_.frame);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("the server has not enough memory for this pose");
  }
}

void LocalPoseStream::Evaluated(const PoseQuery* query, double evaluate_us, int num_together) {
  if (turn_.keyframe) session_->RequestKeyframe();
  absl::Status status = query != nullptr ? Encode(*query, evaluate_us) : turn_.status;
  if (!status.ok()) reply_.frame = std::move(status);
  reply_.number = turn_.number;
  reply_.num_superseded = turn_.num_superseded;
  reply_.queue_us = std::chrono::duration<double, std::micro>(start_ - turn_.arrived).count();
  reply_.num_together = num_together;
  listener_->OnReply(std::move(reply_));  // this object may be gone when it returns
}

}  // namespace pleat
