#include "pleat/rigging/body_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/mesh/bounds.h"

namespace pleat {
namespace {

constexpr double kLongestSide = 0.9;
// A surface of so many triangles is replaced by its outer surface even when it is clean, whose
// count follows from the grid.
constexpr int kManyTriangles = 200'000;
// A clean surface has at most this share of its area inside of itself (hands on hips), which is
// looked at in so many triangles.
constexpr double kMostBuried = .01;
constexpr int kNumProbes = 2000;

// Returns the share of the area of `surface` whose outer side lies inside of it.
double BuriedShare(const SolidSurface& surface) {
  const TriangleTree tree(surface.positions, surface.triangles);
  const WindingNumber winding_number(tree);
  const double step = 1e-4 * BoundsDiagonal(surface.positions);
  const int stride = std::max(1, static_cast<int>(surface.triangles.cols()) / kNumProbes);
  double total = 0, buried = 0;
  for (int f = 0; f < surface.triangles.cols(); f += stride) {
    const Eigen::Vector3d a = surface.positions.col(surface.triangles(0, f));
    const Eigen::Vector3d b = surface.positions.col(surface.triangles(1, f));
    const Eigen::Vector3d c = surface.positions.col(surface.triangles(2, f));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double area = normal.norm();
    total += area;
    if (winding_number.IsInside((a + b + c) / 3 + step / area * normal)) buried += area;
  }
  return buried / total;
}

// Holes do not matter: the winding number closes them better than voxels do where one surface does
// not overlap itself.
bool IsCleanSolid(const SolidSurface& surface) {
  return surface.report.num_components == 1 && BuriedShare(surface) <= kMostBuried;
}

absl::Status EnclosesNoVolume(const std::string& depth) {
  return absl::FailedPreconditionError(absl::StrCat("the mesh encloses no volume", depth,
                                                    ": close its surface or bring your own rig"));
}

}  // namespace

absl::StatusOr<BodySurface> PrepareBodySurface(const Topology& topology,
                                               const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                               const BodyVolumeOptions& options,
                                               const Progress& progress) {
  BodySurface body;
  if (topology.num_triangles() <= kManyTriangles) {
    PLEAT_ASSIGN_OR_RETURN(SolidSurface surface, PrepareSolidSurface(topology, positions));
    body.is_repaired = !IsCleanSolid(surface);
    body.shell = {std::move(surface.positions), std::move(surface.triangles)};
  } else {
    body.is_repaired = true;
    body.shell = {positions, topology.triangles()};
  }
  if (body.is_repaired) {
    absl::StatusOr<OuterSurface> outer =
        ComputeOuterSurface(body.shell.positions, body.shell.triangles, options.outer, progress);
    if (absl::IsFailedPrecondition(outer.status())) return EnclosesNoVolume("");
    PLEAT_RETURN_IF_ERROR(outer.status());
    body.shell = {std::move(outer->positions), std::move(outer->triangles)};
    body.growth = outer->growth;
    body.shell_spacing = outer->spacing;
  }
  const Eigen::AlignedBox3d box = ComputeBounds(body.shell.positions);
  body.scale = kLongestSide / box.sizes().maxCoeff();
  body.offset = Eigen::Vector3d::Constant(0.5) - body.scale * box.center();
  body.shell_spacing *= body.scale;
  body.shell.positions = (body.scale * body.shell.positions).colwise() + body.offset;
  return body;
}

absl::StatusOr<BodyVolume> ComputeBodyVolume(std::shared_ptr<const BodySurface> body,
                                             const BodyVolumeOptions& options,
                                             const Progress& progress) {
  BodyVolume volume;
  volume.body = std::move(body);
  const BodyShell& shell = volume.body->shell;
  volume.tree = std::make_unique<const TriangleTree>(shell.positions, shell.triangles);
  volume.winding_number = std::make_unique<const WindingNumber>(*volume.tree);
  DistanceFieldOptions field_options;
  field_options.resolution = options.resolution;
  field_options.num_threads = options.num_threads;
  PLEAT_ASSIGN_OR_RETURN(volume.field, DistanceField::Compute(*volume.tree, *volume.winding_number,
                                                              field_options, progress));
  MedialSampleOptions sample_options;
  sample_options.min_depth = options.min_depth;
  volume.medial_samples = FindMedialSamples(volume.field, sample_options);
  if (volume.medial_samples.empty()) {
    return EnclosesNoVolume(
        absl::StrCat(" deeper than ", options.min_depth / volume.body->scale, " m"));
  }
  return volume;
}

absl::StatusOr<BodyVolume> ComputeBodyVolume(const Topology& topology,
                                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                             const BodyVolumeOptions& options,
                                             const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(BodySurface body,
                         PrepareBodySurface(topology, positions, options, progress));
  return ComputeBodyVolume(std::make_shared<const BodySurface>(std::move(body)), options, progress);
}

std::vector<int> StrayParts(const SolidSurface& surface, const DistanceField& field) {
  // The field is clamped two cells from the surface.
  const double near = 1.9 * field.spacing();
  std::vector<char> is_body(surface.report.num_components, 0);
  std::vector<int> component(surface.positions.cols(), 0);
  for (Eigen::Index f = 0; f < surface.triangles.cols(); ++f) {
    const int c = surface.triangle_components[f];
    for (int k = 0; k < 3; ++k) component[surface.triangles(k, f)] = c;
    if (is_body[c] != 0) continue;
    for (int k = 0; k < 3; ++k) {
      if (field.SignedDistance(surface.positions.col(surface.triangles(k, f))) < near) {
        is_body[c] = 1;
      }
    }
  }
  std::vector<int> counts(surface.report.num_components, 0);
  for (const int vertex : surface.vertex_from_input) {
    if (vertex >= 0) ++counts[component[vertex]];
  }
  std::vector<int> stray;
  for (size_t c = 0; c < counts.size(); ++c) {
    if (is_body[c] == 0 && counts[c] > 0) stray.push_back(counts[c]);
  }
  std::sort(stray.begin(), stray.end(), std::greater<>());
  return stray;
}

}  // namespace pleat
