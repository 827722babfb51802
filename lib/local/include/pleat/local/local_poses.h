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
#include "pleat/service/pose_service.h"

namespace pleat {

struct LocalPosesOptions {
  int64_t max_frames = 0;                       // the largest number of frames in a clip
  uint64_t encoder_bytes = uint64_t{64} << 20;  // frame encoders that nobody uses at the moment
  int num_threads = 0;  // threads that answer pose streams; 0 = one per core
  int max_batch = 8;    // poses of one model that are evaluated together; 1 = one by one
};

// Thread-safe. `models` must outlive it, and it must outlive the sessions and streams that it
// opens. Clips and single poses are computed on the caller's thread, streams on the executor's.
class LocalPoses final : public PoseService {
 public:
  LocalPoses(LocalModels* models, const LocalPosesOptions& options)
      : models_(models),
        max_frames_(options.max_frames),
        encoders_(options.encoder_bytes),
        batcher_(&executor_, options.max_batch),
        executor_(options.num_threads) {}

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
  Executor* executor() { return &executor_; }
  const EncoderPool& encoders() const { return encoders_; }

 private:
  absl::Status CheckClip(const PoseTrack& track) const;

  LocalModels* const models_;
  const int64_t max_frames_;
  EncoderPool encoders_;
  // The executor is destroyed first: it runs what still waits, and these tasks use the batcher.
  PoseBatcher batcher_;
  Executor executor_;
};

}  // namespace pleat
