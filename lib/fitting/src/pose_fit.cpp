#include "pleat/fitting/pose_fit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

#include "input_check.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/fitting/moments.h"
#include "pleat/fitting/pose_energy.h"
#include "pleat/fitting/pose_solvers.h"

namespace pleat {
namespace {

// The state of a fit, one entry per frame. Parallel loops write only the entry of their own frame
// and read others only where the loop cannot change them (copies of the pass before, or frames of
// the other parity), so the result does not depend on the number of threads.
class PoseFitter {
 public:
  PoseFitter(const MeshSequence& sequence, const Rig& rig, const PoseFitOptions& options)
      : sequence_(sequence),
        rig_(rig),
        options_(options),
        rig_moments_(ComputeRigMoments(rig)),
        chain_(ComputeChainMoments(rig_moments_, rig.skeleton)),
        stiffness_unit_(chain_.gram.trace() / (3 * chain_.num_joints)),
        energy_(chain_, rig.skeleton, options.bend_stiffness * stiffness_unit_),
        frames_(sequence.num_frames()),
        clip_of_(sequence.num_frames()) {
    for (const ClipRange& clip : ClipRanges(options.clip_starts, sequence.num_frames())) {
      std::fill(clip_of_.begin() + clip.begin, clip_of_.begin() + clip.end, clip.clip);
    }
  }

  absl::Status Run(const Progress& progress) {
    const bool walk = options_.method == PoseFitMethod::kWalk;
    PLEAT_RETURN_IF_ERROR(ForFrames(progress.Stage("fit", 0, walk ? 0.8 : 0.5), 0, 1, [&](int t) {
      StartFrame(t);
      if (!walk) Improve(t, frames_[t].pose, energy_);
    }));
    if (walk) return WalkThroughTime(progress.Stage("fit", 0.8, 1));
    std::vector<char> changed(frames_.size(), 1);  // poses that their neighbors have not tried
    for (int pass = 0; pass < options_.neighbor_passes; ++pass) {
      const double begin = 0.5 + 0.3 * pass / options_.neighbor_passes;
      const double end = 0.5 + 0.3 * (pass + 1) / options_.neighbor_passes;
      PLEAT_RETURN_IF_ERROR(TryNeighbors(progress.Stage("fit", begin, end), &changed));
      if (std::find(changed.begin(), changed.end(), 1) == changed.end()) break;
    }
    if (!(options_.smoothness > 0)) return progress.Stage("fit", 0.8, 1).Report(1);
    unsmoothed_rms_m_ = Rms();
    PLEAT_ASSIGN_OR_RETURN(const PoseTrack unsmoothed, Track());
    unsmoothed_jitter_rad_ = RotationJitter(unsmoothed);
    return Smooth(progress.Stage("fit", 0.8, 1));
  }

  // An error where the numbers of a pose went astray.
  absl::StatusOr<PoseTrack> Track() const {
    PoseTrack::Parts track{.fps = sequence_.frame_rate().fps(),
                           .clip_starts = options_.clip_starts};
    for (const Frame& frame : frames_) {
      track.poses.push_back(FromChainPose(rig_.skeleton, frame.pose, frame.center));
      FixRootGauge(rig_.skeleton, &track.poses.back());
    }
    for (int t = 1; t < sequence_.num_frames(); ++t) {
      if (SameClip(t - 1, t)) KeepSigns(track.poses[t - 1], &track.poses[t]);
    }
    return PoseTrack::Create(std::move(track));
  }

  // `track`: of this fitter.
  void Summarize(const PoseTrack& track, PoseFitSummary* summary) const {
    *summary = {};
    double iterations = 0;
    for (const double square : MeanSquares()) summary->frame_rms_m.push_back(std::sqrt(square));
    for (const Frame& frame : frames_) {
      iterations += frame.num_iterations;
      summary->num_rescued_frames += frame.rescued;
    }
    summary->rms_m = Rms();
    summary->jitter_rad = RotationJitter(track);
    summary->unsmoothed_rms_m = unsmoothed_rms_m_.value_or(summary->rms_m);
    summary->unsmoothed_jitter_rad = unsmoothed_jitter_rad_.value_or(summary->jitter_rad);
    summary->mean_iterations = iterations / static_cast<double>(frames_.size());
    summary->worst_frames.resize(frames_.size());
    std::iota(summary->worst_frames.begin(), summary->worst_frames.end(), 0);
    std::stable_sort(summary->worst_frames.begin(), summary->worst_frames.end(), [&](int a, int b) {
      return summary->frame_rms_m[a] > summary->frame_rms_m[b];
    });
    summary->worst_frames.resize(std::min<size_t>(5, summary->worst_frames.size()));
  }

 private:
  struct Frame {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    Eigen::MatrixXd cross;  // 3J x 3
    double sum_squares = 0;
    ChainPose pose;
    double energy = 0;
    int num_iterations = 0;
    bool rescued = false;
  };

