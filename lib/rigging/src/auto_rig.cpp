#include "pleat/rigging/auto_rig.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "pleat/base/status.h"
#include "pleat/rigging/body_volume.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

constexpr double kOtherFacingDegrees = 60;  // nearer facings agree about left and right
constexpr char kWhatToDo[] =
    "choose another rest frame, one that stands upright with arms and legs apart, or bring your "
    "own rig";

struct FrameEmbedding {
  int frame = -1;
  BodyVolume volume;
  Embedding embedding;
};

// The frames to look at, best guess first.
std::vector<int> FramesToTry(int num_frames, const AutoRigOptions& options) {
  if (options.rest_frame >= 0) return {options.rest_frame};
  const int count = std::clamp(options.max_frames_tried, 1, num_frames);
  std::vector<int> frames;
  for (int k = 0; k < count; ++k) {
    frames.push_back(static_cast<int>(static_cast<int64_t>(k) * num_frames / count));
  }
  return frames;
}

absl::StatusOr<FrameEmbedding> EmbedFrame(const MeshSequence& sequence, int frame,
                                          const AutoRigOptions& options, const Progress& progress) {
  FrameEmbedding result;
  result.frame = frame;
  BodyVolumeOptions volume_options = options.volume;
  volume_options.num_threads = options.num_threads;
  PLEAT_ASSIGN_OR_RETURN(result.volume,
                         ComputeBodyVolume(sequence.topology(), sequence.FrameAsDouble(frame),
                                           volume_options, progress.Stage("rig", 0, .7)));
  EmbeddingOptions embedding_options = options.embedding;
  if (options.yaw_degrees) {
    embedding_options.yaws_degrees = {*options.yaw_degrees};
    embedding_options.adjust_yaw = false;
  }
  PLEAT_ASSIGN_OR_RETURN(result.embedding, EmbedSkeleton(result.volume, embedding_options,
                                                         progress.Stage("rig", .7, 1)));
  return result;
}

// The first frame whose embedding is trusted, else the best of all tried.
absl::StatusOr<FrameEmbedding> FindRestFrame(const MeshSequence& sequence,
                                             const AutoRigOptions& options, AutoRigSummary* summary,
                                             const Progress& progress) {
  FrameEmbedding best;
  best.embedding.residual = std::numeric_limits<double>::infinity();
  absl::Status failure;
  const std::vector<int> frames = FramesToTry(sequence.num_frames(), options);
  for (size_t k = 0; k < frames.size(); ++k) {
    absl::StatusOr<FrameEmbedding> tried =
        EmbedFrame(sequence, frames[k], options,
                   progress.Stage("rig", static_cast<double>(k) / frames.size(),
                                  static_cast<double>(k + 1) / frames.size()));
    ++summary->num_frames_tried;
    if (absl::IsCancelled(tried.status())) return tried.status();
    if (!tried.ok()) {
      if (failure.ok()) failure = tried.status();
      continue;
    }
    if (tried->embedding.residual < best.embedding.residual) best = *std::move(tried);
    if (best.embedding.residual < options.trusted_residual) break;
  }
  if (best.frame < 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("no frame of ", sequence.name(), " (", summary->num_frames_tried,
                     " tried) can be rigged: ", failure.message(), "; ", kWhatToDo));
  }
  if (best.embedding.residual > options.refused_residual) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "%s does not look like one standing human: in the best of %d frames, frame %d, the "
        "skeleton "
        "fits with a residual of %.3f, above %.3f (%.0f %% of the surface is far from every "
        "bone); %s",
        sequence.name(), summary->num_frames_tried, best.frame, best.embedding.residual,
        options.refused_residual, 100 * best.embedding.uncovered_share, kWhatToDo));
  }
  return best;
}

absl::Status CheckOptions(const MeshSequence& sequence, const AutoRigOptions& options) {
  if (options.rest_frame < -1 || options.rest_frame >= sequence.num_frames()) {
    return absl::InvalidArgumentError(absl::StrCat("rest frame ", options.rest_frame,
                                                   " is not one of the ", sequence.num_frames(),
                                                   " frames of ", sequence.name()));
  }
  if (options.yaw_degrees && !std::isfinite(*options.yaw_degrees)) {
    return absl::InvalidArgumentError("the facing (yaw) must be a finite number of degrees");
  }
  return absl::OkStatus();
}

