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
constexpr int kManyTriangles = 100'000;
// A clean surface has at most this share of its area inside of itself (hands on hips), which is
// looked at in so many triangles.
constexpr double kMostBuried = .01;
constexpr int kNumProbes = 2000;

// Returns the share of the area of the shell whose outer side lies inside of it.
double BuriedShare(const BodySurface& body) {
  const BodyShell& shell = body.shell;
  const double step = 1e-4 * BoundsDiagonal(shell.positions);
  const int stride = std::max(1, static_cast<int>(shell.triangles.cols()) / kNumProbes);
  double total = 0, buried = 0;
  for (int f = 0; f < shell.triangles.cols(); f += stride) {
    const Eigen::Vector3d a = shell.positions.col(shell.triangles(0, f));
    const Eigen::Vector3d b = shell.positions.col(shell.triangles(1, f));
    const Eigen::Vector3d c = shell.positions.col(shell.triangles(2, f));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double area = normal.norm();
    total += area;
    if (body.winding_number->IsInside((a + b + c) / 3 + step / area * normal)) buried += area;
  }
  return buried / total;
}

// Scales the shell into the unit box and prepares to ask it for distances and sides.
void FitUnitBox(BodySurface* body) {
  const Eigen::AlignedBox3d box = ComputeBounds(body->shell.positions);
  body->scale = kLongestSide / box.sizes().maxCoeff();
  body->offset = Eigen::Vector3d::Constant(0.5) - body->scale * box.center();
  body->shell_spacing *= body->scale;
  body->shell.positions = (body->scale * body->shell.positions).colwise() + body->offset;
  body->tree = std::make_shared<const TriangleTree>(body->shell.positions, body->shell.triangles);
  body->winding_number = std::make_shared<const WindingNumber>(*body->tree);
}

absl::Status EnclosesNoVolume(const std::string& depth) {
  return absl::FailedPreconditionError(absl::StrCat("the mesh encloses no volume", depth,
                                                    ": close its surface or bring your own rig"));
}

// Makes the outer surface of a mesh the shell.
absl::Status Repair(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                    const Eigen::Matrix3Xi& triangles, const BodyVolumeOptions& options,
                    BodySurface* body, const Progress& progress) {
  absl::StatusOr<OuterSurface> outer =
      ComputeOuterSurface(positions, triangles, options.outer, progress);
  if (absl::IsFailedPrecondition(outer.status())) return EnclosesNoVolume("");
  PLEAT_RETURN_IF_ERROR(outer.status());
  body->shell = {std::move(outer->positions), std::move(outer->triangles)};
  body->is_repaired = body->is_closed = true;
  body->growth = outer->growth;
  body->shell_spacing = outer->spacing;
  FitUnitBox(body);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<BodySurface> PrepareBodySurface(const Topology& topology,
                                               const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                               const BodyVolumeOptions& options,
                                               const Progress& progress) {
  BodySurface body;
  if (topology.num_triangles() > kManyTriangles) {
    PLEAT_RETURN_IF_ERROR(Repair(positions, topology.triangles(), options, &body, progress));
    return body;
  }
  PLEAT_ASSIGN_OR_RETURN(const SolidSurface surface, PrepareSolidSurface(topology, positions));
  // Holes do not matter: the winding number closes them better than voxels do where one surface
  // does not overlap itself.
  if (surface.report.num_components == 1) {
    body.shell = {surface.positions, surface.triangles};
    body.is_closed = surface.report.closed();
    FitUnitBox(&body);
    if (BuriedShare(body) <= kMostBuried) return body;
  }
  PLEAT_RETURN_IF_ERROR(Repair(surface.positions, surface.triangles, options, &body, progress));
  return body;
}

absl::StatusOr<BodyVolume> ComputeBodyVolume(std::shared_ptr<const BodySurface> body,
                                             const BodyVolumeOptions& options,
                                             const Progress& progress) {
  BodyVolume volume;
  volume.body = std::move(body);
  DistanceFieldOptions field_options;
  field_options.resolution = options.resolution;
  field_options.num_threads = options.num_threads;
  field_options.is_closed = volume.body->is_closed;
  PLEAT_ASSIGN_OR_RETURN(volume.field,
                         DistanceField::Compute(*volume.body->tree, *volume.body->winding_number,
                                                field_options, progress));
  MedialSampleOptions sample_options;
  sample_options.min_depth = options.min_depth;
  volume.medial_samples = FindMedialSamples(volume.field, sample_options);
  if (volume.medial_samples.empty()) {
    return EnclosesNoVolume(
        absl::StrCat(" deeper than ", options.min_depth / volume.body->scale, " m"));
  }
  volume.graph = SphereGraph(PackSpheres(volume.medial_samples, options.max_spheres), volume.field)
                     .LargestGroup();
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
