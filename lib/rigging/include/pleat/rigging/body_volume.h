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
#include "pleat/geometry/outer_surface.h"
#include "pleat/geometry/solid_surface.h"
#include "pleat/geometry/triangle_tree.h"
#include "pleat/geometry/winding_number.h"
#include "pleat/rigging/sphere_graph.h"

namespace pleat {

struct BodyVolumeOptions {
  int resolution = 128;      // grid cells along the longest side of the body
  double min_depth = 0.006;  // unit box; shallower medial samples are left out
  int max_spheres = 1000;    // of the graph
  int num_threads = 1;       // 0 = one per core
  OuterSurfaceOptions outer = {};
};

// A closed surface that bounds the volume of a body.
struct BodyShell {
  Eigen::Matrix3Xd positions;  // 3 x W
  Eigen::Matrix3Xi triangles;  // 3 x F, outward
};

// The shell of the body that a frame of a mesh shows, scaled uniformly so that its longest side is
// 0.9, centered at 0.5 (Baran and Popovic 2007, section 3). unit = scale * world + offset.
struct BodySurface {
  double scale = 1;  // unit lengths per meter
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  // The mesh itself where it is one component that does not overlap itself, else the boundary of
  // the union of its parts (docs/method/rig.md#outer-surface).
  BodyShell shell;
  bool is_repaired = false;  // the shell is not the mesh itself
  bool is_closed = false;    // the shell has no holes
  double shell_spacing = 0;  // how far a repaired shell may be off, unit box
  int growth = 0;            // voxels by which gaps were closed
  // Of the shell. The latter refers to the former.
  std::shared_ptr<const TriangleTree> tree;
  std::shared_ptr<const WindingNumber> winding_number;
};

// Finds the shell. positions: 3 x V, any unit. The error is kInvalidArgument when the mesh has no
// area, kFailedPrecondition when it encloses nothing, and kCancelled.
absl::StatusOr<BodySurface> PrepareBodySurface(const Topology& topology,
                                               const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                               const BodyVolumeOptions& options = {},
                                               const Progress& progress = {});

// A body's surface with the distance field, medial samples and spheres of its shell.
struct BodyVolume {
  std::shared_ptr<const BodySurface> body;
  DistanceField field;
  std::vector<MedialSample> medial_samples;
  // The packed spheres that hang together and hold the most volume: what floats beside the body is
  // left out.
  SphereGraph graph;

  Eigen::Matrix3Xd UnitFromWorld(const Eigen::Matrix3Xd& points) const {
    return (body->scale * points).colwise() + body->offset;
  }
  Eigen::Matrix3Xd WorldFromUnit(const Eigen::Matrix3Xd& points) const {
    return (points.colwise() - body->offset) / body->scale;
  }
};

// Computes field, samples and spheres of a surface, which several volumes may share. The error is
// kFailedPrecondition when it encloses no volume, and kCancelled.
absl::StatusOr<BodyVolume> ComputeBodyVolume(std::shared_ptr<const BodySurface> body,
                                             const BodyVolumeOptions& options = {},
                                             const Progress& progress = {});

// Does both.
absl::StatusOr<BodyVolume> ComputeBodyVolume(const Topology& topology,
                                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                             const BodyVolumeOptions& options = {},
                                             const Progress& progress = {});

// Returns how many vertices each component of `surface` (unit box) has that lies nowhere near the
// volume, most first: what floats beside the body.
std::vector<int> StrayParts(const SolidSurface& surface, const DistanceField& field);

}  // namespace pleat
