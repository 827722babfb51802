// The way of a pose through a live session. The names in front are the threads.
//
//   caller         Push copies the pose into queue_. When no answer is under way and the queue is
//                  ready, the caller calls Answer, which submits this object to the batcher.
//   pose thread    Prepare takes the next pose out of the queue and makes its query. The batcher
//                  evaluates it together with those of other sessions. Evaluated encodes the frame
//                  and hands the reply to the listener, all on the same thread.
//   any            When the reply is out of the way, the caller calls Answer again. It may do so
//                  from inside OnReply.
//
// Only queue_ is shared between these threads, and mutex_ guards it alone: nothing is computed and
// nobody is called while it is held, so a pose can arrive at any time. Session, turn and reply have
// no lock, because PoseStream allows one answer at a time: the caller knows of OnReply before it
// calls Answer again. On its way from Answer to Prepare the new answer passes through the mutex of
// the batcher, which makes all writes of the last one visible to the new thread.
//
// The pose is taken in Prepare and not in Answer. While the session waits for its turn, a newer
// pose may replace the one that waits (latest_wins), and the time in the queue is measured up to
// here.
//
// A pose that cannot be shown is an answer too: Prepare returns false, and Evaluated replies with
// the status. So does an evaluation or an encoding that runs out of memory. The session goes on.
// The wish for a key frame is passed on before the frame is encoded and survives a failure: the
// encoder remembers it until a frame succeeds.
//
// Memory: the queue, the turn and the pointers are allocated with the stream; the reply grows with
// the first answer and is used again. The listener gets reply_ by reference, may exchange the frame
// in it, and leaves the rest. OnReply may destroy this object, so nothing follows it.
#include "local_pose_stream.h"

#include <new>
#include <utility>

#include "absl/status/status.h"

namespace pleat {

LocalPoseStream::LocalPoseStream(std::unique_ptr<LocalPoseSession> session, const LiveRules& rules,
                                 ProjectQuota* frames, PoseBatcher* batcher, LiveListener* listener)
    : frames_(frames),
      batcher_(batcher),
      listener_(listener),
      session_(std::move(session)),
      queue_(rules, session_->model().options().history,
             session_->model().skeleton().num_joints()) {
  turn_ = queue_.MakeTurn();
  poses_.reserve(turn_.poses.size());
}

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
  // Charged here and not when it comes: a pose that was superseded has cost nothing.
  if (turn_.status.ok() && frames_ != nullptr) turn_.status = frames_->Take(1);
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
  listener_->OnReply(std::move(reply_));  // must stay last: it may destroy this object
}

}  // namespace pleat
