// The runtime: turns a pose with its history into the full mesh. It takes milliseconds and
// allocates nothing after the first frame (docs/method/prediction.md).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "pleat/base/progress.h"
#include "pleat/character/character_model.h"
#include "pleat/character/detail_strengths.h"
#include "pleat/mesh/vertex_rows.h"
#include "pleat/skeleton/pose_track.h"

namespace pleat {

struct EvaluatedFrame {
  Eigen::Matrix3Xf positions;  // 3 x V, meters, world
  // How near the pose is to what training has seen, from 1 (seen) to 0 (unknown: the mean detail
  // shows).
  double confidence = 0;
};

// What somebody who has the model needs to show a frame: hundreds of bytes in place of a mesh.
struct FrameParameters {
  Pose pose;                     // normalized, with rotations rounded to float32, as they travel
  Eigen::VectorXf coefficients;  // r, of the detail basis; empty: skinned only
  double confidence = 0;
};

class PoseEvaluator;

// One of several queries that are answered together.
struct PoseQuery {
  const std::vector<const Pose*>* poses = nullptr;   // as for PoseEvaluator::Evaluate
  const std::vector<double>* bone_scales = nullptr;  // null: all are 1
  bool skinned_only = false;                         // leaves out the learned detail
  EvaluatedFrame* frame = nullptr;
  // Where the positions go in place of frame->positions, which then stay as they are: V rows.
  VertexRows rows{};
  FrameParameters* parameters = nullptr;  // when given, it is filled in place of the frame
  // The evaluator whose scratch memory the query uses. It must be of the same model, serve no other
  // query of the batch, and not be in use by others. A batch of sessions that have evaluated before
  // then allocates nothing, whichever of them evaluates it. Null: the evaluating one uses memory of
  // its own.
  PoseEvaluator* scratch_of = nullptr;
  absl::Status status{};  // set by the evaluation; when it is not OK, the frame is untouched
};

// One evaluator serves one thread: it owns the scratch memory. The model is shared.
class PoseEvaluator {
 public:
  explicit PoseEvaluator(std::shared_ptr<const CharacterModel> model);
  ~PoseEvaluator();
  PoseEvaluator(PoseEvaluator&&) noexcept;
  PoseEvaluator& operator=(PoseEvaluator&&) noexcept;

  const CharacterModel& model() const;

  // How strong the learned detail is in all that this evaluator shows from now on; queries of a
  // batch follow the evaluator whose scratch memory they use. Empty: as it was learned, with the
  // bits of an evaluator that was never told. Parameters carry no strengths: who shows them has its
  // own. kInvalidArgument as CheckDetailStrengths.
  absl::Status SetDetailStrengths(const DetailStrengths& strengths);

  // poses[0] is the pose to show, poses[h] the pose h training-frame intervals earlier. When there
  // are fewer than the model looks at, the oldest one is repeated. bone_scales: J factors on the
  // lengths of the bones, or empty; they retarget the character to new proportions (Figure 6d of
  // the paper). kInvalidArgument names a wrong joint count, a rotation that is not finite or not of
  // unit length, or a scale outside [0.05, 20].
  absl::Status Evaluate(const std::vector<const Pose*>& poses,
                        const std::vector<double>& bone_scales, EvaluatedFrame* frame);

  // Does the same without the learned detail (skinned only).
  absl::Status EvaluateSkinned(const Pose& pose, const std::vector<double>& bone_scales,
                               EvaluatedFrame* frame);

  // Answers all queries. Together they read the model once, which makes each of them cheaper; every
  // frame has the same bits as alone. Errors go into the queries: one does not stop the others.
  void EvaluateBatch(std::span<PoseQuery> queries);

  // Predict and Show are the two halves of Evaluate, for two machines: the first turns poses into
  // parameters, the second turns parameters into the mesh. Show gives the same bits wherever the
  // library runs. They differ from Evaluate's by the rounding of the rotations, which is less than
  // two micrometers on a person.
  absl::Status Predict(const std::vector<const Pose*>& poses, bool skinned_only,
                       FrameParameters* parameters);
  // kInvalidArgument names what does not fit the model. `frame` is then untouched. rows: as in
  // PoseQuery.
  absl::Status Show(const FrameParameters& parameters, const std::vector<double>& bone_scales,
                    EvaluatedFrame* frame, const VertexRows& rows = {});

  // Evaluates every frame of `track` in order. The history comes from the track itself and is
  // interpolated where its frame rate differs from the model's. `consume` may stop the clip with an
  // error, which is returned; so does a cancelled `progress`. rows: empty, or where the positions
  // of each of the T frames go in place of the frame that `consume` sees.
  absl::Status EvaluateClip(
      const PoseTrack& track, const std::vector<double>& bone_scales,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume,
      const Progress& progress = {}, std::span<const VertexRows> rows = {});
  // Does the same without the learned detail.
  absl::Status EvaluateSkinnedClip(
      const PoseTrack& track, const std::vector<double>& bone_scales,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume,
      const Progress& progress = {});

 private:
  struct Scratch;  // the memory of one query
  // Returns the scratch memory with this number and makes it when it is needed first.
  Scratch* ScratchAt(size_t number);
  // The number of poses that the query looks at: one, or those of the model's history.
  size_t NumPosesOf(const PoseQuery& query) const;
  absl::Status Check(const PoseQuery& query) const;
  // Does the same as EvaluateBatch for queries that were checked. It leaves those alone whose
  // status is not OK.
  void EvaluateChecked(std::span<PoseQuery> queries);
  // Copies the poses and computes the features.
  void Prepare(const PoseQuery& query, Scratch* scratch) const;
  // Computes the coefficients of the queries with details, which must come first.
  void Predict(std::span<Scratch* const> scratches) const;
  // Computes the motions of the bones for history[0], and makes the coefficients ready to expand.
  void Place(const std::vector<double>& bone_scales, Scratch* scratch) const;
  static void TakeParameters(const Scratch& scratch, FrameParameters* parameters);
  // Where the positions of a query go: the caller's rows, or else the frame's own.
  VertexRows RowsFor(const VertexRows& rows, EvaluatedFrame* frame) const;
  // Expands the details and skins all vertices; scratches[i] belongs to positions[i].
  void FillFrames(std::span<Scratch* const> scratches, std::span<const VertexRows> positions);

  std::shared_ptr<const CharacterModel> model_;
  std::vector<std::unique_ptr<Scratch>> scratches_;  // as many as were needed at once so far
  std::vector<const Pose*> one_pose_;                // the list that EvaluateSkinned passes on
  std::vector<float> lane_strengths_;                // LaneStrengths, or empty
};

}  // namespace pleat
