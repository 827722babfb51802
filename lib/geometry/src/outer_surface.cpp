#include "pleat/geometry/outer_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "surface_nets.h"
#include "voxel_grid.h"

namespace pleat {
namespace {

constexpr int kMinSurfaceResolution = 16, kMaxSurfaceResolution = 512, kMaxGrowth = 14;
// The grid on which far crumbs are found, and how far apart its pieces are, in voxels.
constexpr int kFocusResolution = 48, kFocusGrowth = 3;
// A piece that spans less than this share of everything is looked at again by itself.
constexpr double kFocusShare = .7;

using Triangles = Eigen::Ref<const Eigen::Matrix3Xi>;
using Positions = Eigen::Ref<const Eigen::Matrix3Xd>;

Eigen::Vector3d Corner(const Positions& positions, const Triangles& triangles, Eigen::Index f,
                       int k) {
  return positions.col(triangles(k, f));
}

Eigen::AlignedBox3d BoxOf(const Positions& positions, const Triangles& triangles,
                          const std::vector<char>& is_used) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index f = 0; f < triangles.cols(); ++f) {
    if (is_used[f] == 0) continue;
    for (int k = 0; k < 3; ++k) box.extend(Corner(positions, triangles, f, k));
  }
  return box;
}

// Keeps the triangles of the piece with the most area, until that piece spans most of what is left.
// Crumbs far away would otherwise make the voxels larger than the body.
Eigen::AlignedBox3d FocusOnLargest(const Positions& positions, const Triangles& triangles,
                                   std::vector<char>* is_used) {
  Eigen::AlignedBox3d box = BoxOf(positions, triangles, *is_used);
  while (box.sizes().maxCoeff() > 0 && box.sizes().allFinite()) {
    const VoxelGrid grid = VoxelGrid::Around(box, kFocusResolution, kFocusGrowth + 1);
    VoxelMask grown = RasterizeTriangles(grid, positions, triangles, *is_used);
    const std::vector<uint8_t> distances = SquaredVoxelDistances(grid, grown, kFocusGrowth);
    for (size_t i = 0; i < grown.size(); ++i) {
      grown[i] = distances[i] <= kFocusGrowth * kFocusGrowth ? 1 : 0;
    }
    std::vector<int> labels;
    std::vector<double> areas(LabelPieces(grid, grown, &labels) + 1, 0.0);
    if (areas.size() <= 2) return box;
    std::vector<int> pieces(triangles.cols(), 0);
    for (Eigen::Index f = 0; f < triangles.cols(); ++f) {
      if ((*is_used)[f] == 0) continue;
      const Eigen::Vector3d a = Corner(positions, triangles, f, 0);
      pieces[f] = labels[grid.IndexAt(a)];
      areas[pieces[f]] += (Corner(positions, triangles, f, 1) - a)
                              .cross(Corner(positions, triangles, f, 2) - a)
                              .norm();
    }
    const auto largest = std::max_element(areas.begin(), areas.end()) - areas.begin();
    std::vector<char> kept = *is_used;
    for (Eigen::Index f = 0; f < triangles.cols(); ++f) kept[f] = pieces[f] == largest ? 1 : 0;
    const Eigen::AlignedBox3d kept_box = BoxOf(positions, triangles, kept);
    const bool is_focused = kept_box.sizes().maxCoeff() > kFocusShare * box.sizes().maxCoeff();
    // Near pieces stay, to be connected or left out by the finer grid.
    if (is_focused) return box;
    *is_used = std::move(kept);
    box = kept_box;
  }
  return box;
}

// A filled solid and its largest piece.
struct Solid {
  VoxelMask all, largest;
  int64_t volume = 0;  // voxels of the largest piece
};

