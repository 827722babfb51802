// What the regional learner sees beside the features of the poses: the regions of the body and the
// skin in each of them (docs/method/learner.md#regions).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/character/skin_features.h"
#include "pleat/character/train_options.h"
#include "pleat/learner/detail_model.h"
#include "pleat/mesh/topology.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/rig.h"

namespace pleat {

struct RegionalData {
  // First the regions of the bones, then patches of the surface. The features of the skin that a
  // region sees are columns behind those of the poses.
  std::vector<DetailRegion> regions;
  int num_bone_regions = 0;
  std::optional<SkinFeatures> skin_features;  // none where the mesh has no edges
  Eigen::MatrixXd skin_rows;                  // T x D_E

  // Returns the same for the frames `rows` alone.
  RegionalData OfRows(const std::vector<int>& rows) const;
  // Returns the same with the regions of the bones alone: a prediction that costs a third.
  RegionalData WithoutPatches(const Rig& rig) const;
};

// num_pose_features: columns of the features of the poses. Errors are those of SkinFeatures.
absl::StatusOr<RegionalData> ComputeRegionalData(const Topology& topology, const Rig& rig,
                                                 const PoseTrack& track,
                                                 const std::vector<int>& control_vertices,
                                                 int num_pose_features, const TrainOptions& options,
                                                 int num_threads);

}  // namespace pleat
