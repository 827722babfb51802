// The boundary of the union of all parts of a mesh: what a volume method sees of a body whose parts
// overlap, stand open or float (docs/method/rig.md#outer-surface).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"

namespace pleat {

struct OuterSurfaceOptions {
  int resolution = 144;  // voxels along the longest side; the surface has half as many cells
  // Gaps are closed by growing the surface by 0, 1, ... voxels, up to this (at most 14), until the
  // filled solid has `enough_volume` of the volume that the largest growth encloses, and no piece
  // that the largest growth connects is left apart.
  int max_growth = 5;
  int growth = -1;  // the voxels to grow by where they are known, -1 = found as above
  double enough_volume = .75;
  double most_left_apart = .02;  // share of the volume
};

struct OuterSurface {
  Eigen::Matrix3Xd positions;  // 3 x W, in the unit of the input
  Eigen::Matrix3Xi triangles;  // 3 x F, closed, oriented outward
  double spacing = 0;          // side of a voxel
  int growth = 0;              // voxels by which gaps were closed
};

// Fills the union of all triangles on a grid, keeps its largest piece and returns its smoothed
// boundary. Orientation, overlaps and inner walls of the input do not matter, and neither does the
// distance to what floats around: the grid is laid around what has the most area. positions: 3 x V;
// triangles: 3 x F. The error is kInvalidArgument when nothing has an extent or an option is out of
// range, kFailedPrecondition when nothing is enclosed, and kCancelled.
absl::StatusOr<OuterSurface> ComputeOuterSurface(
    const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
    const Eigen::Ref<const Eigen::Matrix3Xi>& triangles, const OuterSurfaceOptions& options = {},
    const Progress& progress = {});

}  // namespace pleat