  // Returns the squared vertex distance of each frame's pose, the mean over vertices, in which all
  // count alike. Where they do not in the fit, its energy cannot say it.
  std::vector<double> MeanSquares() const {
    std::vector<double> squares(frames_.size());
    ParallelFor(static_cast<int>(frames_.size()), options_.num_threads, [&](int t) {
      const Frame& frame = frames_[t];
      if (rig_.fit_weights.size() > 0) {
        BoneTransforms transforms;
        Eigen::Matrix3Xd skinned;
        ComputeBoneTransforms(rig_.skeleton, FromChainPose(rig_.skeleton, frame.pose, frame.center),
                              {}, &transforms);
        SkinVertices(rig_.weights, rig_.rest_positions, transforms, &skinned);
        squares[t] = (sequence_.frame(t).cast<double>() - skinned).colwise().squaredNorm().mean();
        return;
      }
      PoseEnergy energy = energy_;
      energy.SetFrame(frame.cross, frame.sum_squares);
      squares[t] = std::max(0.0, energy.DataValue(frame.pose)) / chain_.num_vertices;
    });
    return squares;
  }

  double Rms() const {
    double squares = 0;
    for (const double square : MeanSquares()) squares += square;
    return std::sqrt(squares / static_cast<double>(frames_.size()));
  }

  // Takes the one of q and -q that is nearer to the frame before.
  static void KeepSigns(const Pose& previous, Pose* pose) {
    for (size_t j = 0; j < pose->rotations.size(); ++j) {
      if (pose->rotations[j].dot(previous.rotations[j]) < 0) pose->rotations[j].coeffs() *= -1;
    }
  }

  // Calls body(t) for t = first, first + step, ...; in batches, so that progress and cancellation
  // act.
  absl::Status ForFrames(const Progress& progress, int first, int step,
                         const std::function<void(int)>& body) {
    constexpr int kBatch = 64;
    const int count = (sequence_.num_frames() - first + step - 1) / step;
    for (int begin = 0; begin < count; begin += kBatch) {
      const int size = std::min(kBatch, count - begin);
      ParallelFor(size, options_.num_threads, [&](int item) {
        if (!progress.cancelled()) body(first + (begin + item) * step);
      });
      PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(begin + size) / count));
    }
    return absl::OkStatus();
  }

  // The only step that looks at vertices. It keeps what solvers need of the frame, 3J x 3 numbers.
  void StartFrame(int t) {
    const FrameMoments moments = ComputeFrameMoments(rig_, rig_moments_, sequence_.frame(t));
    Frame& frame = frames_[t];
    frame.center = moments.center;
    frame.cross = ComputeChainCross(rig_moments_, moments, rig_.skeleton);
    frame.sum_squares = moments.sum_squares;
    frame.pose = ClosedFormWalk(rig_moments_, moments, rig_.skeleton);
  }

  // Solves the frame of `energy` from `start`; returns pose and energy without storing them.
  std::pair<ChainPose, PoseSolverSummary> Solve(const PoseEnergy& energy, ChainPose start,
                                                int max_iterations) const {
    const PoseSolverSummary solved =
        MinimizePose(energy, {max_iterations, options_.tolerance}, &start);
    return {std::move(start), solved};
  }

  void Improve(int t, const ChainPose& start, const PoseEnergy& shared_energy) {
    Frame& frame = frames_[t];
    PoseEnergy energy = shared_energy;
    energy.SetFrame(frame.cross, frame.sum_squares);
    auto [pose, solved] = Solve(energy, start, options_.max_iterations);
    frame.pose = std::move(pose);
    frame.energy = solved.energy;
    frame.num_iterations += solved.num_iterations;
  }

  bool SameClip(int s, int t) const {
    return s >= 0 && s < sequence_.num_frames() && clip_of_[s] == clip_of_[t];
  }

  // Lets every frame try the poses that its neighbors had after the pass before (so that the order
  // does not matter), if they `changed` there; fills `changed` anew. An improvement below a
  // thousandth is the tail of convergence, not another valley.
  absl::Status TryNeighbors(const Progress& progress, std::vector<char>* changed) {
    constexpr int kTrial = 5;  // iterations that show whether a start leads to a deeper valley
    std::vector<ChainPose> before;
    for (const Frame& frame : frames_) before.push_back(frame.pose);
    std::vector<char> improved(frames_.size(), 0);
    PLEAT_RETURN_IF_ERROR(ForFrames(progress, 0, 1, [&](int t) {
      Frame& frame = frames_[t];
      PoseEnergy energy = energy_;
      energy.SetFrame(frame.cross, frame.sum_squares);
      for (const int s : {t - 1, t + 1}) {
        if (!SameClip(s, t) || !(*changed)[s]) continue;
        auto [pose, solved] = Solve(energy, before[s], std::min(kTrial, options_.max_iterations));
        frame.num_iterations += solved.num_iterations;
        if (!(solved.energy < frame.energy * (1 - 1e-3))) continue;  // the same valley or a worse
        frame.rescued = true;
        improved[t] = 1;
        Improve(t, pose, energy_);
      }
    }));
    *changed = std::move(improved);
    return absl::OkStatus();
  }

