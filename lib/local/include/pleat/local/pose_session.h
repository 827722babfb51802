// One stream of frames: turns poses of one character into encoded frames, without gRPC.
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

// Single poses of one character. A session keeps the model in memory as long as it lives and serves
// one thread at a time: it owns an evaluator, an encoder and the frame between the two.
class LocalPoseSession final : public PoseSession {
 public:
  // kInvalidArgument names a wrong bone scale or option of the encoder.
  static absl::StatusOr<std::unique_ptr<LocalPoseSession>> Open(
      std::shared_ptr<const CharacterModel> model, PoseSessionOptions options);
  // Does the same with an encoder of an EncoderPool, which must have been taken for `model` and
  // options.encoder. It is null in a stream of parameters.
  static absl::StatusOr<std::unique_ptr<LocalPoseSession>> Open(
      std::shared_ptr<const CharacterModel> model, PoseSessionOptions options,
      std::unique_ptr<EncoderPool::Lease> encoder);

  const CharacterModel& model() const { return evaluator_.model(); }
  const StreamHeader& header() const override {
    return encoder_ == nullptr ? parameters_header_ : (*encoder_)->header();
  }

  absl::StatusOr<EncodedFrame> Show(const std::vector<const Pose*>& poses) override;

  // QueryOf and Encode are the two halves of Show, for callers that evaluate the poses of several
  // sessions together. QueryOf returns the query that shows `poses`, which must live until any
  // evaluator of the model has evaluated it. The result lands in this session, so there is one
  // query at a time, and Encode must follow before the next.
  PoseQuery QueryOf(const std::vector<const Pose*>* poses);
  PoseEvaluator& evaluator() { return evaluator_; }
  // evaluate_us: how long the evaluation took, in microseconds. `frame` is overwritten and keeps
  // its memory: when the caller passes the same one again and again, only FrameEncoder allocates.
  // After an error, that of the query or of the encoder, `frame` holds nothing useful.
  absl::Status Encode(const PoseQuery& query, double evaluate_us, EncodedFrame* frame);
  // Does the same and returns a new frame.
  absl::StatusOr<EncodedFrame> Encode(const PoseQuery& query, double evaluate_us);

  // Makes the next frame of a kDracoDelta session a key frame.
  void RequestKeyframe() {
    if (encoder_ != nullptr) (*encoder_)->RequestKeyframe();
  }

 private:
  LocalPoseSession(PoseEvaluator evaluator, PoseSessionOptions options,
                   std::unique_ptr<EncoderPool::Lease> encoder);

  PoseSessionOptions options_;
  PoseEvaluator evaluator_;
  std::unique_ptr<EncoderPool::Lease> encoder_;  // null in a stream of parameters
  StreamHeader parameters_header_;               // the header of such a stream
  EvaluatedFrame frame_;                         // where a query puts the mesh
  FrameParameters parameters_;                   // where it puts parameters
  Eigen::Matrix3Xf control_;                     // 3 x V of the control mesh, meters, or empty
};

// The frames of one clip, in order. Serves one thread at a time.
class LocalClipSession final : public ClipSession {
 public:
  // kInvalidArgument names the first pose that does not fit the skeleton.
  static absl::StatusOr<std::unique_ptr<LocalClipSession>> Open(
      std::shared_ptr<const CharacterModel> model, PoseTrack track, PoseSessionOptions options);
  // Does the same with an encoder of an EncoderPool, as for LocalPoseSession.
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
  PoseHistory history_;  // refers to track_
  std::vector<const Pose*> poses_;
  int next_ = 0;
};

}  // namespace pleat
