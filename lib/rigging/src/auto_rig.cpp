#include "pleat/rigging/auto_rig.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "pleat/base/status.h"
#include "pleat/mesh/bounds.h"
#include "pleat/rigging/body_volume.h"
#include "pleat/skeleton/human_template.h"
#include "rest_frame.h"

namespace pleat {
namespace {

constexpr double kOtherFacingDegrees = 60;  // nearer facings agree about left and right
// Evidence of at most kContraryEvidence turns the character round. Below kWeakEvidence the report
// says that the front is unknown, and from kClearEvidence on the residuals of other facings are no
// reason for doubt.
constexpr double kContraryEvidence = -.4, kWeakEvidence = .1, kClearEvidence = .8;
// What fits worse than kDoubtfulResidual, or only tentatively, must have at least this evidence of
// human feet or knees: most beasts on their hind legs have not.
constexpr double kHumanEvidence = .4;
constexpr double kSoupShare = .05;  // components per triangle: few triangles have a neighbor
constexpr Eigen::Index kManyVertices = 50'000;
constexpr double kUpCosine = .9;  // 26 degrees: a character that leans is no reason for a warning

FacingEvidence EvidenceOf(const MeshSequence& sequence, const BodyShell& shell,
                          const FrameEmbedding& found) {
  const double yaw = found.embedding.yaw_degrees * std::numbers::pi / 180;
  const Eigen::Matrix3d input_from_upright = found.upright_from_input.transpose();
  return WeighFacing(
      sequence, shell,
      {.frame = found.frame,
       .joints = found.embedding.joints,
       .forward = input_from_upright * Eigen::Vector3d(std::sin(yaw), 0, std::cos(yaw)),
       .up = input_from_upright.col(1)});
}

// Turns the character round when feet and knees speak against the facing that the search found and
// for the opposite one. A yaw that the user gives is never turned. Only kCancelled is an error.
absl::Status CheckFacing(const MeshSequence& sequence, const AutoRigOptions& options,
                         FrameEmbedding* found, AutoRigSummary* summary, const Progress& progress) {
  // A hem is no foot, and cloth that swings no knee.
  if (found->embedding.has_hidden_legs) return absl::OkStatus();
  const BodyShell shell{found->volume->WorldFromUnit(found->volume->body->shell.positions),
                        found->volume->body->shell.triangles};
  summary->evidence = EvidenceOf(sequence, shell, *found);
  if (options.yaw_degrees || !options.placed_joints.empty() ||
      summary->evidence.total() > kContraryEvidence) {
    return absl::OkStatus();
  }
  EmbeddingOptions embedding = options.embedding;
  embedding.upright_from_input = found->upright_from_input;
  embedding.yaws_degrees = {std::fmod(found->embedding.yaw_degrees + 180, 360)};
  embedding.search.max_bound = std::min(embedding.search.max_bound, options.refused_residual);
  absl::StatusOr<Embedding> opposite = EmbedSkeleton(*found->volume, embedding, progress);
  if (absl::IsCancelled(opposite.status())) return opposite.status();
  if (!opposite.ok() || opposite->residual > options.refused_residual) return absl::OkStatus();
  FrameEmbedding turned{.frame = found->frame,
                        .volume = found->volume,
                        .upright_from_input = found->upright_from_input,
                        .embedding = *std::move(opposite),
                        .is_tentative = found->is_tentative};
  const FacingEvidence evidence = EvidenceOf(sequence, shell, turned);
  if (evidence.total() < summary->evidence.total()) return absl::OkStatus();
  summary->evidence = evidence;
  summary->is_turned_by_evidence = true;
  found->embedding = std::move(turned.embedding);
  return absl::OkStatus();
}

// Refuses what fits badly, or only tentatively, and has neither the feet nor the knees of a human.
absl::Status ConfirmHuman(const MeshSequence& sequence, const AutoRigOptions& options,
                          const FrameEmbedding& found, const FacingEvidence& evidence) {
  if (options.yaw_degrees || !options.placed_joints.empty()) return absl::OkStatus();
  if (!found.is_tentative && found.embedding.residual <= kDoubtfulResidual) return absl::OkStatus();
  if (evidence.total() >= kHumanEvidence) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrFormat(
      "%s does not look like one standing human: the skeleton fits frame %d with a residual of "
      "%.3f, and neither feet nor knees are those of a human; %s",
      sequence.name(), found.frame, found.embedding.residual, kRigAdvice));
}

absl::Status CheckOptions(const MeshSequence& sequence, const AutoRigOptions& options) {
  if (options.rest_frame < -1 || options.rest_frame >= sequence.num_frames()) {
    return absl::InvalidArgumentError(absl::StrCat("rest frame ", options.rest_frame,
                                                   " is not one of the ", sequence.num_frames(),
                                                   " frames of ", sequence.name()));
  }
  for (const PlacedJoint& placed : options.placed_joints) {
    if (placed.joint < 0 || placed.joint >= kNumHumanJoints || !placed.position.allFinite()) {
      return absl::InvalidArgumentError(
          "a placed joint must be one of the template's, at a finite "
          "position");
    }
  }
  if (options.yaw_degrees && !std::isfinite(*options.yaw_degrees)) {
    return absl::InvalidArgumentError("the facing (yaw) must be a finite number of degrees");
  }
  return absl::OkStatus();
}

void WarnOfFacing(const Embedding& embedding, const AutoRigOptions& options,
                  AutoRigSummary* summary) {
  const double total = summary->evidence.total();
  if (total <= kContraryEvidence) {
    summary->warnings.push_back(absl::StrFormat(
        "feet and knees speak against the facing of %.0f degrees: look at the rig, and set the yaw "
        "if left and right are swapped",
        embedding.yaw_degrees));
  } else if (total < kWeakEvidence) {
    summary->warnings.push_back(absl::StrFormat(
        "neither feet nor knees show where the character faces: check that %.0f degrees is its "
        "front, and set the yaw if left and right are swapped",
        embedding.yaw_degrees));
  }
  if (total >= kClearEvidence) return;
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
}

void WarnOfSurface(AutoRigSummary* summary) {
  const SurfaceReport& surface = summary->surface;
  if (!summary->stray_parts.empty()) {
    constexpr size_t kMostNamed = 8;
    const size_t num_named = std::min(summary->stray_parts.size(), kMostNamed);
    summary->warnings.push_back(absl::StrCat(
        summary->stray_parts.size(),
        " part(s) float beside the body and were left out of the skeleton's search, of ",
        absl::StrJoin(summary->stray_parts.begin(), summary->stray_parts.begin() + num_named, ", "),
        num_named < summary->stray_parts.size() ? ", ..." : "", " vertices"));
  }
  if (surface.closed() && surface.num_components <= 1 && surface.num_flipped_triangles == 0) return;
  summary->warnings.push_back(absl::StrFormat(
      "the mesh is not one clean closed surface: %d components, %d boundary edges, %d "
      "non-manifold edges, %d triangles oriented inward, %d degenerate triangles, %d "
      "unreferenced vertices",
      surface.num_components, surface.num_boundary_edges, surface.num_non_manifold_edges,
      surface.num_flipped_triangles, surface.num_degenerate_triangles,
      surface.num_unreferenced_vertices));
}

void FillSummary(const FrameEmbedding& found, const AutoRigOptions& options,
                 AutoRigSummary* summary) {
  const Embedding& embedding = found.embedding;
  summary->rest_frame = found.frame;
  summary->yaw_degrees = embedding.yaw_degrees;
  summary->up = found.upright_from_input.row(1).transpose();
  summary->residual = embedding.residual;
  summary->facings = embedding.facings;
  summary->num_spheres = embedding.num_spheres;
  if (embedding.residual >= options.trusted_residual) {
    summary->warnings.push_back(absl::StrFormat(
        "the skeleton fits frame %d with a residual of %.3f, above %.3f: look at the rig, and %s "
        "if it is wrong",
        found.frame, embedding.residual, options.trusted_residual, kRigAdvice));
  }
  if (embedding.has_short_arm) {
    summary->warnings.push_back(absl::StrFormat(
        "an arm seems to end early in frame %d, as one does that is folded against the body: look "
        "at the rig, and %s if it is wrong",
        found.frame, kRigAdvice));
  }
  if (embedding.has_hidden_legs) {
    summary->warnings.emplace_back(
        "clothes hide the legs down to the floor: hips and legs have the proportions of a "
        "template; "
        "place what you know (pleat rig --at leftFoot=x,y,z)");
  }
  if (summary->up.y() < kUpCosine) {
    summary->warnings.push_back(absl::StrFormat(
        "the character's head points along (%.2f, %.2f, %.2f) instead of +y in frame %d: it is "
        "rigged as it is; turn the input to Y up if it should stand",
        summary->up.x(), summary->up.y(), summary->up.z(), found.frame));
  }
  WarnOfFacing(embedding, options, summary);
}

// Solves the heat weights of the rest frame and reports its surface. They are solved on the
// vertices themselves, but on the shell for what hardly hangs together (soup), where no heat would
// flow, and for very many vertices.
absl::StatusOr<SkinWeights> WeighVertices(const FrameEmbedding& found, const Topology& topology,
                                          const Eigen::Matrix3Xd& rest,
                                          const AutoRigOptions& options, AutoRigSummary* summary,
                                          const Progress& progress) {
  const BodyVolume& volume = *found.volume;
  const BodyShell& shell = volume.body->shell;
  const Eigen::Matrix3Xd unit_rest = volume.UnitFromWorld(rest);
  const Eigen::Matrix3Xd unit_joints = volume.UnitFromWorld(found.embedding.joints);
  PLEAT_ASSIGN_OR_RETURN(const SolidSurface surface, PrepareSolidSurface(topology, unit_rest));
  summary->surface = surface.report;
  summary->stray_parts = StrayParts(surface, volume.field);
  HeatWeightsOptions heat = options.heat;
  heat.num_threads = options.num_threads;
  heat.surface_tolerance = volume.body->shell_spacing;
  heat.body_diagonal = BoundsDiagonal(shell.positions);
  const InsideTest inside{volume.body->tree.get(), volume.body->winding_number.get(),
                          &volume.field};
  const bool is_soup = surface.report.num_components > kSoupShare * surface.triangles.cols();
  if (is_soup || rest.cols() > kManyVertices) {
    SolidSurface whole{.positions = shell.positions,
                       .triangles = shell.triangles,
                       .vertex_from_input = {},
                       .triangle_components = std::vector<int>(shell.triangles.cols(), 0),
                       .report = {}};
    whole.report.num_components = 1;
    PLEAT_ASSIGN_OR_RETURN(const Eigen::MatrixXd weights,
                           SolveHeatEquilibrium(whole, inside, HumanTemplate(), unit_joints, heat,
                                                &summary->heat, progress));
    return WeightsFromShell(shell, *volume.body->tree, weights, unit_rest, options.num_threads);
  }
  PLEAT_ASSIGN_OR_RETURN(const Eigen::MatrixXd weights,
                         SolveHeatEquilibrium(surface, inside, HumanTemplate(), unit_joints, heat,
                                              &summary->heat, progress));
  return WeightsOfInput(surface, weights, unit_rest, HumanTemplate(), unit_joints);
}

}  // namespace

