// Poses as they happen, answered by a batcher.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <vector>

#include "pleat/local/live_queue.h"
#include "pleat/local/pose_batcher.h"
#include "pleat/local/pose_session.h"
#include "pleat/service/pose_service.h"

namespace pleat {

// An answer allocates only what LocalPoseSession does, as long as the listener leaves the memory of
// the frames. `batcher` and `listener` must outlive it.
class LocalPoseStream final : public PoseStream, private PoseWork {
 public:
  LocalPoseStream(std::unique_ptr<LocalPoseSession> session, const LiveRules& rules,
                  PoseBatcher* batcher, LiveListener* listener);

  const StreamHeader& header() const override { return session_->header(); }
  bool HasRoom() const override;
  void Push(const LivePose& pose) override;
  absl::Status Acknowledge(uint64_t num_replies) override;
  bool empty() const override;
  bool ready() const override;
  void Answer() override { batcher_->Submit(&session_->model(), this); }

 private:
  bool Prepare(PoseQuery* query) override;
  PoseEvaluator& evaluator() override { return session_->evaluator(); }
  void Evaluated(const PoseQuery* query, double evaluate_us, int num_together) override;

  // Fills reply_.frame.
  absl::Status Encode(const PoseQuery& query, double evaluate_us);

  PoseBatcher* const batcher_;
  LiveListener* const listener_;
  // Used by the one answer that is under way.
  const std::unique_ptr<LocalPoseSession> session_;
  // Members for the sake of their memory.
  LiveTurn turn_;
  std::vector<const Pose*> poses_;  // of turn_
  LiveReply reply_;
  std::chrono::steady_clock::time_point start_;

  mutable std::mutex mutex_;
  LiveQueue queue_;  // guarded by mutex_
};

}  // namespace pleat
