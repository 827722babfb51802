#include "pleat/local/pose_session.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {

namespace {

using Clock = std::chrono::steady_clock;

double MicrosecondsBetween(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double, std::micro>(end - start).count();
}

}  // namespace

absl::StatusOr<std::unique_ptr<LocalPoseSession>> LocalPoseSession::Open(
    std::shared_ptr<const CharacterModel> model, PoseSessionOptions options) {
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<EncoderPool::Lease> encoder,
                         EncoderPool::Make(*model, options.encoder));
  return Open(std::move(model), std::move(options), std::move(encoder));
}

absl::StatusOr<std::unique_ptr<LocalPoseSession>> LocalPoseSession::Open(
    std::shared_ptr<const CharacterModel> model, PoseSessionOptions options,
    std::unique_ptr<EncoderPool::Lease> encoder) {
  // Evaluates the rest pose, so that wrong scales and strengths fail now and not with the first
  // pose.
  PoseEvaluator evaluator(model);
  EvaluatedFrame frame;
  PLEAT_RETURN_IF_ERROR(evaluator.SetDetailStrengths(options.strengths));
  PLEAT_RETURN_IF_ERROR(
      evaluator.EvaluateSkinned(Pose::Rest(model->skeleton()), options.bone_scales, &frame));
  return std::unique_ptr<LocalPoseSession>(
      new LocalPoseSession(std::move(evaluator), std::move(options), std::move(encoder)));
}

LocalPoseSession::LocalPoseSession(PoseEvaluator evaluator, PoseSessionOptions options,
                                   std::unique_ptr<EncoderPool::Lease> encoder)
    : options_(std::move(options)), evaluator_(std::move(evaluator)), encoder_(std::move(encoder)) {
  parameters_header_.content = StreamContent::kParameters;
  parameters_header_.num_vertices = evaluator_.model().num_vertices();
}

absl::StatusOr<EncodedFrame> LocalPoseSession::Show(const std::vector<const Pose*>& poses) {
  const Clock::time_point start = Clock::now();
  PoseQuery query = QueryOf(&poses);
  evaluator_.EvaluateBatch({&query, 1});
  return Encode(query, MicrosecondsBetween(start, Clock::now()));
}

PoseQuery LocalPoseSession::QueryOf(const std::vector<const Pose*>* poses) {
  return {.poses = poses,
          .bone_scales = &options_.bone_scales,
          .skinned_only = options_.skinned_only,
          .frame = &frame_,
          .parameters = encoder_ == nullptr ? &parameters_ : nullptr,
          .scratch_of = &evaluator_};
}

absl::Status LocalPoseSession::Encode(const PoseQuery& query, double evaluate_us,
                                      EncodedFrame* frame) {
  PLEAT_RETURN_IF_ERROR(query.status);
  frame->evaluate_us = evaluate_us;
  if (encoder_ == nullptr) {
    frame->draco.clear();
    frame->parameters = parameters_;
    frame->confidence = parameters_.confidence;
    frame->mark = {};
    frame->encode_us = 0;
    return absl::OkStatus();
  }
  const Clock::time_point start = Clock::now();
  const std::vector<int32_t>& vertices = header().control_vertices;
  if (!vertices.empty()) {  // column by column, because Eigen's indexing would copy the list
    control_.resize(3, static_cast<Eigen::Index>(vertices.size()));
    for (size_t i = 0; i < vertices.size(); ++i) {
      control_.col(static_cast<Eigen::Index>(i)) = frame_.positions.col(vertices[i]);
    }
  }
  PLEAT_RETURN_IF_ERROR(
      (*encoder_)->Encode(vertices.empty() ? frame_.positions : control_, &frame->draco));
  frame->parameters.reset();
  frame->confidence = frame_.confidence;
  frame->mark = (*encoder_)->mark();
  frame->encode_us = MicrosecondsBetween(start, Clock::now());
  return absl::OkStatus();
}

absl::StatusOr<EncodedFrame> LocalPoseSession::Encode(const PoseQuery& query, double evaluate_us) {
  EncodedFrame frame;
  PLEAT_RETURN_IF_ERROR(Encode(query, evaluate_us, &frame));
  return frame;
}

absl::StatusOr<std::unique_ptr<LocalClipSession>> LocalClipSession::Open(
    std::shared_ptr<const CharacterModel> model, PoseTrack track, PoseSessionOptions options) {
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<EncoderPool::Lease> encoder,
                         EncoderPool::Make(*model, options.encoder));
  return Open(std::move(model), std::move(track), std::move(options), std::move(encoder));
}

absl::StatusOr<std::unique_ptr<LocalClipSession>> LocalClipSession::Open(
    std::shared_ptr<const CharacterModel> model, PoseTrack track, PoseSessionOptions options,
    std::unique_ptr<EncoderPool::Lease> encoder) {
  // The history interpolates between poses, so all of them must fit before the first is shown.
  PLEAT_RETURN_IF_ERROR(CheckJointCount(track, model->skeleton().num_joints()));
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<LocalPoseSession> session,
                         LocalPoseSession::Open(model, std::move(options), std::move(encoder)));
  return std::unique_ptr<LocalClipSession>(
      new LocalClipSession(std::move(session), std::move(track), *model));
}

LocalClipSession::LocalClipSession(std::unique_ptr<LocalPoseSession> session, PoseTrack track,
                                   const CharacterModel& model)
    : session_(std::move(session)),
      track_(std::move(track)),
      history_(track_, model.frame_rate().fps(), model.options().history) {}

absl::StatusOr<EncodedFrame> LocalClipSession::Next() {
  const int t = next_++;
  history_.At(t, &poses_);
  absl::StatusOr<EncodedFrame> frame = session_->Show(poses_);
  if (frame.ok()) return frame;
  return absl::Status(frame.status().code(),
                      absl::StrCat("frame ", t, ": ", absl::string_view(frame.status().message())));
}

}  // namespace pleat
