// The steps that training and evaluation share: steps 3 to 7 of the data flow in ARCHITECTURE.md.
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
#include "regional_data.h"

namespace pleat {

// The frames of one or more recordings, one after the other.
struct TrainingFrames {
  MeshSequence sequence;
  std::vector<int> clip_starts;  // ascending from 0; history and dynamics end at a start
  int num_rig_frames;            // the rest frame is one of these first frames (the first clip)
  // The number of every frame in its recording. Numbers are missing where frames are held out.
  std::vector<int> frame_numbers;
};

// Joins clips that have the same connectivity and frame rate. kInvalidArgument names the clip that
// does not fit.
absl::StatusOr<TrainingFrames> JoinClips(const std::vector<MeshSequence>& clips);

struct RiggedFrames {
  TrainingFrames frames;
  Rig rig;
  AutoRigSummary rig_summary;
  std::vector<int> locked_joints;  // joints that refinement must leave alone
};
// Takes the user's rig, with heat weights where it has none. kInvalidArgument when it does not fit
// the frames.
absl::StatusOr<RiggedFrames> TakeUserRig(const TrainingFrames& frames, const UserRig& rig,
                                         const TrainResources& resources, const Progress& progress);
// Finds the rig automatically (AutoRig), on the frames of the first clip.
absl::StatusOr<RiggedFrames> RigFrames(const TrainingFrames& frames, const TrainOptions& options,
                                       const TrainResources& resources, const Progress& progress);

// Fits poses to any frames, with the rig fixed. `summary` may be null.
absl::StatusOr<PoseTrack> FitFrames(const MeshSequence& sequence,
                                    const std::vector<int>& clip_starts, const Rig& rig,
                                    const TrainOptions& options, const TrainResources& resources,
                                    PoseFitSummary* summary, const Progress& progress);

// Fits poses to the training frames. With options.refine, the rig is then refined on these poses
// (RefineRig) and the poses are fitted again with the new rig.
absl::StatusOr<PoseTrack> FitTrainingFrames(const TrainOptions& options,
                                            const TrainResources& resources, RiggedFrames* rigged,
                                            PoseFitSummary* summary, const Progress& progress);

// What every learner sees, which is plain matrices, and what turns its output into a full mesh.
struct LearningData {
  Eigen::VectorXd feature_reference;  // PoseFeatures::Reference
  Eigen::MatrixXd features;           // T x D_S
  RegionalData regional;
  // The details of the control vertices as T rows of scores (T x r) in a basis of 3C values, which
  // are offsets in meters or what `differential` encodes. The regional learner needs a finer basis
  // than the others, which take its first components.
  PrincipalComponents details;
  std::vector<int> clip_starts;
  std::vector<int> control_vertices;  // C
  std::optional<RbfUpsampler> upsampler;
  // The coordinates of the details, with the option detail_coordinates=differential.
  std::optional<DifferentialCoordinates> differential;
  std::vector<std::vector<int>> feature_groups;  // columns of `features`, by joint and pose

  // Returns the features of frame t as `model` reads them: of the pose, and of the skin if it has
  // such (those of the patches stand last, and a model without patches does not read them).
  Eigen::VectorXd FeaturesOf(const DetailModel& model, int t) const;
  // Returns the offsets (3C, meters) that one row of scores (r) stands for.
  Eigen::VectorXd DetailOf(const Eigen::VectorXd& scores) const;
};
// Computes features and details of the training frames. Of a long sequence, never more than a fixed
// number of frames of details is in memory.
absl::StatusOr<LearningData> ComputeLearningData(const RiggedFrames& rigged, const PoseTrack& track,
                                                 const TrainOptions& options,
                                                 const TrainResources& resources,
                                                 const Progress& progress);

// The direct GP of some data and options, once one of the learners has trained it.
using DirectGp = std::optional<GpRegression>;
// Trains `learner`, which must not be "auto". The model predicts offsets, whatever coordinates it
// was trained in. `direct_gp` may be null. Otherwise a learner that needs the direct GP takes it
// from there, or trains it and leaves it there; all calls must then have the same data and options.
absl::StatusOr<std::shared_ptr<const DetailModel>> LearnDetails(
    const LearningData& data, const Rig& rig, LearnerChoice learner, const TrainOptions& options,
    const Progress& progress, DirectGp* direct_gp = nullptr);

// Returns the learner of `options`; for "auto", the one with the lowest error on contiguous blocks
// of training frames that it did not see. `validation` may be null; for "auto" it is filled in, in
// % of diagonal_m.
absl::StatusOr<LearnerChoice> ChooseLearner(const LearningData& data, const Rig& rig,
                                            const TrainOptions& options, double diagonal_m,
                                            LearnerValidation* validation,
                                            const Progress& progress);

// Makes the model with everything but the errors in its record. diagonal_m: the bounding-box
// diagonal of the first frame, meters.
absl::StatusOr<std::shared_ptr<const CharacterModel>> AssembleModel(
    const RiggedFrames& rigged, const LearningData& data, const TrainOptions& options,
    LearnerChoice learner, std::shared_ptr<const DetailModel> detail_model, double diagonal_m);

}  // namespace pleat
