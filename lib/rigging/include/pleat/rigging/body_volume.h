// A character's volume in the unit box: the first two steps of the embedding. What follows measures
// lengths in this box, so that its constants need no unit.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/geometry/distance_field.h"
#include "pleat/geometry/medial_samples.h"
#include "pleat/geometry/solid_surface.h"
#include "pleat/geometry/triangle_tree.h"
#include "pleat/geometry/winding_number.h"

namespace pleat {

struct BodyVolumeOptions {
  int resolution = 128;      // grid cells along the longest side of the body
  double min_depth = 0.006;  // unit box; shallower medial samples are left out
  int num_threads = 1;       // 0 = one per core
};

// The mesh scaled uniformly so that its longest side is 0.9, centered at 0.5 (Baran and Popovic
// 2007, section 3), with its distance field and medial samples. unit = scale * world + offset. The
// tree and the winding number are on the heap because the latter refers to the former, which must
// stay where it is when the volume is moved.
struct BodyVolume {
  double scale = 1;  // unit lengths per meter
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  SolidSurface surface;  // unit box
  std::unique_ptr<const TriangleTree> tree;
  std::unique_ptr<const WindingNumber> winding_number;
  DistanceField field;
  std::vector<MedialSample> medial_samples;
};

// Prepares the surface and computes field and samples. positions: 3 x V, any unit. The error is
// kInvalidArgument when the mesh has no area, kFailedPrecondition when it encloses no volume, and
// kCancelled.
absl::StatusOr<BodyVolume> ComputeBodyVolume(const Topology& topology,
                                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                             const BodyVolumeOptions& options = {},
                                             const Progress& progress = {});

}  // namespace pleat