  // Block descent on the smoothed energy: even frames with the odd ones held, then the other way. A
  // frame's neighbors are never solved together with it, so each half is exact and parallel.
  absl::Status Smooth(const Progress& progress) {
    constexpr int kSweeps = 3;
    for (int half = 0; half < 2 * kSweeps; ++half) {
      const Progress part =
          progress.Stage("fit", half / (2.0 * kSweeps), (half + 1) / (2.0 * kSweeps));
      PLEAT_RETURN_IF_ERROR(ForFrames(part, half % 2, 2, [&](int t) {
        Frame& frame = frames_[t];
        PoseEnergy energy = energy_;
        energy.SetFrame(frame.cross, frame.sum_squares);
        for (const int s : {t - 1, t + 1}) {
          if (SameClip(s, t)) {
            energy.AddAttraction(frames_[s].pose.rotations, options_.smoothness * stiffness_unit_);
          }
        }
        auto [pose, solved] = Solve(energy, frame.pose, options_.max_iterations);
        frame.pose = std::move(pose);
        frame.num_iterations += solved.num_iterations;
      }));
    }
    return absl::OkStatus();
  }

  // The paper's fit is sequential: each frame starts from the one before.
  absl::Status WalkThroughTime(const Progress& progress) {
    PoseEnergy energy = energy_;
    for (int t = 0; t < sequence_.num_frames(); ++t) {
      Frame& frame = frames_[t];
      energy.SetFrame(frame.cross, frame.sum_squares);
      if (SameClip(t - 1, t)) frame.pose = frames_[t - 1].pose;
      WalkSweep(energy, rig_.skeleton, &frame.pose);
      frame.num_iterations = 1;
      if (t % 64 == 63 || t + 1 == sequence_.num_frames()) {
        PLEAT_RETURN_IF_ERROR(progress.Report((t + 1.0) / sequence_.num_frames()));
      }
    }
    return absl::OkStatus();
  }

  const MeshSequence& sequence_;
  const Rig& rig_;
  const PoseFitOptions& options_;
  const RigMoments rig_moments_;
  const ChainMoments chain_;
  const double stiffness_unit_;  // square meters
  const PoseEnergy energy_;      // without a frame
  std::vector<Frame> frames_;
  std::vector<int> clip_of_;
  std::optional<double> unsmoothed_rms_m_, unsmoothed_jitter_rad_;
};

}  // namespace

absl::StatusOr<PoseTrack> FitPoses(const MeshSequence& sequence, const Rig& rig,
                                   const PoseFitOptions& options, PoseFitSummary* summary,
                                   const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckRigOfSequence("pose fit", sequence, rig));
  PLEAT_RETURN_IF_ERROR(CheckClipStarts(options.clip_starts, sequence.num_frames()));
  PoseFitter fitter(sequence, rig, options);
  PLEAT_RETURN_IF_ERROR(fitter.Run(progress));
  PLEAT_ASSIGN_OR_RETURN(PoseTrack track, fitter.Track());
  if (summary != nullptr) fitter.Summarize(track, summary);
  return track;
}

double RotationJitter(const PoseTrack& track) {
  double squares = 0;
  int64_t count = 0;
  for (int t = 2; t < track.num_frames(); ++t) {
    if (t - 2 < track.ClipOf(t).begin) continue;
    const auto& before = track.pose(t - 2).rotations;
    const auto& middle = track.pose(t - 1).rotations;
    const auto& after = track.pose(t).rotations;
    for (size_t j = 0; j < middle.size(); ++j) {
      const Eigen::Quaterniond first = before[j].conjugate() * middle[j];
      const double angle = first.angularDistance(middle[j].conjugate() * after[j]);
      squares += angle * angle;
      ++count;
    }
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
}

void FixRootGauge(const Skeleton& skeleton, Pose* pose) {
  std::vector<int> hips = {skeleton.FindJoint("leftUpperLeg"), skeleton.FindJoint("rightUpperLeg")};
  const bool named = std::all_of(hips.begin(), hips.end(),
                                 [&](int j) { return j > 0 && skeleton.parent(j) == 0; });
  if (!named) hips = skeleton.children(0);
  if (hips.empty()) return;
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  const Eigen::Vector4d first = pose->rotations[hips[0]].coeffs();
  for (const int j : hips) {
    const Eigen::Vector4d q = pose->rotations[j].coeffs();
    sum += q.dot(first) < 0 ? Eigen::Vector4d(-q) : q;
  }
  const Eigen::Quaterniond turn(Eigen::Vector4d(sum.normalized()));  // relative to the old root
  pose->rotations[0] = (pose->rotations[0] * turn).normalized();
  for (const int j : skeleton.children(0)) {
    pose->rotations[j] = (turn.conjugate() * pose->rotations[j]).normalized();
    if (pose->rotations[j].w() < 0) pose->rotations[j].coeffs() *= -1;
  }
}

}  // namespace pleat
