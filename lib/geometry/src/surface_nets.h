// The smoothed boundary of a solid of voxels as triangles.
#pragma once

#include <Eigen/Core>

#include "voxel_grid.h"

namespace pleat {

// Smooths the mask with the filter (1 3 3 1) / 8 along each axis, samples it at every second corner
// of the voxels, and returns the surface at one half by surface nets (Gibson 1998, "Constrained
// elastic surface nets", without the constraint): one vertex for each cell that the surface
// crosses, at the mean of the crossings of its edges. Closed and oriented outward where the mask
// keeps two voxels away from the border of the grid.
void ExtractSurface(const VoxelGrid& grid, const VoxelMask& mask, Eigen::Matrix3Xd* positions,
                    Eigen::Matrix3Xi* triangles);

}  // namespace pleat