void FillSummary(const FrameEmbedding& found, const AutoRigOptions& options,
                 AutoRigSummary* summary) {
  const Embedding& embedding = found.embedding;
  summary->rest_frame = found.frame;
  summary->yaw_degrees = embedding.yaw_degrees;
  summary->residual = embedding.residual;
  summary->facings = embedding.facings;
  summary->num_spheres = embedding.num_spheres;
  summary->surface = found.volume.surface.report;
  if (embedding.residual >= options.trusted_residual) {
    summary->warnings.push_back(absl::StrFormat(
        "the skeleton fits frame %d with a residual of %.3f, above %.3f: look at the rig, and %s "
        "if it is wrong",
        found.frame, embedding.residual, options.trusted_residual, kWhatToDo));
  }
  for (const FacingResidual& facing : embedding.facings) {
    const double turn = std::remainder(facing.yaw_degrees - embedding.yaw_degrees, 360);
    if (std::abs(turn) < kOtherFacingDegrees ||
        facing.residual - embedding.search_residual >= options.facing_margin) {
      continue;
    }
    summary->warnings.push_back(absl::StrFormat(
        "facing is doubtful: %.0f degrees (residual %.4f) against %.0f degrees (%.4f); set the "
        "yaw if left and right are swapped",
        embedding.yaw_degrees, embedding.search_residual, facing.yaw_degrees, facing.residual));
  }
  const SurfaceReport& surface = summary->surface;
  if (surface.num_boundary_edges > 0 || surface.num_nonmanifold_edges > 0 ||
      surface.num_components > 1 || surface.num_flipped_triangles > 0) {
    summary->warnings.push_back(absl::StrFormat(
        "the mesh is not one clean closed surface: %d components, %d boundary edges, %d "
        "non-manifold edges, %d triangles oriented inward, %d degenerate triangles, %d "
        "unreferenced vertices",
        surface.num_components, surface.num_boundary_edges, surface.num_nonmanifold_edges,
        surface.num_flipped_triangles, surface.num_degenerate_triangles,
        surface.num_unreferenced_vertices));
  }
}

}  // namespace

absl::StatusOr<Rig> AutoRig(const MeshSequence& sequence, const AutoRigOptions& options,
                            AutoRigSummary* summary, const Progress& progress) {
  AutoRigSummary local_summary;
  if (!summary) summary = &local_summary;
  *summary = {};
  PLEAT_RETURN_IF_ERROR(CheckOptions(sequence, options));
  PLEAT_ASSIGN_OR_RETURN(const FrameEmbedding found,
                         FindRestFrame(sequence, options, summary, progress.Stage("rig", 0, .7)));
  FillSummary(found, options, summary);

  const Skeleton skeleton = HumanTemplate().WithRestPositions(found.embedding.joints);
  const BodyVolume& volume = found.volume;
  const Eigen::Matrix3Xd unit_joints =
      (volume.scale * found.embedding.joints).colwise() + volume.offset;
  HeatWeightsOptions heat_options = options.heat;
  heat_options.num_threads = options.num_threads;
  PLEAT_ASSIGN_OR_RETURN(const Eigen::MatrixXd weights,
                         SolveHeatEquilibrium(volume.surface, *volume.tree, *volume.winding_number,
                                              skeleton, unit_joints, heat_options, &summary->heat,
                                              progress.Stage("rig", .7, 1)));
  const Eigen::Matrix3Xd rest = sequence.FrameAsDouble(found.frame);
  PLEAT_ASSIGN_OR_RETURN(
      SkinWeights skin_weights,
      WeightsOfInput(volume.surface, weights, rest, skeleton, found.embedding.joints));
  return Rig{skeleton, std::move(skin_weights), rest};
}

}  // namespace pleat
