// Block descent over four kinds of unknowns, each block with a closed form or a small solver of its
// own:
//
//   poses          MinimizePose, frame by frame, from where they are        pose_solvers.cpp
//   rest joints    one linear system of 3J unknowns over all frames         joint_step.cpp
//   weights        a quadratic program of at most 16 unknowns per vertex    vertex_step.cpp
//   rest mesh      a 3 x 3 system per vertex                                vertex_step.cpp
//
// What is alternated follows from what is linear in what. Skinned vertices are linear in the world
// rotations, in the joints, in the weights and in the rest positions, each for itself, and in no
// two of them together. Solving one block is therefore a least-squares problem, and the blocks that
// share their sums share their moments: the rig and frame moments (moments.h) do not depend on the
// joints, so poses and joints are solved without a look at the vertices, while the steps per vertex
// need the frames, once, as one matrix product.
//
// The order within a round:
//
// 1. Moments, since the last round has changed weights and rest mesh; poses with them. The error
//    here is that of the rig as the round finds it (round_rms_m).
// 2. Joints, then poses again. The joint step lets each frame's translation go free, so the poses
//    that were solved before do not fit the new joints, and the step after it takes poses as given.
// 3. Weights, then rest mesh, both from one set of sums with the poses held. Weights come first:
//    with the wrong bones a rest position would move to hide the error.
//
// Every step also pulls its unknowns towards the *first* rig, not to that of the last round. So
// pulls do not add up to a drift, and what the motion does not show stays where it was, however
// many rounds there are. Five rounds are enough: more lower the error of the fit but not that of
// unseen frames (docs/method/fit.md#what-was-tried).
//
// Frames are worked on in parallel, each writes only its own entries, and sums over frames are
// taken afterwards in the order of frames, so that the number of threads does not show in the
// result.

#include "pleat/fitting/rig_refinement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "input_check.h"
#include "joint_step.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/fitting/moments.h"
#include "pleat/fitting/pose_energy.h"
#include "pleat/fitting/pose_solvers.h"
#include "pleat/math/spread_rows.h"
#include "pleat/mesh/adjacency.h"
#include "vertex_step.h"

namespace pleat {
namespace {

class RigRefiner {
 public:
  RigRefiner(const MeshSequence& sequence, const Rig& rig, const PoseTrack& track,
             const RigRefinementOptions& options)
      : sequence_(sequence), first_(rig), options_(options), rig_(rig) {
    for (const Eigen::Index row : SpreadRows(sequence.num_frames(), options.max_frames)) {
      const int t = static_cast<int>(row);
      const Eigen::Vector3d center = sequence.frame(t).cast<double>().rowwise().mean();
      frames_.push_back(t);
      centers_.push_back(center);
      poses_.push_back(ToChainPose(rig.skeleton, track.pose(t), center));
    }
    moments_.resize(frames_.size());
    energies_.resize(frames_.size());
  }

  // summary: may be null.
  absl::StatusOr<Rig> Run(RigRefinementSummary* summary, const Progress& progress) {
    const VertexAdjacency adjacency(sequence_.topology());
    for (int round = 0; round < options_.num_rounds; ++round) {
      const Progress part =
          progress.Stage("refine", static_cast<double>(round) / (options_.num_rounds + 1),
                         (round + 1.0) / (options_.num_rounds + 1));
      PLEAT_RETURN_IF_ERROR(UpdateMoments(part.Stage("refine", 0, .2)));
      PLEAT_RETURN_IF_ERROR(SolvePoses(part.Stage("refine", .2, .4)));
      if (summary != nullptr) summary->round_rms_m.push_back(Rms());
      if (options_.joints) {
        PLEAT_RETURN_IF_ERROR(StepJoints(part.Stage("refine", .4, .5)));
        PLEAT_RETURN_IF_ERROR(SolvePoses(part.Stage("refine", .5, .6)));
      }
      if (options_.weights || options_.rest) {
        PLEAT_RETURN_IF_ERROR(StepVertices(adjacency, part.Stage("refine", .6, 1)));
      }
    }
    // The poses of the last rig are asked for by the summary alone: who wants them fits all frames.
    if (summary == nullptr) {
      PLEAT_RETURN_IF_ERROR(progress.Stage("refine", 0, 1).Report(1));
      return rig_;
    }
    const Progress part =
        progress.Stage("refine", options_.num_rounds / (options_.num_rounds + 1.0), 1);
    PLEAT_RETURN_IF_ERROR(UpdateMoments(part.Stage("refine", 0, .5)));
    PLEAT_RETURN_IF_ERROR(SolvePoses(part.Stage("refine", .5, 1)));
    Summarize(summary);
    return rig_;
  }

 private:
  absl::Status ForFrames(const Progress& progress, const std::function<void(int)>& body) {
    ParallelFor(static_cast<int>(frames_.size()), options_.num_threads, [&](int f) {
      if (!progress.cancelled()) body(f);
    });
    return progress.Report(1);
  }

  // Call this after a change of weights or rest mesh.
  absl::Status UpdateMoments(const Progress& progress) {
    rig_moments_ = ComputeRigMoments(rig_);
    return ForFrames(progress, [&](int f) {
      moments_[f] = ComputeFrameMoments(rig_, rig_moments_, sequence_.frame(frames_[f]));
    });
  }

  absl::Status SolvePoses(const Progress& progress) {
    const ChainMoments chain = ComputeChainMoments(rig_moments_, rig_.skeleton);
    const PoseEnergy shared_energy(
        chain, rig_.skeleton,
        options_.bend_stiffness * chain.gram.trace() / (3 * chain.num_joints));
    return ForFrames(progress, [&](int f) {
      PoseEnergy energy = shared_energy;
      energy.SetFrame(ComputeChainCross(rig_moments_, moments_[f], rig_.skeleton),
                      moments_[f].sum_squares);
      MinimizePose(energy, {.max_iterations = options_.max_iterations}, &poses_[f]);
      energies_[f] = std::max(0.0, energy.DataValue(poses_[f]));
    });
  }

