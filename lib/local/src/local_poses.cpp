#include "pleat/local/local_poses.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "local_pose_stream.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/status.h"
#include "pleat/local/pose_session.h"

namespace pleat {

absl::Status LocalPoses::CheckClip(const PoseTrack& track) const {
  if (track.num_frames() <= max_frames_) return absl::OkStatus();
  return RefuseForLimit({.limit = "--max-frames"},
                        absl::StrCat("the clip has ", track.num_frames(),
                                     " frames, the limit (--max-frames) is ", max_frames_));
}

absl::Status LocalPoses::EvaluateClip(
    const ClipQuery& query,
    const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) {
  PLEAT_RETURN_IF_ERROR(CheckClip(query.track));
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model,
                         models_->Acquire(query.model_id));
  PoseEvaluator evaluator(std::move(model));
  PLEAT_RETURN_IF_ERROR(evaluator.SetDetailStrengths(query.strengths));
  return query.skinned_only ? evaluator.EvaluateSkinnedClip(query.track, query.bone_scales, consume)
                            : evaluator.EvaluateClip(query.track, query.bone_scales, consume);
}

absl::StatusOr<std::unique_ptr<PoseSession>> LocalPoses::OpenSession(const std::string& model_id,
                                                                     PoseSessionOptions options) {
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, models_->Acquire(model_id));
  PLEAT_RETURN_IF_ERROR(Charge(1));
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<EncoderPool::Lease> encoder,
                         engine_->encoders().Take(model_id, *model, options.encoder));
  return LocalPoseSession::Open(std::move(model), std::move(options), std::move(encoder));
}

absl::StatusOr<std::unique_ptr<ClipSession>> LocalPoses::OpenClip(const std::string& model_id,
                                                                  PoseTrack track,
                                                                  PoseSessionOptions options) {
  PLEAT_RETURN_IF_ERROR(CheckClip(track));
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, models_->Acquire(model_id));
  PLEAT_RETURN_IF_ERROR(Charge(track.num_frames()));
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<EncoderPool::Lease> encoder,
                         engine_->encoders().Take(model_id, *model, options.encoder));
  return LocalClipSession::Open(std::move(model), std::move(track), std::move(options),
                                std::move(encoder));
}

absl::StatusOr<std::unique_ptr<PoseStream>> LocalPoses::OpenStream(const std::string& model_id,
                                                                   PoseSessionOptions options,
                                                                   LiveRules rules,
                                                                   LiveListener* listener) {
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, models_->Acquire(model_id));
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<EncoderPool::Lease> encoder,
                         engine_->encoders().Take(model_id, *model, options.encoder));
  PLEAT_ASSIGN_OR_RETURN(
      std::unique_ptr<LocalPoseSession> session,
      LocalPoseSession::Open(std::move(model), std::move(options), std::move(encoder)));
  return std::make_unique<LocalPoseStream>(std::move(session), rules, frames_, &engine_->batcher(),
                                           listener);
}

}  // namespace pleat
