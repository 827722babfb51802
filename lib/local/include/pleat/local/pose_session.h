// One stream of frames: poses of one character -> Draco bytes, without gRPC.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/local/encoder_pool.h"
#include "pleat/service/pose_service.h"
#include "pleat/skeleton/pose_history.h"

namespace pleat {

// Keeps the model in use as long as it lives. Not for two threads at once.
class LocalPoseSession final : public PoseSession {
 public:
  static absl::StatusOr<std::unique_ptr<LocalPoseSession>> Open(
      std::shared_ptr<const CharacterModel> model, PoseSessionOptions options);
  // The same with an encoder of `model` and options.encoder that is there already (EncoderPool).
  static absl::StatusOr<std::unique_ptr<LocalPoseSession>> Open(
      std::shared_ptr<const CharacterModel> model, PoseSessionOptions options,
      std::unique_ptr<EncoderPool::Lease> encoder);

  const CharacterModel& model() const { return evaluator_.model(); }
  const StreamHeader& header() const override {
    return encoder_ == nullptr ? parameters_header_ : (*encoder_)->header();
  }

  absl::StatusOr<EncodedFrame> Show(const std::vector<const Pose*>& poses) override;

  // The two halves of Show, for those who evaluate several sessions' poses together: the query of
  // `poses`, which must live until it is evaluated by any evaluator of the model; and the frame.
  PoseQuery QueryOf(const std::vector<const Pose*>* poses);
  PoseEvaluator& evaluator() { return evaluator_; }
  // evaluate_us: what the evaluation took. `frame` keeps its memory: with the same one again and
  // again a frame allocates only what FrameEncoder does. After an error it holds nothing useful.
  absl::Status Encode(const PoseQuery& query, double evaluate_us, EncodedFrame* frame);
  // The same as a new frame.
  absl::StatusOr<EncodedFrame> Encode(const PoseQuery& query, double evaluate_us);

  // The next frame of a kDracoDelta session will be a key frame.
  void RequestKeyframe() {
    if (encoder_ != nullptr) (*encoder_)->RequestKeyframe();
  }

 private:
  LocalPoseSession(PoseEvaluator evaluator, PoseSessionOptions options,
                   std::unique_ptr<EncoderPool::Lease> encoder);

  PoseSessionOptions options_;
  PoseEvaluator evaluator_;
  std::unique_ptr<EncoderPool::Lease> encoder_;  // null in a stream of parameters
  StreamHeader parameters_header_;
  EvaluatedFrame frame_;
  FrameParameters parameters_;
  Eigen::Matrix3Xf control_;  // 3 x V of the control mesh, in a stream of it
};

// The frames of one clip.
class LocalClipSession final : public ClipSession {
 public:
  // kInvalidArgument names the first pose that does not fit the skeleton.
  static absl::StatusOr<std::unique_ptr<LocalClipSession>> Open(
      std::shared_ptr<const CharacterModel> model, PoseTrack track, PoseSessionOptions options);
  // The same with an encoder of `model` and options.encoder that is there already.
  static absl::StatusOr<std::unique_ptr<LocalClipSession>> Open(
      std::shared_ptr<const CharacterModel> model, PoseTrack track, PoseSessionOptions options,
      std::unique_ptr<EncoderPool::Lease> encoder);

  const StreamHeader& header() const override { return session_->header(); }
  bool done() const override { return next_ >= track_.num_frames(); }
  int next_frame() const override { return next_; }
  absl::StatusOr<EncodedFrame> Next() override;

 private:
  LocalClipSession(std::unique_ptr<LocalPoseSession> session, PoseTrack track,
                   const CharacterModel& model);

  std::unique_ptr<LocalPoseSession> session_;
  const PoseTrack track_;
  PoseHistory history_;  // of track_
  std::vector<const Pose*> poses_;
  int next_ = 0;
};

}  // namespace pleat
