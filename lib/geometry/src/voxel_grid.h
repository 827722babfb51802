// A grid of voxels around a surface and what an outer surface needs of it: rasterization,
// distances, filling, pieces. Masks hold one byte for each voxel, 0 or 1.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace pleat {

using VoxelMask = std::vector<uint8_t>;

struct VoxelGrid {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // corner of the first voxel
  double spacing = 1;
  Eigen::Vector3i size = Eigen::Vector3i::Zero();  // voxels along x, y, z

  // A grid of cubes around `box`, `resolution` of them along its longest side, and `padding` more
  // on every side.
  static VoxelGrid Around(const Eigen::AlignedBox3d& box, int resolution, int padding);

  int num_voxels() const { return size.prod(); }
  int Index(const Eigen::Vector3i& at) const {
    return at.x() + size.x() * (at.y() + size.y() * at.z());
  }
  // The voxel that holds `point`, or the nearest one of the grid.
  int IndexAt(const Eigen::Vector3d& point) const;
};

// Marks every voxel through whose center line, along any axis, a triangle passes, and those of the
// corners: a path from voxel to voxel through common faces cannot cross the surface without meeting
// a marked one. `is_used` (per triangle) may be empty: all.
VoxelMask RasterizeTriangles(const VoxelGrid& grid,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                             const Eigen::Ref<const Eigen::Matrix3Xi>& triangles,
                             const std::vector<char>& is_used);

// Returns for every voxel the squared distance to the nearest voxel of `mask`, in voxels; whatever
// is farther than `reach` (at most 14) has some number above reach^2.
std::vector<uint8_t> SquaredVoxelDistances(const VoxelGrid& grid, const VoxelMask& mask, int reach);

// Returns the voxels that a path through common faces reaches from the first voxel of the grid
// without entering `walls`.
VoxelMask FloodOutside(const VoxelGrid& grid, const VoxelMask& walls);

// Numbers the pieces of `mask` that hang together through common faces, from 1 on; 0 = outside of
// the mask. Returns the number of pieces.
int LabelPieces(const VoxelGrid& grid, const VoxelMask& mask, std::vector<int>* labels);

}  // namespace pleat
