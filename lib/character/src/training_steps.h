// The steps that training and evaluation share; steps 3 to 7 of the data's way (ARCHITECTURE.md).
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/character/character_model.h"
#include "pleat/character/train_character.h"
#include "pleat/fitting/pose_fit.h"
#include "pleat/geometry/differential_coordinates.h"
#include "pleat/math/pca.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/rigging/auto_rig.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/user_rig.h"

namespace pleat {

// Frames of one or more recordings, one after the other.
struct TrainingFrames {
  MeshSequence sequence;
  std::vector<int> clip_starts;  // ascending, first is 0; no history or dynamics across a start
  int num_rig_frames;            // the rest frame is one of the first so many (the first clip)
  std::vector<int>
      frame_numbers;  // of every frame in its recording; gaps where frames are held out
};

// Joins clips of the same connectivity. kInvalidArgument names the clip that does not fit.
absl::StatusOr<TrainingFrames> JoinClips(const std::vector<MeshSequence>& clips);

struct RiggedFrames {
  TrainingFrames frames;
  Rig rig;
  AutoRigSummary rig_summary;
  std::vector<int> locked_joints;  // against refinement
};
// The user's rig; weights by heat where it has none.
absl::StatusOr<RiggedFrames> TakeUserRig(const TrainingFrames& frames, const UserRig& rig,
                                         const TrainResources& resources, const Progress& progress);
absl::StatusOr<RiggedFrames> RigFrames(const TrainingFrames& frames, const TrainOptions& options,
                                       const TrainResources& resources, const Progress& progress);

// The poses of any frames; `summary` may be null.
absl::StatusOr<PoseTrack> FitFrames(const MeshSequence& sequence,
                                    const std::vector<int>& clip_starts, const Rig& rig,
                                    const TrainOptions& options, const TrainResources& resources,
                                    PoseFitSummary* summary, const Progress& progress);

// The poses of the training frames. With options.refine the rig is refined on those poses first
// (RefineRig) and they are fitted again.
absl::StatusOr<PoseTrack> FitTrainingFrames(const TrainOptions& options,
                                            const TrainResources& resources, RiggedFrames* rigged,
                                            PoseFitSummary* summary, const Progress& progress);

// What every learner sees: plain matrices, and what turns its output into a full mesh.
struct LearningData {
  Eigen::VectorXd feature_reference;
  Eigen::MatrixXd features;  // T x D_S
  // T rows of scores, 3C values each: offsets in meters, or those that `differential` encodes.
  PrincipalComponents details;
  std::vector<int> clip_starts;
  std::vector<int> control_vertices;  // C
  std::optional<RbfUpsampler> upsampler;
  std::optional<DifferentialCoordinates> differential;  // learn in these, with that option
  std::vector<DetailRegion> regions;             // one for each bone that moves a control vertex
  std::vector<std::vector<int>> feature_groups;  // columns of `features`, by joint and pose

  // The offsets (3C, meters) that one row of scores stands for.
  Eigen::VectorXd DetailOf(const Eigen::VectorXd& scores) const;
};
absl::StatusOr<LearningData> ComputeLearningData(const RiggedFrames& rigged, const PoseTrack& track,
                                                 const TrainOptions& options,
                                                 const TrainResources& resources,
                                                 const Progress& progress);

// Trains `learner`, which is chosen (not auto). The model predicts offsets, whatever coordinates it
// was trained in.
// The direct GP of some data and options, once one of the learners has trained it. `direct_gp` may
// be null; else it is taken from there, or left there.
using DirectGp = std::optional<GpRegression>;
absl::StatusOr<std::shared_ptr<const DetailModel>> LearnDetails(const LearningData& data,
                                                                LearnerChoice learner,
                                                                const TrainOptions& options,
                                                                const Progress& progress,
                                                                DirectGp* direct_gp = nullptr);

// The learner of `options`; for auto the one with the lowest error on contiguous blocks of
// training frames that it did not see. validation: filled then, in % of diagonal_m; may be null.
absl::StatusOr<LearnerChoice> ChooseLearner(const LearningData& data, const TrainOptions& options,
                                            double diagonal_m, LearnerValidation* validation,
                                            const Progress& progress);

// All but the errors of the record. diagonal_m: bounding-box diagonal of the first frame, meters.
absl::StatusOr<std::shared_ptr<const CharacterModel>> AssembleModel(
    const RiggedFrames& rigged, const LearningData& data, const TrainOptions& options,
    LearnerChoice learner, std::shared_ptr<const DetailModel> detail_model, double diagonal_m);

}  // namespace pleat
