// Runtime: pose (with history) -> full mesh. Milliseconds, no allocation after the first frame.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "pleat/base/progress.h"
#include "pleat/character/character_model.h"
#include "pleat/skeleton/pose_track.h"

namespace pleat {

struct EvaluatedFrame {
  Eigen::Matrix3Xf positions;  // 3 x V, meters, world
  // How near the pose is to what training has seen: 1 = seen, 0 = unknown, the mean detail shows.
  double confidence = 0;
};

// What shows a frame to somebody who has the model: hundreds of bytes in place of a mesh.
struct FrameParameters {
  Pose pose;                     // normalized; rotations are float32 numbers, as they travel
  Eigen::VectorXf coefficients;  // of the detail basis, or none: skinned only
  double confidence = 0;
};

class PoseEvaluator;

// One of several queries that are answered together.
struct PoseQuery {
  const std::vector<const Pose*>* poses = nullptr;   // as for PoseEvaluator::Evaluate
  const std::vector<double>* bone_scales = nullptr;  // null: ones
  bool skinned_only = false;                         // without the learned detail
  EvaluatedFrame* frame = nullptr;
  FrameParameters* parameters = nullptr;  // where given: these are filled in place of the frame
  // Whose scratch memory the query uses, of the same model and in no other query of the batch: a
  // batch of sessions that have evaluated before then allocates nothing, whoever evaluates it.
  // Null: memory that the evaluating one keeps.
  PoseEvaluator* scratch_of = nullptr;
  absl::Status status{};  // set by the evaluation; when it is not OK the frame is untouched
};

// One evaluator per thread: it owns the scratch memory, the model is shared.
class PoseEvaluator {
 public:
  explicit PoseEvaluator(std::shared_ptr<const CharacterModel> model);
  ~PoseEvaluator();
  PoseEvaluator(PoseEvaluator&&) noexcept;
  PoseEvaluator& operator=(PoseEvaluator&&) noexcept;

  const CharacterModel& model() const;

  // poses[0] is the pose to show, poses[h] the pose h training-frame intervals earlier; missing
  // history repeats the oldest pose given. bone_scales: J factors on the bone lengths or empty
  // (retargeting: new proportions, the paper's Figure 6d). kInvalidArgument names a wrong joint
  // count, a rotation that is not finite or not of unit length, or a scale outside [0.05, 20].
  absl::Status Evaluate(const std::vector<const Pose*>& poses,
                        const std::vector<double>& bone_scales, EvaluatedFrame* frame);

  // The same without the learned detail (skinned only).
  absl::Status EvaluateSkinned(const Pose& pose, const std::vector<double>& bone_scales,
                               EvaluatedFrame* frame);

  // Queries together read the model once: cheaper per query, the same bits in every frame.
  void EvaluateBatch(std::span<PoseQuery> queries);

  // Evaluate in two halves, for two machines: what the poses give, then the mesh. `Show` gives the
  // same bits wherever the library runs; they differ from Evaluate's by the rounding of the
  // rotations, under two micrometers on a person.
  absl::Status Predict(const std::vector<const Pose*>& poses, bool skinned_only,
                       FrameParameters* parameters);
  // kInvalidArgument names what does not fit the model.
  absl::Status Show(const FrameParameters& parameters, const std::vector<double>& bone_scales,
                    EvaluatedFrame* frame);

  // Every frame of `track` in order, history taken from the track itself (interpolated
  // where its frame rate differs from the model's). `consume` may stop the clip with an error.
  absl::Status EvaluateClip(
      const PoseTrack& track, const std::vector<double>& bone_scales,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume,
      const Progress& progress = {});
  // The same without the learned detail.
  absl::Status EvaluateSkinnedClip(
      const PoseTrack& track, const std::vector<double>& bone_scales,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume,
      const Progress& progress = {});

 private:
  struct Scratch;  // of one query
  // The one with this number, made when it is needed first.
  Scratch* ScratchAt(size_t number);
  size_t NumPosesOf(const PoseQuery& query) const;  // that are looked at, with their history
  absl::Status Check(const PoseQuery& query) const;
  // EvaluateBatch of queries that are checked already; those with a status that is not OK are left.
  void EvaluateChecked(std::span<PoseQuery> queries);
  // Computes what is predicted from.
  void Prepare(const PoseQuery& query, Scratch* scratch) const;
  // The coefficients of those with details, which come first.
  void Predict(std::span<Scratch* const> scratches) const;
  // The motions of the bones in history[0] and the expansion of the coefficients.
  void Place(const std::vector<double>& bone_scales, Scratch* scratch) const;
  static void TakeParameters(const Scratch& scratch, FrameParameters* parameters);
  void FillFrames(std::span<Scratch* const> scratches, std::span<EvaluatedFrame* const> frames);

  std::shared_ptr<const CharacterModel> model_;
  std::vector<std::unique_ptr<Scratch>> scratches_;  // as many as were needed at once so far
  std::vector<const Pose*> one_pose_;                // of EvaluateSkinned
};

}  // namespace pleat
