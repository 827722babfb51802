// The details of a training run are a matrix of T x 3V numbers in double precision, which for
// thousands of frames does not fit into memory. Hence this order, in ComputeControlDetails:
//
//   1. The details of at most kMaxBasisFrames frames, evenly spread over the sequence, are computed
//      at once. Where the upsampling is refined, they are those of all vertices: it learns from
//      them, and only those of the control vertices are kept. Their principal components are the
//      basis.
//   2. When there are more frames, that matrix is freed, and ProjectAllFrames expresses all frames
//      in the basis, one block after the other. A block is gone when its scores (T x r) are known.
//
// A detail depends on its own frame and pose only, so frames may be taken in any selection. Short
// sequences end after the first step, with the scores that the principal components gave. Results
// do not depend on the number of threads: work is cut into items of a fixed size, and no sum
// crosses from one item to another.
#include "training_steps.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "detail_regions.h"
#include "option_values.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/fitting/fit_weights.h"
#include "pleat/fitting/rig_refinement.h"
#include "pleat/geometry/control_mesh.h"
#include "pleat/math/spread_rows.h"
#include "pleat/skeleton/pose_history.h"

namespace pleat {
namespace {

constexpr int kWideningRounds = 3;    // of rig refinement, with all influences
constexpr int kMaxBridgedFrames = 2;  // held-out frames in a row between two training frames

// Returns an error that says how topology `b` of the clip `name` differs from `a`.
absl::Status ConnectivityDiffers(const std::string& name, const Topology& a, const Topology& b) {
  if (a.num_vertices() != b.num_vertices() || a.num_faces() != b.num_faces()) {
    return absl::InvalidArgumentError(
        absl::StrCat("clip '", name, "' has ", b.num_vertices(), " vertices and ", b.num_faces(),
                     " faces, the first clip has ", a.num_vertices(), " and ", a.num_faces(),
                     "; all clips of a character share one connectivity"));
  }
  int face = 0;
  while (face < a.num_faces() && std::ranges::equal(a.face(face), b.face(face))) ++face;
  return absl::InvalidArgumentError(
      absl::StrCat("clip '", name, "' differs from the first clip at face ", face,
                   "; all clips of a character share one connectivity"));
}

// Makes the interpolation from the control vertices to all vertices, by radial basis functions on
// the rest pose.
absl::StatusOr<RbfUpsampler> MakeUpsampler(const RiggedFrames& rigged,
                                           const std::vector<int>& control_vertices,
                                           const TrainResources& resources,
                                           const Progress& progress) {
  RbfUpsamplingOptions rbf;
  rbf.features = rigged.rig.weights.ToDense().transpose();
  rbf.num_threads = resources.num_threads;
  return RbfUpsampler::Build(rigged.frames.sequence.topology(), rigged.rig.rest_positions,
                             control_vertices, rbf, progress);
}

// The largest number of frames whose details give the basis.
constexpr int kMaxBasisFrames = 1000;

// Computes the details of `vertices` in the frames `frame_indices`, one row per frame.
absl::StatusOr<Eigen::MatrixXd> DetailsOfFrames(const RiggedFrames& rigged, const PoseTrack& track,
                                                const std::vector<int>& frame_indices,
                                                const std::vector<int>& vertices,
                                                const ComputeDetailsOptions& options,
                                                const Progress& progress) {
  return ComputeDetails(rigged.frames.sequence.Subset(frame_indices), rigged.rig,
                        track.Subset(frame_indices), vertices, options, progress);
}

// Refines data->upsampler on the details of all vertices (3V columns), and returns those of the
// control vertices (3C columns).
absl::StatusOr<Eigen::MatrixXd> RefineUpsampler(const Eigen::MatrixXd& details,
                                                const TrainResources& resources,
                                                const Progress& progress, LearningData* data) {
  UpsamplingRefinementOptions refinement;
  refinement.num_threads = resources.num_threads;
  PLEAT_ASSIGN_OR_RETURN(data->upsampler, data->upsampler->Refine(details, data->control_vertices,
                                                                  refinement, progress));
  Eigen::MatrixXd control(details.rows(), 3 * data->control_vertices.size());
  for (size_t c = 0; c < data->control_vertices.size(); ++c) {
    control.middleCols<3>(3 * c) = details.middleCols<3>(3 * data->control_vertices[c]);
  }
  return control;
}

// Computes the scores of all frames in the basis that some of them gave, block by block. The energy
// that the basis keeps is then that of all frames too.
absl::Status ProjectAllFrames(const RiggedFrames& rigged, const PoseTrack& track,
                              const ComputeDetailsOptions& options, const Progress& progress,
                              LearningData* data) {
  constexpr int kBlockFrames = 128;
  PrincipalComponents& details = data->details;
  const int num_frames = track.num_frames();
  details.scores.resize(num_frames, details.basis.cols());
  double energy = 0;
  for (int begin = 0; begin < num_frames; begin += kBlockFrames) {
    std::vector<int> block(std::min(kBlockFrames, num_frames - begin));
    std::iota(block.begin(), block.end(), begin);
    PLEAT_ASSIGN_OR_RETURN(
        Eigen::MatrixXd rows,
        DetailsOfFrames(rigged, track, block, data->control_vertices, options, {}));
    if (data->differential) rows = data->differential->Encode(rows);
    rows.rowwise() -= details.mean.transpose();
    energy += rows.squaredNorm();
    // Items have a fixed size, so that the result does not depend on the number of threads.
    constexpr int kItemFrames = 32;
    const auto num_rows = static_cast<int>(rows.rows());
    ParallelFor((num_rows + kItemFrames - 1) / kItemFrames, options.num_threads, [&](int item) {
      const int first = item * kItemFrames, count = std::min(kItemFrames, num_rows - first);
      details.scores.middleRows(begin + first, count).noalias() =
          rows.middleRows(first, count) * details.basis;
    });
    PLEAT_RETURN_IF_ERROR(progress.Report(double(begin + rows.rows()) / num_frames));
  }
  if (energy > 0) details.kept_energy = std::min(1.0, details.scores.squaredNorm() / energy);
  return absl::OkStatus();
}

// Returns how many components the basis of all details may have: what the regional learner asks
// for, but no more than a gigabyte of them beyond what the options allow.
int MaxFineComponents(const TrainOptions& options, Eigen::Index num_details) {
  constexpr Eigen::Index kMaxBytes = Eigen::Index{1} << 30;
  const Eigen::Index in_memory = kMaxBytes / (static_cast<Eigen::Index>(sizeof(double)) *
                                              std::max<Eigen::Index>(num_details, 1));
  return std::max(options.max_components, static_cast<int>(std::min<Eigen::Index>(
                                              RegionalBasisOptions().max_components, in_memory)));
}

// Fills in the details and the upsampler of `data`, whose control vertices are known. The order is
// explained at the top of this file.
absl::Status ComputeControlDetails(const RiggedFrames& rigged, const PoseTrack& track,
                                   const TrainOptions& options, const TrainResources& resources,
                                   const Progress& progress, LearningData* data) {
  const MeshSequence& sequence = rigged.frames.sequence;
  const bool decimated = static_cast<int>(data->control_vertices.size()) < sequence.num_vertices();
  const bool refined = decimated && options.upsampling == Upsampling::kRefined;
  const ComputeDetailsOptions detail_options{.base = options.deformation,
                                             .axes = options.detail_axes,
                                             .num_threads = resources.num_threads};
  std::vector<int> vertices = data->control_vertices;
  if (refined) {
    vertices.resize(sequence.num_vertices());
    std::iota(vertices.begin(), vertices.end(), 0);
  }
  const int num_frames = sequence.num_frames(), num_basis = std::min(num_frames, kMaxBasisFrames);
  const std::vector<Eigen::Index> spread = SpreadRows(num_frames, num_basis);
  const std::vector<int> basis_frames(spread.begin(), spread.end());
  PLEAT_ASSIGN_OR_RETURN(
      Eigen::MatrixXd details,
      DetailsOfFrames(rigged, track, basis_frames, vertices, detail_options, progress));
  if (decimated) {
    PLEAT_ASSIGN_OR_RETURN(data->upsampler,
                           MakeUpsampler(rigged, data->control_vertices, resources, progress));
  }
  if (refined) {
    PLEAT_ASSIGN_OR_RETURN(details, RefineUpsampler(details, resources, progress, data));
  }
  if (data->differential) details = data->differential->Encode(details);
  data->details = ComputePca(
      details, {.max_components = MaxFineComponents(options, details.cols()), .min_energy = 1});
  if (num_basis == num_frames) return absl::OkStatus();
  details.resize(0, 0);
  return ProjectAllFrames(rigged, track, detail_options, progress, data);
}

}  // namespace

absl::StatusOr<TrainingFrames> JoinClips(const std::vector<MeshSequence>& clips) {
  if (clips.empty()) return absl::InvalidArgumentError("training needs at least one clip");
  std::vector<int> clip_starts, frame_numbers;
  for (const MeshSequence& clip : clips) {
    clip_starts.push_back(static_cast<int>(frame_numbers.size()));
    for (int t = 0; t < clip.num_frames(); ++t) frame_numbers.push_back(t);
  }
  if (clips.size() == 1) {
    return TrainingFrames{clips[0], clip_starts, clips[0].num_frames(), frame_numbers};
  }
  for (const MeshSequence& clip : clips) {
    if (!(clip.topology() == clips[0].topology())) {
      return ConnectivityDiffers(clip.name(), clips[0].topology(), clip.topology());
    }
    if (!(clip.frame_rate() == clips[0].frame_rate())) {
      return absl::InvalidArgumentError(
          absl::StrCat("clip '", clip.name(), "' has ", clip.frame_rate().fps(),
                       " frames per second, the first ", clips[0].frame_rate().fps(),
                       "; give all clips one rate"));
    }
  }
  return TrainingFrames{MeshSequence::Join(clips), std::move(clip_starts), clips[0].num_frames(),
                        std::move(frame_numbers)};
}

absl::StatusOr<RiggedFrames> RigFrames(const TrainingFrames& frames, const TrainOptions& options,
                                       const TrainResources& resources, const Progress& progress) {
  if (options.rest_frame >= frames.num_rig_frames) {
    return absl::InvalidArgumentError(absl::StrCat("rest_frame ", options.rest_frame,
                                                   " is beyond the first clip's ",
                                                   frames.num_rig_frames, " frames"));
  }
  std::vector<int> rig_frames(frames.num_rig_frames);
  std::iota(rig_frames.begin(), rig_frames.end(), 0);
  AutoRigOptions rig_options;
  rig_options.rest_frame = options.rest_frame;
  if (options.yaw_degrees >= 0) rig_options.yaw_degrees = options.yaw_degrees;
  rig_options.placed_joints = options.placed_joints;
  rig_options.num_threads = resources.num_threads;
  AutoRigSummary summary;
  const MeshSequence first_clip = frames.num_rig_frames == frames.sequence.num_frames()
                                      ? frames.sequence
                                      : frames.sequence.Subset(rig_frames);
  PLEAT_ASSIGN_OR_RETURN(Rig rig, AutoRig(first_clip, rig_options, &summary, progress));
  return RiggedFrames{.frames = frames,
                      .rig = std::move(rig),
                      .rig_summary = std::move(summary),
                      .locked_joints = {}};
}

absl::StatusOr<PoseTrack> FitFrames(const MeshSequence& sequence,
                                    const std::vector<int>& clip_starts, const Rig& rig,
                                    const TrainOptions& options, const TrainResources& resources,
                                    PoseFitSummary* summary, const Progress& progress) {
  PoseFitOptions fit;
  fit.method = options.fit;
  fit.clip_starts = clip_starts;
  fit.bend_stiffness = options.bend_stiffness;
  fit.smoothness = options.smoothness;
  fit.num_threads = resources.num_threads;
  return FitPoses(sequence, rig, fit, summary, progress);
}

absl::StatusOr<PoseTrack> FitTrainingFrames(const TrainOptions& options,
                                            const TrainResources& resources, RiggedFrames* rigged,
                                            PoseFitSummary* summary, const Progress& progress) {
  const TrainingFrames& frames = rigged->frames;
  if (options.refine == RigRefinement::kNone) {
    return FitFrames(frames.sequence, frames.clip_starts, rigged->rig, options, resources, summary,
                     progress.Stage("fit", 0, 1));
  }
  PLEAT_ASSIGN_OR_RETURN(const PoseTrack first,
                         FitFrames(frames.sequence, frames.clip_starts, rigged->rig, options,
                                   resources, nullptr, progress.Stage("fit", 0, .2)));
  RigRefinementOptions refinement = options.refine == RigRefinement::kJoints
                                        ? RigRefinementOptions::JointsOnly()
                                        : RigRefinementOptions();
  refinement.locked_joints = rigged->locked_joints;
  refinement.bend_stiffness = options.bend_stiffness;
  refinement.num_threads = resources.num_threads;
  // More bones are taken only when the rig is as good as the standard number makes it, and are then
  // pulled to that rig: from the start they would explain what the joints should.
  const bool widen = options.refine == RigRefinement::kFull;
  refinement.max_influences = std::min(options.influences, kStandardInfluences);
  PLEAT_ASSIGN_OR_RETURN(rigged->rig,
                         RefineRig(frames.sequence, rigged->rig, first, refinement, nullptr,
                                   progress.Stage("refine", .2, widen ? .6 : .8)));
  if (widen) {
    refinement.num_rounds = kWideningRounds;
    refinement.max_influences = options.influences;
    PLEAT_ASSIGN_OR_RETURN(rigged->rig, RefineRig(frames.sequence, rigged->rig, first, refinement,
                                                  nullptr, progress.Stage("refine", .6, .8)));
  }
  if (!widen) {
    return FitFrames(frames.sequence, frames.clip_starts, rigged->rig, options, resources, summary,
                     progress.Stage("fit", .8, 1));
  }
  PLEAT_ASSIGN_OR_RETURN(const PoseTrack refined,
                         FitFrames(frames.sequence, frames.clip_starts, rigged->rig, options,
                                   resources, nullptr, progress.Stage("fit", .8, .9)));
  rigged->rig.fit_weights =
      ComputeFitWeights(frames.sequence, rigged->rig, refined, resources.num_threads);
  return FitFrames(frames.sequence, frames.clip_starts, rigged->rig, options, resources, summary,
                   progress.Stage("fit", .9, 1));
}

Eigen::VectorXd LearningData::DetailOf(const Eigen::VectorXd& scores) const {
  const Eigen::VectorXd detail = details.mean + details.basis * scores;
  return differential ? Eigen::VectorXd(differential->DecodeColumns(detail)) : detail;
}

absl::StatusOr<LearningData> ComputeLearningData(const RiggedFrames& rigged, const PoseTrack& track,
                                                 const TrainOptions& options,
                                                 const TrainResources& resources,
                                                 const Progress& progress) {
  const MeshSequence& sequence = rigged.frames.sequence;
  LearningData data;
  data.clip_starts = track.clip_starts();
  PLEAT_ASSIGN_OR_RETURN(data.control_vertices,
                         SelectControlVertices(sequence.topology(), rigged.rig.rest_positions,
                                               options.resolution_percent / 100));
  if (options.detail_coordinates == DetailCoordinates::kDifferential) {
    PLEAT_ASSIGN_OR_RETURN(data.differential, DifferentialCoordinates::Build(
                                                  sequence.topology(), rigged.rig.rest_positions,
                                                  data.control_vertices));
  }
  PLEAT_RETURN_IF_ERROR(ComputeControlDetails(rigged, track, options, resources, progress, &data));
  const PoseFeatureOptions feature_options = FeatureOptionsOf(options);
  // One or two held-out frames are bridged by interpolation, so that the frame after them has a
  // speed.
  const FilledTrack filled = FillGaps(track, rigged.frames.frame_numbers, kMaxBridgedFrames);
  data.feature_reference = PoseFeatures::Reference(feature_options, track);
  data.features =
      PoseFeatures(feature_options, rigged.rig.skeleton.num_joints(), data.feature_reference)
          .ComputeTrack(filled.track)(filled.rows, Eigen::all);
  data.feature_groups = FeatureGroups(rigged.rig.skeleton.num_joints(), options);
  PLEAT_ASSIGN_OR_RETURN(
      data.regional,
      ComputeRegionalData(sequence.topology(), rigged.rig, track, data.control_vertices,
                          static_cast<int>(data.features.cols()), options, resources.num_threads));
  return data;
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> AssembleModel(
    const RiggedFrames& rigged, const LearningData& data, const TrainOptions& options,
    LearnerChoice learner, std::shared_ptr<const DetailModel> detail_model, double diagonal_m) {
  const MeshSequence& sequence = rigged.frames.sequence;
  CharacterModel::Parts parts{.name = sequence.name(),
                              .frame_rate = sequence.frame_rate(),
                              .topology = sequence.topology(),
                              .appearance = sequence.appearance(),
                              .rig = rigged.rig,
                              .options = options,
                              .feature_reference = data.feature_reference,
                              .control_vertices = data.control_vertices,
                              .upsampler = data.upsampler,
                              .skin_features = {},
                              .detail_model = std::move(detail_model),
                              .record = {}};
  if (learner == LearnerChoice::kRegional) {
    parts.skin_features = data.regional.skin_features;
  } else if (learner == LearnerChoice::kRegionalFast) {
    parts.skin_features = data.regional.WithoutPatches(rigged.rig).skin_features;
  }
  parts.record.learner = ChoiceName(learner);
  parts.record.num_frames = sequence.num_frames();
  parts.record.rest_frame = rigged.rig_summary.rest_frame;
  parts.record.yaw_degrees = rigged.rig_summary.yaw_degrees;
  parts.record.diagonal_m = diagonal_m;
  parts.record.rig_residual = rigged.rig_summary.residual;
  parts.record.warnings = rigged.rig_summary.warnings;
  return CharacterModel::Create(std::move(parts));
}

}  // namespace pleat
