// The character: rig, learned detail and what training recorded. Immutable and shared.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
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
  int frame = 0;            // in that clip
  double mean_percent = 0;  // mean vertex distance
};

// How learners did on contiguous blocks of training frames that they did not see, which is what
// the learner "auto" chooses by.
struct LearnerValidation {
  int num_held_out_frames = 0;                 // 0: nothing was held out
  std::map<std::string, double> mean_percent;  // per learner: mean vertex distance
};

// What training found out about its own result; kept in the model file.
struct TrainingRecord {
  std::string learner;           // the learner that was chosen, one of LearnerNames()
  LearnerValidation validation;  // that chose it
  int num_frames = 0;            // training frames
  int rest_frame = 0;
  double yaw_degrees = 0;       // facing that was found
  double rig_residual = 0;      // of the embedding; under .03 is trusted
  double diagonal_m = 0;        // bounding-box diagonal of the first frame, meters
  ErrorSummary fit;             // skinned only against the input; frame_mean_percent not kept
  ErrorSummary reconstruction;  // hybrid against the input; frame_mean_percent not kept
  std::vector<std::string> warnings;
  std::vector<FrameError> worst_frames;   // up to five, skinned only, largest error first
  std::vector<double> joint_fit_percent;  // per joint: skinned only, mean over its bone's vertices
  // How much the poses shake (RotationJitter), and what smoothing started from.
  double pose_jitter_degrees = 0;
  double unsmoothed_jitter_degrees = 0;
  double unsmoothed_rms_percent = 0;
};

// Never changes after it is made; queries share it without locks.
class CharacterModel {
 public:
  struct Parts {
    std::string name;
    FrameRate frame_rate;
    Topology topology;
    MeshAppearance appearance;
    Rig rig;                                // all V vertices, J joints
    TrainOptions options;                   // as used
    Eigen::VectorXd feature_reference;      // PoseFeatures::reference()
    std::vector<int> control_vertices;      // C ascending vertex indices; all V at full resolution
    std::optional<RbfUpsampler> upsampler;  // V x C; absent at full resolution
    std::shared_ptr<const DetailModel> detail_model;  // features -> details, 3C outputs
    TrainingRecord record;
  };

  // Checks that all parts fit together (counts, ranges): kInvalidArgument names what does not.
  static absl::StatusOr<std::shared_ptr<const CharacterModel>> Create(Parts parts);

  // The same character with another record.
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
  FrameRate frame_rate() const { return parts_.frame_rate; }
  int num_vertices() const { return parts_.topology.num_vertices(); }

  // Control-to-full upsampling folded into the detail basis: it gives the details of all vertices
  // (3V; xyz of vertex 0, of vertex 1, ...).
  const DetailBasis& full_basis() const {
    return parts_.upsampler ? upsampled_basis_ : parts_.detail_model->basis();
  }

  // The rig as a query reads it.
  const FrameSkinning& skinning() const { return skinning_; }

  // Resident size, what the cache is charged.
  size_t memory_bytes() const;

 private:
  CharacterModel(Parts parts, PoseFeatures features, DetailBasis upsampled_basis);
  CharacterModel(const CharacterModel&) = default;

  Parts parts_;
  PoseFeatures features_;
  FrameSkinning skinning_;
  DetailBasis upsampled_basis_;  // empty at full resolution
};

}  // namespace pleat
