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

void LocalPoseStream::Push(LivePose pose) {
  std::lock_guard lock(mutex_);
  queue_.Push(std::move(pose), std::chrono::steady_clock::now());
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
    turn_ = queue_.Take();
  }
  start_ = std::chrono::steady_clock::now();
  if (!turn_.status.ok()) return false;
  poses_.clear();
  for (const Pose& pose : turn_.poses) poses_.push_back(&pose);
  *query = session_->QueryOf(&poses_);
  return true;
}

void LocalPoseStream::Evaluated(const PoseQuery* query, double evaluate_us, int num_together) {
  LiveReply reply{
      .number = turn_.number,
      .num_superseded = turn_.num_superseded,
      .queue_us = std::chrono::duration<double, std::micro>(start_ - turn_.arrived).count(),
      .num_together = num_together};
  if (turn_.keyframe) session_->RequestKeyframe();
  if (query == nullptr) {
    reply.frame = turn_.status;
  } else {
    try {
      reply.frame = session_->Encode(*query, evaluate_us);
    } catch (const std::bad_alloc&) {
      reply.frame = absl::ResourceExhaustedError("the server has not enough memory for this pose");
    }
  }
  listener_->OnReply(std::move(reply));  // this object may be gone when it returns
}

}  // namespace pleat
