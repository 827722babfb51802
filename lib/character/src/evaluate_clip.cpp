// All frames of a clip, in batches that read the model once.
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "bone_scales.h"
#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/skeleton/pose_history.h"

namespace pleat {

absl::Status PoseEvaluator::EvaluateClip(
    const PoseTrack& track, const std::vector<double>& bone_scales,
    const std::function<absl::Status(int, const EvaluatedFrame&)>& consume,
    const Progress& progress, std::span<const VertexRows> rows) {
  const int num_joints = model_->skeleton().num_joints();
  PLEAT_RETURN_IF_ERROR(CheckJointCount(track, num_joints));
  PLEAT_RETURN_IF_ERROR(CheckBoneScales(bone_scales, num_joints));
  constexpr int kBatch = 8;
  PoseHistory history(track, model_->frame_rate().fps(), model_->options().history);
  // The poses are copied, because what PoseHistory returns is valid only until the next call.
  std::vector<std::vector<Pose>> poses(kBatch);
  std::vector<std::vector<const Pose*>> pointers(kBatch);
  std::vector<EvaluatedFrame> frames(kBatch);
  std::vector<PoseQuery> queries(kBatch);
  for (int begin = 0; begin < track.num_frames(); begin += kBatch) {
    const int count = std::min(kBatch, track.num_frames() - begin);
    for (int i = 0; i < count; ++i) {
      history.At(begin + i, &pointers[i]);
      poses[i].resize(pointers[i].size());
      for (size_t h = 0; h < poses[i].size(); ++h) {
        poses[i][h] = *pointers[i][h];
        pointers[i][h] = &poses[i][h];
      }
      queries[i] = {
          .poses = &pointers[i], .bone_scales = &bone_scales, .frame = &frames[i], .status = {}};
      if (!rows.empty()) queries[i].rows = rows[static_cast<size_t>(begin + i)];
    }
    EvaluateChecked({queries.data(), static_cast<size_t>(count)});
    for (int i = 0; i < count; ++i) {
      PLEAT_RETURN_IF_ERROR(consume(begin + i, frames[i]));
      PLEAT_RETURN_IF_ERROR(progress.Report((begin + i + 1.0) / track.num_frames()));
    }
  }
  return absl::OkStatus();
}

absl::Status PoseEvaluator::EvaluateSkinnedClip(
    const PoseTrack& track, const std::vector<double>& bone_scales,
    const std::function<absl::Status(int, const EvaluatedFrame&)>& consume,
    const Progress& progress) {
  EvaluatedFrame frame;
  for (int t = 0; t < track.num_frames(); ++t) {
    PLEAT_RETURN_IF_ERROR(WithContext(absl::StrCat("frame ", t),
                                      EvaluateSkinned(track.pose(t), bone_scales, &frame)));
    PLEAT_RETURN_IF_ERROR(consume(t, frame));
    PLEAT_RETURN_IF_ERROR(progress.Report((t + 1.0) / track.num_frames()));
  }
  return absl::OkStatus();
}

}  // namespace pleat
