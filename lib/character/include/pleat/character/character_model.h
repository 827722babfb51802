// The character: a rig, the learned detail and what training has recorded. Immutable and shared.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/character/skin_features.h"
#include "pleat/character/train_options.h"
#include "pleat/geometry/rbf_upsampling.h"
#include "pleat/learner/detail_model.h"
#include "pleat/mesh/error_metrics.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/mesh/topology.h"
#include "pleat/skeleton/pose_features.h"
#include "pleat/skinning/frame_skinning.h"
#include "pleat/skinning/rig.h"

namespace pleat {

struct FrameError {
  int clip = 0;             // index of the training clip
  int frame = 0;            // index of the frame in that clip
  double mean_percent = 0;  // mean vertex distance, % of the diagonal
};

// How well the learners did on contiguous blocks of training frames that they did not see. The
// learner "auto" chooses by this.
struct LearnerValidation {
  int num_held_out_frames = 0;  // 0: nothing was held out
  // The mean vertex distance of each learner, by its name, in % of the diagonal.
  std::map<std::string, double> mean_percent;
};

// What training found out about its own result. It is kept in the model file. Percentages of
// lengths refer to diagonal_m.
struct TrainingRecord {
  std::string learner;           // the learner that was chosen, one of LearnerNames()
  LearnerValidation validation;  // what it was chosen by
  int num_frames = 0;            // the number of training frames
  int rest_frame = 0;            // the frame that was rigged
  double yaw_degrees = 0;        // the facing that was found, about +y from +z
  double rig_residual = 0;       // that of the embedding; a value under .03 can be trusted
  double diagonal_m = 0;         // bounding-box diagonal of the first frame, meters
  // The errors of the skinned rig alone and of the whole model on the training frames. Their
  // frame_mean_percent is not kept.
  ErrorSummary fit;
  ErrorSummary reconstruction;
  std::vector<std::string> warnings;
  std::vector<FrameError> worst_frames;  // up to five, skinned only, the largest error first
  // J: the mean error of each bone's vertices, skinned only, weighted by the skinning weights.
  std::vector<double> joint_fit_percent;
  // How much the poses shake (RotationJitter), and what they were like before smoothing.
  double pose_jitter_degrees = 0;
  double unsmoothed_jitter_degrees = 0;
  double unsmoothed_rms_percent = 0;
};

// A model never changes after it is made, so any number of threads may query it without locks.
class CharacterModel {
 public:
  struct Parts {
    std::string name;
    FrameRate frame_rate;
    Topology topology;
    MeshAppearance appearance;
    Rig rig;                                // V vertices, J joints
    TrainOptions options;                   // as they were used
    Eigen::VectorXd feature_reference;      // PoseFeatures::reference()
    std::vector<int> control_vertices;      // C ascending vertex indices; all V at full resolution
    std::optional<RbfUpsampler> upsampler;  // V x C; absent at full resolution
    // What the regional learner knows beside the features of the pose.
    std::optional<SkinFeatures> skin_features;
    // Turns a feature row (of the pose, then of the skin) into the details of the control vertices
    // (3C).
    std::shared_ptr<const DetailModel> detail_model;
    TrainingRecord record;
  };

  // Checks that counts and ranges of all parts fit together. kInvalidArgument names what does not.
  static absl::StatusOr<std::shared_ptr<const CharacterModel>> Create(Parts parts);

  // Returns the same character with another record.
  std::shared_ptr<const CharacterModel> WithRecord(TrainingRecord record) const;

  const Parts& parts() const { return parts_; }
  const std::string& name() const { return parts_.name; }
  const Topology& topology() const { return parts_.topology; }
  const Skeleton& skeleton() const { return parts_.rig.skeleton; }
  const Rig& rig() const { return parts_.rig; }
  const TrainOptions& options() const { return parts_.options; }
  const TrainingRecord& record() const { return parts_.record; }
  const DetailModel& detail_model() const { return *parts_.detail_model; }
  const PoseFeatures& features() const { return features_; }
  const std::optional<SkinFeatures>& skin_features() const { return parts_.skin_features; }
  FrameRate frame_rate() const { return parts_.frame_rate; }
  int num_vertices() const { return parts_.topology.num_vertices(); }

  // The detail basis for all vertices (3V rows: x, y, z of vertex 0, then of vertex 1, and so on).
  // Below full resolution, the upsampling from the control vertices is folded into it once, so that
  // a query expands coefficients to all vertices in one step.
  const PartedBasis& full_basis() const {
    return parts_.upsampler ? upsampled_basis_ : parts_.detail_model->basis();
  }

  // The rig as a query reads it, with the vertices in the order of full_basis().
  const FrameSkinning& skinning() const { return skinning_; }

  // The resident size in bytes, which the cache is charged.
  size_t memory_bytes() const;

 private:
  CharacterModel(Parts parts, PoseFeatures features, PartedBasis upsampled_basis);
  CharacterModel(const CharacterModel&) = default;

  Parts parts_;
  PoseFeatures features_;
  FrameSkinning skinning_;
  PartedBasis upsampled_basis_;  // empty at full resolution
};

}  // namespace pleat
