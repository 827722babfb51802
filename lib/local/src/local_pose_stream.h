// A live session in this process: poses as they happen, answered by a batcher.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <vector>

#include "pleat/local/live_queue.h"
#include "pleat/local/pose_batcher.h"
#include "pleat/local/pose_session.h"
#include "pleat/local/project_quota.h"
#include "pleat/service/pose_service.h"

namespace pleat {

// An answer allocates only what LocalPoseSession does, as long as the listener leaves the memory of
// the frames where it is. `batcher` and `listener` must outlive the stream.
class LocalPoseStream final : public PoseStream, private PoseWork {
 public:
  // frames: what each pose that is evaluated is charged to; null: nothing.
  LocalPoseStream(std::unique_ptr<LocalPoseSession> session, const LiveRules& rules,
                  ProjectQuota* frames, PoseBatcher* batcher, LiveListener* listener);

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

  // Fills reply_.frame, or says why it cannot.
  absl::Status Encode(const PoseQuery& query, double evaluate_us);

  ProjectQuota* const frames_;
  PoseBatcher* const batcher_;
  LiveListener* const listener_;
  // Everything up to start_ belongs to the one answer that is under way and needs no lock. Apart
  // from the session, these are members in order to keep their memory from answer to answer.
  const std::unique_ptr<LocalPoseSession> session_;
  LiveTurn turn_;
  std::vector<const Pose*> poses_;  // the poses of turn_
  LiveReply reply_;
  std::chrono::steady_clock::time_point start_;  // when turn_ was taken

  mutable std::mutex mutex_;
  LiveQueue queue_;  // guarded by mutex_
};

}  // namespace pleat
