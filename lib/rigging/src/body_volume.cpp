#include "pleat/rigging/body_volume.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/mesh/bounds.h"

namespace pleat {
namespace {

constexpr double kLongestSide = 0.9;

}  // namespace

absl::StatusOr<BodyVolume> ComputeBodyVolume(const Topology& topology,
                                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                             const BodyVolumeOptions& options,
                                             const Progress& progress) {
  BodyVolume volume;
  PLEAT_ASSIGN_OR_RETURN(volume.surface, PrepareSolidSurface(topology, positions));
  const Eigen::AlignedBox3d box = ComputeBounds(volume.surface.positions);
  volume.scale = kLongestSide / box.sizes().maxCoeff();
  volume.offset = Eigen::Vector3d::Constant(0.5) - volume.scale * box.center();
  volume.surface.positions = (volume.scale * volume.surface.positions).colwise() + volume.offset;
  volume.tree =
      std::make_unique<const TriangleTree>(volume.surface.positions, volume.surface.triangles);
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
    return absl::FailedPreconditionError(
        absl::StrCat("the mesh encloses no volume deeper than ", options.min_depth / volume.scale,
                     " m (", volume.surface.report.num_boundary_edges, " boundary edges, ",
                     volume.surface.report.num_components,
                     " components): close its surface or bring your own rig"));
  }
  return volume;
}

}  // namespace pleat