  double Rms() const {
    double sum = 0;
    for (const double energy : energies_) sum += energy;
    return std::sqrt(sum / (rig_moments_.num_vertices * static_cast<double>(frames_.size())));
  }

  absl::Status StepJoints(const Progress& progress) {
    const SubtreeMoments subtree = ComputeSubtreeMoments(rig_moments_, rig_.skeleton);
    std::vector<JointSystem> systems(frames_.size());
    PLEAT_RETURN_IF_ERROR(ForFrames(progress, [&](int f) {
      systems[f] = ComputeJointSystem(rig_moments_, subtree, rig_.skeleton, moments_[f], poses_[f]);
    }));
    rig_.skeleton = rig_.skeleton.WithRestPositions(
        SolveJoints(systems, rig_moments_, rig_.skeleton, first_.skeleton.RestPositions(),
                    options_.joint_prior, options_.locked_joints));
    return absl::OkStatus();
  }

  absl::Status StepVertices(const VertexAdjacency& adjacency, const Progress& progress) {
    PLEAT_ASSIGN_OR_RETURN(
        const VertexMoments moments,
        ComputeVertexMoments(sequence_, frames_, poses_, centers_, rig_, options_.num_threads,
                             progress.Stage("refine", 0, .4)));
    if (options_.weights) {
      const WeightStepOptions step{.smoothness = options_.weight_smoothness,
                                   .prior = options_.weight_prior,
                                   .max_influences = options_.max_influences,
                                   .num_threads = options_.num_threads};
      PLEAT_ASSIGN_OR_RETURN(rig_.weights, RefineWeights(moments, rig_, first_.weights, adjacency,
                                                         step, progress.Stage("refine", .4, .9)));
    }
    if (options_.rest) {
      const RestStepOptions step{.smoothness = options_.rest_smoothness,
                                 .prior = options_.rest_prior,
                                 .num_threads = options_.num_threads};
      PLEAT_ASSIGN_OR_RETURN(rig_.rest_positions,
                             RefineRestPositions(moments, rig_, first_.rest_positions, adjacency,
                                                 step, progress.Stage("refine", .9, 1)));
    }
    return absl::OkStatus();
  }

  void Summarize(RigRefinementSummary* summary) const {
    summary->rms_m = Rms();
    const Eigen::Matrix3Xd moved = rig_.skeleton.RestPositions() - first_.skeleton.RestPositions();
    for (Eigen::Index j = 0; j < moved.cols(); ++j) {
      summary->joint_moved_m.push_back(moved.col(j).norm());
    }
    summary->mean_weight_change =
        (rig_.weights.ToDense() - first_.weights.ToDense()).cwiseAbs().rowwise().sum().mean() / 2;
    summary->rest_moved_m =
        std::sqrt((rig_.rest_positions - first_.rest_positions).colwise().squaredNorm().mean());
  }

  const MeshSequence& sequence_;
  const Rig& first_;
  const RigRefinementOptions& options_;
  Rig rig_;  // as refined so far
  // The frames that are used and what belongs to each of them, in that order.
  std::vector<int> frames_;
  std::vector<Eigen::Vector3d> centers_;
  std::vector<ChainPose> poses_;
  std::vector<FrameMoments> moments_;
  std::vector<double> energies_;  // square meters, of the data
  RigMoments rig_moments_;
};

absl::Status CheckInput(const MeshSequence& sequence, const Rig& rig, const PoseTrack& track,
                        const RigRefinementOptions& options) {
  PLEAT_RETURN_IF_ERROR(CheckRigOfSequence("rig refinement", sequence, rig));
  PLEAT_RETURN_IF_ERROR(CheckTrackOfSequence("rig refinement", sequence, rig, track));
  for (const int j : options.locked_joints) {
    if (j < 0 || j >= rig.skeleton.num_joints()) {
      return absl::InvalidArgumentError(absl::StrCat("rig refinement: locked joint ", j, " of ",
                                                     rig.skeleton.num_joints(), " joints"));
    }
  }
  if (options.max_influences < 1 || options.max_influences > kMaxInfluences) {
    return absl::InvalidArgumentError(absl::StrCat("rig refinement: max_influences (",
                                                   options.max_influences, ") must be 1 to ",
                                                   kMaxInfluences));
  }
  const double smallest_pull =
      std::min({options.weight_smoothness, options.weight_prior, options.rest_smoothness,
                options.rest_prior},
               [](double a, double b) { return std::isnan(a) || a < b; });  // a NaN is the smallest
  if (!(options.joint_prior > 0) || !(smallest_pull >= 0) || options.num_rounds < 1 ||
      options.max_frames < 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("rig refinement: joint_prior (", options.joint_prior, "), num_rounds (",
                     options.num_rounds, ") and max_frames (", options.max_frames,
                     ") must be positive, the pulls (least: ", smallest_pull, ") not negative"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Rig> RefineRig(const MeshSequence& sequence, const Rig& rig, const PoseTrack& track,
                              const RigRefinementOptions& options, RigRefinementSummary* summary,
                              const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckInput(sequence, rig, track, options));
  RigRefinementSummary result;
  PLEAT_ASSIGN_OR_RETURN(
      Rig refined,
      RigRefiner(sequence, rig, track, options).Run(summary ? &result : nullptr, progress));
  if (summary != nullptr) *summary = std::move(result);
  return refined;
}

}  // namespace pleat
