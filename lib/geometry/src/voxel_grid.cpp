#include "voxel_grid.h"

#include <algorithm>
#include <cmath>

namespace pleat {
namespace {

// Marks the voxels along the lines through the voxels' centers that run along `axis`. corners: in
// voxels.
void RasterizeAlong(const VoxelGrid& grid, const Eigen::Matrix3d& corners, int axis,
                    VoxelMask* mask) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Eigen::Vector3d a = corners.col(0), ab = corners.col(1) - a, ac = corners.col(2) - a;
  const double doubled_area = ab[u] * ac[v] - ab[v] * ac[u];
  if (!(std::abs(doubled_area) > 1e-12)) return;
  const Eigen::Vector3d low = corners.rowwise().minCoeff(), high = corners.rowwise().maxCoeff();
  const double slope_u = (ab[axis] * ac[v] - ac[axis] * ab[v]) / doubled_area;
  const double slope_v = (ac[axis] * ab[u] - ab[axis] * ac[u]) / doubled_area;
  for (int row = std::max(0, static_cast<int>(std::ceil(low[v] - .5)));
       row < grid.size[v] && row + .5 <= high[v]; ++row) {
    // The stretch of this row that lies in the triangle.
    double first = high[u], last = low[u];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d from = corners.col(k), to = corners.col((k + 1) % 3);
      if ((from[v] - row - .5) * (to[v] - row - .5) > 0) continue;
      const double rise = to[v] - from[v];
      if (rise == 0) {
        first = std::min({first, from[u], to[u]});
        last = std::max({last, from[u], to[u]});
        continue;
      }
      const double at = from[u] + (row + .5 - from[v]) / rise * (to[u] - from[u]);
      first = std::min(first, at);
      last = std::max(last, at);
    }
    Eigen::Vector3i voxel;
    voxel[v] = row;
    for (int column = std::max(0, static_cast<int>(std::ceil(first - .5 - 1e-9)));
         column < grid.size[u] && column + .5 <= last + 1e-9; ++column) {
      const double depth = a[axis] + slope_u * (column + .5 - a[u]) + slope_v * (row + .5 - a[v]);
      voxel[u] = column;
      voxel[axis] = std::clamp(static_cast<int>(std::floor(depth)), 0, grid.size[axis] - 1);
      (*mask)[grid.Index(voxel)] = 1;
    }
  }
}

// Replaces each value by the least of value(i + o) + o^2 along one axis. `stride` leads from one
// voxel to the next along it; the voxels of a line begin at `starts`.
void SpreadAlong(const VoxelGrid& grid, int axis, int reach, std::vector<uint8_t>* distances) {
  const int length = grid.size[axis];
  const int stride = axis == 0 ? 1 : axis == 1 ? grid.size.x() : grid.size.x() * grid.size.y();
  const int farthest = (reach + 1) * (reach + 1);
  // Lines that lie side by side in memory are spread together.
  const int width = axis == 0 ? 1 : stride;
  const int num_blocks = grid.num_voxels() / (length * width);
  std::vector<uint8_t> block(static_cast<size_t>(length) * width);
  for (int b = 0; b < num_blocks; ++b) {
    uint8_t* data = distances->data() + static_cast<size_t>(b) * length * width;
    std::copy(data, data + block.size(), block.begin());
    for (int offset = -reach; offset <= reach; ++offset) {
      if (offset == 0) continue;
      const int cost = offset * offset;
      for (int i = std::max(0, -offset); i < std::min(length, length - offset); ++i) {
        uint8_t* to = data + static_cast<size_t>(i) * width;
        const uint8_t* from = block.data() + static_cast<size_t>(i + offset) * width;
        for (int k = 0; k < width; ++k) {
          to[k] =
              static_cast<uint8_t>(std::min<int>(to[k], std::min<int>(from[k] + cost, farthest)));
        }
      }
    }
  }
}

