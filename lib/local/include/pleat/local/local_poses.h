// Frames of the models of this process: one pose, a clip, or poses as they happen.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "pleat/base/executor.h"
#include "pleat/local/encoder_pool.h"
#include "pleat/local/local_models.h"
#include "pleat/local/pose_batcher.h"
#include "pleat/local/project_quota.h"
#include "pleat/service/pose_service.h"

namespace pleat {

struct PoseEngineOptions {
  uint64_t encoder_bytes = uint64_t{64} << 20;  // frame encoders that nobody uses at the moment
  MemoryBudget* encoder_memory = nullptr;       // see EncoderPool
  int num_threads = 0;  // threads that answer pose streams; 0 = one per core
  int max_batch = 8;    // poses of one model that are evaluated together; 1 = one by one
};

// What computes frames, for everybody in this process. It must outlive the sessions and streams.
class PoseEngine {
 public:
  explicit PoseEngine(const PoseEngineOptions& options)
      : encoders_(options.encoder_bytes, options.encoder_memory),
        batcher_(&executor_, options.max_batch),
        executor_(options.num_threads) {}

  EncoderPool& encoders() { return encoders_; }
  PoseBatcher& batcher() { return batcher_; }
  Executor& executor() { return executor_; }

 private:
  EncoderPool encoders_;
  // The executor is destroyed first: it runs what still waits, and these tasks use the batcher.
  PoseBatcher batcher_;
  Executor executor_;
};

// Thread-safe. `models` and `engine` must outlive it and the sessions and streams that it opens.
// Clips and single poses are computed on the caller's thread, streams on the engine's.
class LocalPoses final : public PoseService {
 public:
  // max_frames: of one clip. frames: what frames are charged to, which must outlive the streams;
  // null: nothing.
  LocalPoses(LocalModels* models, PoseEngine* engine, int64_t max_frames,
             ProjectQuota* frames = nullptr)
      : models_(models), engine_(engine), max_frames_(max_frames), frames_(frames) {}

  absl::Status EvaluateClip(
      const ClipQuery& query,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) override;
  absl::StatusOr<std::unique_ptr<PoseSession>> OpenSession(const std::string& model_id,
                                                           PoseSessionOptions options) override;
  absl::StatusOr<std::unique_ptr<ClipSession>> OpenClip(const std::string& model_id,
                                                        PoseTrack track,
                                                        PoseSessionOptions options) override;
  absl::StatusOr<std::unique_ptr<PoseStream>> OpenStream(const std::string& model_id,
                                                         PoseSessionOptions options,
                                                         LiveRules rules,
                                                         LiveListener* listener) override;

  // The threads that answer pose streams. A server computes its other poses on them too, so that
  // all take turns and do not compete for the processor.
  Executor* executor() { return &engine_->executor(); }

 private:
  absl::Status CheckClip(const PoseTrack& track) const;
  absl::Status Charge(int64_t num_frames) const {
    return frames_ == nullptr ? absl::OkStatus() : frames_->Take(num_frames);
  }

  LocalModels* const models_;
  PoseEngine* const engine_;
  const int64_t max_frames_;
  ProjectQuota* const frames_;
};

}  // namespace pleat