// Grows the surface by `growth` voxels, fills it, and takes the growth away again.
Solid FillSolid(const VoxelGrid& grid, const std::vector<uint8_t>& from_surface, int growth) {
  VoxelMask walls(from_surface.size());
  for (size_t i = 0; i < walls.size(); ++i) {
    walls[i] = from_surface[i] <= growth * growth ? 1 : 0;
  }
  const VoxelMask outside = FloodOutside(grid, walls);
  Solid solid;
  solid.all.resize(walls.size());
  if (growth == 0) {
    for (size_t i = 0; i < walls.size(); ++i) solid.all[i] = outside[i] == 0 ? 1 : 0;
  } else {
    const std::vector<uint8_t> depths = SquaredVoxelDistances(grid, outside, growth);
    for (size_t i = 0; i < walls.size(); ++i) solid.all[i] = depths[i] > growth * growth ? 1 : 0;
  }
  std::vector<int> labels;
  std::vector<int64_t> volumes(LabelPieces(grid, solid.all, &labels) + 1, 0);
  for (const int label : labels) volumes[label] += label > 0 ? 1 : 0;
  const auto largest = std::max_element(volumes.begin(), volumes.end()) - volumes.begin();
  solid.volume = volumes[largest];
  solid.largest.resize(walls.size());
  for (size_t i = 0; i < walls.size(); ++i) {
    solid.largest[i] = labels[i] > 0 && labels[i] == largest ? 1 : 0;
  }
  return solid;
}

// Returns the solid of the smallest growth that encloses enough and connects what belongs together.
Solid CloseGaps(const VoxelGrid& grid, const VoxelMask& surface, const OuterSurfaceOptions& options,
                int* growth) {
  const int reach = options.growth >= 0 ? options.growth : options.max_growth;
  const std::vector<uint8_t> distances = SquaredVoxelDistances(grid, surface, std::max(1, reach));
  if (options.growth >= 0) {
    *growth = options.growth;
    return FillSolid(grid, distances, options.growth);
  }
  Solid most = FillSolid(grid, distances, options.max_growth);
  for (*growth = 0; *growth < options.max_growth; ++*growth) {
    Solid solid = FillSolid(grid, distances, *growth);
    int64_t left_apart = 0;
    for (size_t i = 0; i < solid.all.size(); ++i) {
      left_apart += solid.all[i] & most.largest[i] & (solid.largest[i] ^ 1);
    }
    if (static_cast<double>(solid.volume) >=
            options.enough_volume * static_cast<double>(most.volume) &&
        static_cast<double>(left_apart) <=
            options.most_left_apart * static_cast<double>(most.volume)) {
      return solid;
    }
  }
  return most;
}

absl::Status CheckSurfaceInput(const Triangles& triangles, const OuterSurfaceOptions& options) {
  if (triangles.cols() == 0) {
    return absl::InvalidArgumentError("an outer surface needs at least one triangle");
  }
  if (options.resolution < kMinSurfaceResolution || options.resolution > kMaxSurfaceResolution ||
      options.max_growth < 0 || options.max_growth > kMaxGrowth || options.growth > kMaxGrowth) {
    return absl::InvalidArgumentError(
        absl::StrCat("outer surface: resolution ", options.resolution, " and growth ",
                     options.max_growth, " must be ", kMinSurfaceResolution, " to ",
                     kMaxSurfaceResolution, " and 0 to ", kMaxGrowth));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<OuterSurface> ComputeOuterSurface(
    const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
    const Eigen::Ref<const Eigen::Matrix3Xi>& triangles, const OuterSurfaceOptions& options,
    const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckSurfaceInput(triangles, options));
  OuterSurface outer;
  std::vector<char> is_used(triangles.cols(), 1);
  const Eigen::AlignedBox3d box = FocusOnLargest(positions, triangles, &is_used);
  const double longest = box.sizes().maxCoeff();
  if (!(longest > 0) || !std::isfinite(longest)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the surface has no extent (longest side ", longest, ")"));
  }
  PLEAT_RETURN_IF_ERROR(progress.Report(.2));
  const VoxelGrid grid = VoxelGrid::Around(box, options.resolution,
                                           std::max({1, options.max_growth, options.growth}) + 2);
  outer.spacing = grid.spacing;
  const Solid solid = CloseGaps(grid, RasterizeTriangles(grid, positions, triangles, is_used),
                                options, &outer.growth);
  PLEAT_RETURN_IF_ERROR(progress.Report(.8));
  ExtractSurface(grid, solid.largest, &outer.positions, &outer.triangles);
  if (outer.triangles.cols() == 0) {
    return absl::FailedPreconditionError("the surface encloses nothing");
  }
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return outer;
}

}  // namespace pleat
