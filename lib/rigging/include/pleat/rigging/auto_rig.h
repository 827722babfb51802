// From a mesh sequence to a rig with 18 joints, without help (docs/method/rig.md).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/geometry/solid_surface.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/rigging/embedding.h"
#include "pleat/rigging/facing_evidence.h"
#include "pleat/rigging/heat_weights.h"
#include "pleat/skinning/rig.h"

namespace pleat {

struct AutoRigOptions {
  int rest_frame = -1;  // -1 = automatic: frame 0 when it is trusted, else the best of a few
  // Where the character faces, in degrees about +y from +z towards +x. Unset: the best of four.
  std::optional<double> yaw_degrees;
  // Joints that a person placed in the rest frame, which is then the first one unless rest_frame
  // says otherwise, in meters. The others are solved with them, and nothing is refused.
  std::vector<PlacedJoint> placed_joints = {};
  int max_frames_tried = 8;
  // The grid of the frames that are only compared with each other; the chosen one is looked at
  // again on volume.resolution.
  int probe_resolution = 64;
  // Whether to try other axes than +y as up, too, when no frame is trusted as it stands (Z up,
  // lying, upside down). The rig stays in the axes of the input.
  bool any_orientation = true;
  // Residuals of the embedding (docs/method/rig.md#the-residual): below `trusted` the first frame
  // is taken at once, arms that reach out provided; above it the rig carries a warning, above
  // `refused` there is none.
  double trusted_residual = .03;
  double refused_residual = .15;
  // How much Embedding::arm_shortfall adds to the residual when frames are compared.
  double arm_shortfall_weight = .5;
  // Two facings whose residuals are nearer than this are reported as doubtful.
  double facing_margin = .004;
  int num_threads = 0;  // 0 = one per core
  BodyVolumeOptions volume;
  EmbeddingOptions embedding;  // yaws_degrees is replaced when yaw_degrees is set
  HeatWeightsOptions heat;
};

struct AutoRigSummary {
  int rest_frame = 0;
  double yaw_degrees = 0;
  // Where the character's head is in the rest frame, as a unit vector; +y when it stands as input
  // is expected to.
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  double residual = 0;
  FacingEvidence evidence;
  bool is_turned_by_evidence = false;   // front and back are those of the feet and knees
  std::vector<FacingResidual> facings;  // those of the rest frame
  int num_frames_tried = 0;
  int num_spheres = 0;
  SurfaceReport surface;  // that of the rest frame
  // How many vertices each part has that floats beside the body, most first: such parts were left
  // out when the skeleton was sought.
  std::vector<int> stray_parts;
  HeatWeightsSummary heat;
  std::vector<std::string> warnings;
};

// Returns the rig of `sequence` in its best frame: a skeleton with the order and names of the
// template (HumanTemplate), where left is the character's left; weights; and that frame as it is as
// rest positions. Deterministic for any number of threads. The error is kFailedPrecondition, with
// the measured residual and what to do, when the body is not one that a human skeleton fits;
// kInvalidArgument for a frame or option out of range; and kCancelled. `summary` may be null.
absl::StatusOr<Rig> AutoRig(const MeshSequence& sequence, const AutoRigOptions& options = {},
                            AutoRigSummary* summary = nullptr, const Progress& progress = {});

}  // namespace pleat