absl::StatusOr<Rig> AutoRig(const MeshSequence& sequence, const AutoRigOptions& options,
                            AutoRigSummary* summary, const Progress& progress) {
  AutoRigSummary local_summary;
  if (!summary) summary = &local_summary;
  *summary = {};
  PLEAT_RETURN_IF_ERROR(CheckOptions(sequence, options));
  PLEAT_ASSIGN_OR_RETURN(FrameEmbedding found,
                         FindRestFrame(sequence, options, summary, progress.Stage("rig", 0, .7)));
  PLEAT_RETURN_IF_ERROR(CheckFacing(sequence, options, &found, summary, progress));
  PLEAT_RETURN_IF_ERROR(ConfirmHuman(sequence, options, found, summary->evidence));
  FillSummary(found, options, summary);

  const Skeleton skeleton = HumanTemplate().WithRestPositions(found.embedding.joints);
  const Eigen::Matrix3Xd rest = sequence.FrameAsDouble(found.frame);
  PLEAT_ASSIGN_OR_RETURN(SkinWeights weights,
                         WeighVertices(found, sequence.topology(), rest, options, summary,
                                       progress.Stage("rig", .7, 1)));
  WarnOfSurface(summary);
  return Rig{skeleton, std::move(weights), rest};
}

}  // namespace pleat