// Calls visit(neighbor) for the six neighbors of a voxel that lie in the grid.
template <typename Visit>
void ForNeighbors(const VoxelGrid& grid, int index, const Visit& visit) {
  const int nx = grid.size.x(), ny = grid.size.y(), nz = grid.size.z();
  const int x = index % nx, y = index / nx % ny, z = index / (nx * ny);
  if (x > 0) visit(index - 1);
  if (x + 1 < nx) visit(index + 1);
  if (y > 0) visit(index - nx);
  if (y + 1 < ny) visit(index + nx);
  if (z > 0) visit(index - nx * ny);
  if (z + 1 < nz) visit(index + nx * ny);
}

// Visits the voxels that hang together with `seed`, which the caller has entered. enter(voxel) says
// whether a neighbor belongs to them and was not entered before, and marks it.
template <typename Enter>
void Flood(const VoxelGrid& grid, int seed, const Enter& enter) {
  std::vector<int> stack = {seed};
  while (!stack.empty()) {
    const int index = stack.back();
    stack.pop_back();
    ForNeighbors(grid, index, [&](int next) {
      if (enter(next)) stack.push_back(next);
    });
  }
}

}  // namespace

VoxelGrid VoxelGrid::Around(const Eigen::AlignedBox3d& box, int resolution, int padding) {
  VoxelGrid grid;
  grid.spacing = box.sizes().maxCoeff() / resolution;
  for (int k = 0; k < 3; ++k) {
    grid.size[k] = static_cast<int>(std::ceil(box.sizes()[k] / grid.spacing)) + 1 + 2 * padding;
  }
  grid.origin = box.center() - .5 * grid.spacing * grid.size.cast<double>();
  return grid;
}

int VoxelGrid::IndexAt(const Eigen::Vector3d& point) const {
  Eigen::Vector3i at;
  for (int k = 0; k < 3; ++k) {
    const double place = std::floor((point[k] - origin[k]) / spacing);
    at[k] = static_cast<int>(std::clamp(place, 0.0, size[k] - 1.0));
  }
  return Index(at);
}

VoxelMask RasterizeTriangles(const VoxelGrid& grid,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                             const Eigen::Ref<const Eigen::Matrix3Xi>& triangles,
                             const std::vector<char>& is_used) {
  VoxelMask mask(grid.num_voxels(), 0);
  for (Eigen::Index f = 0; f < triangles.cols(); ++f) {
    if (!is_used.empty() && is_used[f] == 0) continue;
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = positions.col(triangles(k, f));
      mask[grid.IndexAt(corner)] = 1;
      corners.col(k) = (corner - grid.origin) / grid.spacing;
    }
    for (int axis = 0; axis < 3; ++axis) RasterizeAlong(grid, corners, axis, &mask);
  }
  return mask;
}

std::vector<uint8_t> SquaredVoxelDistances(const VoxelGrid& grid, const VoxelMask& mask,
                                           int reach) {
  const uint8_t farthest = static_cast<uint8_t>((reach + 1) * (reach + 1));
  std::vector<uint8_t> distances(mask.size());
  for (size_t i = 0; i < mask.size(); ++i) distances[i] = mask[i] != 0 ? 0 : farthest;
  for (int axis = 0; axis < 3; ++axis) SpreadAlong(grid, axis, reach, &distances);
  return distances;
}

VoxelMask FloodOutside(const VoxelGrid& grid, const VoxelMask& walls) {
  VoxelMask outside(walls.size(), 0);
  outside[0] = 1;
  Flood(grid, 0, [&](int voxel) {
    if (outside[voxel] != 0 || walls[voxel] != 0) return false;
    outside[voxel] = 1;
    return true;
  });
  return outside;
}

int LabelPieces(const VoxelGrid& grid, const VoxelMask& mask, std::vector<int>* labels) {
  labels->assign(mask.size(), 0);
  int num_pieces = 0;
  for (int seed = 0; seed < grid.num_voxels(); ++seed) {
    if (mask[seed] == 0 || (*labels)[seed] != 0) continue;
    ++num_pieces;
    (*labels)[seed] = num_pieces;
    Flood(grid, seed, [&](int voxel) {
      if (mask[voxel] == 0 || (*labels)[voxel] != 0) return false;
      (*labels)[voxel] = num_pieces;
      return true;
    });
  }
  return num_pieces;
}

}  // namespace pleat
