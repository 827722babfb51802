#include "rest_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "main_body.h"
#include "pleat/base/status.h"
#include "pleat/math/principal_axes.h"

namespace pleat {
namespace {

constexpr int kMaxFullFrames = 1;    // probed frames that are looked at again on the full grid
constexpr int kMaxTurnedFrames = 2;  // looked at in other orientations
// A multiple of the trusted residual: a frame that fits so well as it stands is not lying.
constexpr double kStandingRatio = 1.5;
// A multiple of the trusted residual: what fits worse in another orientation is not lying either.
constexpr double kTurnedRatio = 2;
constexpr double kFoldedForearm = .5;

// Returns the frames to look at, evenly spaced: the first one first, then each far from those
// before it, so that a search that ends early has seen different poses.
std::vector<int> FramesToTry(int num_frames, const AutoRigOptions& options) {
  if (options.rest_frame >= 0) return {options.rest_frame};
  if (!options.placed_joints.empty()) return {0};
  const int count = std::clamp(options.max_frames_tried, 1, num_frames);
  std::vector<int> order;  // k in [0, count): multiples of halves, quarters, ...
  for (unsigned step = std::bit_ceil(static_cast<unsigned>(count)); step >= 1; step /= 2) {
    for (unsigned k = order.empty() ? 0 : step; k < static_cast<unsigned>(count); k += 2 * step) {
      order.push_back(static_cast<int>(k));
    }
  }
  for (int& k : order) k = static_cast<int>(static_cast<int64_t>(k) * num_frames / count);
  return order;
}

Eigen::Matrix3d TurnToY(const Eigen::Vector3d& up) {
  return Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitY()).toRotationMatrix();
}

// Returns the turns that stand up the other coordinate axes (Z up is common), then the principal
// axes of the shell, both ways; the body's own left and right come to lie along the x axis.
std::vector<Eigen::Matrix3d> OrientationsToTry(const BodyShell& shell) {
  std::vector<Eigen::Vector3d> ups = {{0, 0, 1}, {0, 0, -1}, {0, -1, 0}, {1, 0, 0}, {-1, 0, 0}};
  const Eigen::Matrix3d axes = PrincipalAxes(shell.positions, shell.positions.rowwise().mean());
  for (int k = 2; k >= 0; --k) {
    ups.emplace_back(axes.col(k));
    ups.emplace_back(-axes.col(k));
  }
  std::vector<Eigen::Matrix3d> turns;
  for (const Eigen::Vector3d& up : ups) {
    const Eigen::Matrix3d turn = TurnToY(up);
    const double yaw = HorizontalAxisYaw(shell, turn);
    turns.push_back(Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitY()) * turn);
  }
  return turns;
}

// The search for the frame. Probes are cheap because of their coarse grid, the full grid is exact,
// and either may succeed where the other fails; `best_` is the best of all that was seen on any
// grid. It holds the volume as well, which the heat weights need again.
class RestFrameSearch {
 public:
  RestFrameSearch(const MeshSequence& sequence, const AutoRigOptions& options,
                  const Progress& progress)
      : sequence_(sequence), options_(options), progress_(progress) {
    best_.embedding.residual = std::numeric_limits<double>::infinity();
  }

  absl::StatusOr<FrameEmbedding> Run(int* num_frames_tried) {
    const std::vector<int> frames = FramesToTry(sequence_.num_frames(), options_);
    *num_frames_tried = 1;
    PLEAT_RETURN_IF_ERROR(TryFully(frames[0], Eigen::Matrix3d::Identity()));
    if (!IsTrusted() && frames.size() > 1) {
      PLEAT_RETURN_IF_ERROR(ProbeOthers(frames));
      *num_frames_tried += static_cast<int>(probe_residuals_.size());
    }
    if (least_residual_ >= kStandingRatio * options_.trusted_residual && options_.any_orientation) {
      PLEAT_RETURN_IF_ERROR(TurnOver(frames[0]));
    }
    if (best_.embedding.residual > options_.refused_residual && options_.placed_joints.empty()) {
      PLEAT_RETURN_IF_ERROR(TryFoldedArms(best_.frame >= 0 ? best_.frame : frames[0]));
    }
    PLEAT_RETURN_IF_ERROR(Judge(*num_frames_tried));
    return std::move(best_);
  }

 private:
  // Frames with the least score are rigged best.
  double Score(const Embedding& embedding) const {
    return embedding.residual + options_.arm_shortfall_weight * embedding.arm_shortfall;
  }
  bool IsTrusted() const { return Score(best_.embedding) < options_.trusted_residual; }

  EmbeddingOptions EmbeddingOptionsFor(const Eigen::Matrix3d& upright) const {
    EmbeddingOptions embedding = options_.embedding;
    embedding.upright_from_input = upright;
    embedding.placed = options_.placed_joints;
    // What must be refused need not be searched for.
    if (options_.placed_joints.empty()) {
      embedding.search.max_bound = std::min(embedding.search.max_bound, options_.refused_residual);
    }
    if (has_folded_arms_) embedding.penalties.most_forearm_mismatch = kFoldedForearm;
    if (options_.yaw_degrees) {
      embedding.yaws_degrees = {*options_.yaw_degrees};
      embedding.adjust_yaw = false;
    }
    return embedding;
  }

  // The surface of a frame serves both grids, and a volume every orientation of its frame.
  absl::StatusOr<std::shared_ptr<const BodyVolume>> VolumeOf(int frame, int resolution) {
    std::shared_ptr<const BodyVolume>& volume = volumes_[{frame, resolution}];
    if (volume != nullptr) return volume;
    BodyVolumeOptions options = options_.volume;
    options.num_threads = options_.num_threads;
    options.resolution = resolution;
    std::shared_ptr<const BodySurface>& surface = surfaces_[frame];
    if (surface == nullptr) {
      // The gaps of a mesh are about the same in all frames.
      if (growth_) options.outer.growth = *growth_;
      PLEAT_ASSIGN_OR_RETURN(
          BodySurface prepared,
          PrepareBodySurface(sequence_.topology(), sequence_.FrameAsDouble(frame), options,
                             progress_));
      if (prepared.is_repaired) growth_ = prepared.growth;
      surface = std::make_shared<const BodySurface>(std::move(prepared));
    }
    PLEAT_ASSIGN_OR_RETURN(BodyVolume computed, ComputeBodyVolume(surface, options, progress_));
    volume = std::make_shared<const BodyVolume>(std::move(computed));
    return volume;
  }

  absl::StatusOr<FrameEmbedding> Embed(int frame, int resolution, const Eigen::Matrix3d& upright) {
    FrameEmbedding result{.frame = frame,
                          .volume = {},
                          .upright_from_input = upright,
                          .embedding = {},
                          .is_tentative = has_folded_arms_};
    PLEAT_ASSIGN_OR_RETURN(result.volume, VolumeOf(frame, resolution));
    PLEAT_ASSIGN_OR_RETURN(result.embedding,
                           EmbedSkeleton(*result.volume, EmbeddingOptionsFor(upright), progress_));
    least_residual_ = std::min(least_residual_, result.embedding.residual);
    return result;
  }

  // Keeps the frame when it is the best so far. Where the full grid is not trusted the coarse one
  // is asked as well: their spheres differ, and either may miss a way through a thin limb.
  absl::Status TryFully(int frame, const Eigen::Matrix3d& upright) {
    PLEAT_RETURN_IF_ERROR(TryAt(frame, options_.volume.resolution, upright));
    if (IsTrusted()) return absl::OkStatus();
    return TryAt(frame, options_.probe_resolution, upright);
  }

  // Does the same for a frame whose coarse grid was looked at already.
  absl::Status TryProbed(FrameEmbedding probe) {
    PLEAT_RETURN_IF_ERROR(TryAt(probe.frame, options_.volume.resolution, probe.upright_from_input));
    if (!IsTrusted()) Offer(std::move(probe));
    return absl::OkStatus();
  }

  void Offer(FrameEmbedding tried) {
    if (Score(tried.embedding) < Score(best_.embedding)) best_ = std::move(tried);
  }

  // Embeds one frame on one grid and offers the result. Only kCancelled is an error; the first
  // failure is kept for the message, should no frame fit.
  absl::Status TryAt(int frame, int resolution, const Eigen::Matrix3d& upright) {
    absl::StatusOr<FrameEmbedding> tried = Embed(frame, resolution, upright);
    if (absl::IsCancelled(tried.status())) return tried.status();
    if (!tried.ok()) {
      if (failure_.ok()) failure_ = tried.status();
    } else {
      Offer(*std::move(tried));
    }
    return absl::OkStatus();
  }

  // Probes the other frames on the coarse grid. Ends with the first one that is trusted; otherwise
  // the best of all are looked at again.
  absl::Status ProbeOthers(const std::vector<int>& frames) {
    std::vector<FrameEmbedding> probes;
    for (size_t k = 1; k < frames.size(); ++k) {
      PLEAT_RETURN_IF_ERROR(progress_.Report(.2 + .5 * k / frames.size()));
      absl::StatusOr<FrameEmbedding> probe =
          Embed(frames[k], options_.probe_resolution, Eigen::Matrix3d::Identity());
      if (absl::IsCancelled(probe.status())) return probe.status();
      probe_residuals_.push_back(probe.ok() ? probe->embedding.residual
                                            : std::numeric_limits<double>::infinity());
      if (!probe.ok()) continue;
      if (Score(probe->embedding) < options_.trusted_residual) {
        return TryProbed(*std::move(probe));
      }
      probes.push_back(*std::move(probe));
    }
    std::ranges::stable_sort(probes, {}, [this](const FrameEmbedding& probe) {
      return std::pair(Score(probe.embedding), probe.frame);
    });
    for (size_t k = 0; k < probes.size() && k < kMaxFullFrames && !IsTrusted(); ++k) {
      probed_.push_back(probes[k].frame);
      PLEAT_RETURN_IF_ERROR(TryProbed(std::move(probes[k])));
    }
    return absl::OkStatus();
  }

  // Tries other orientations of the first and of the best probed frame. One is taken when it is
  // trusted, or tentatively when the frame would be refused as it stands: a beast on its hind legs
  // comes near to a human.
  absl::Status TurnOver(int first_frame) {
    std::vector<int> frames = {first_frame};
    if (!probed_.empty()) frames.push_back(probed_[0]);
    for (size_t k = 0; k < frames.size() && k < kMaxTurnedFrames; ++k) {
      PLEAT_ASSIGN_OR_RETURN(std::optional<Eigen::Matrix3d> upright,
                             FindOrientationOn(frames[k], options_.volume.resolution));
      // As in TryFully, either grid may miss a way.
      if (!upright) {
        PLEAT_ASSIGN_OR_RETURN(upright, FindOrientationOn(frames[k], options_.probe_resolution));
      }
      if (!upright) continue;
      FrameEmbedding as_it_stands = std::move(best_);
      best_ = {};
      best_.embedding.residual = std::numeric_limits<double>::infinity();
      PLEAT_RETURN_IF_ERROR(TryFully(frames[k], *upright));
      if (IsTrusted()) return absl::OkStatus();
      if (as_it_stands.embedding.residual > options_.refused_residual &&
          best_.embedding.residual < kTurnedRatio * options_.trusted_residual) {
        best_.is_tentative = true;
        return absl::OkStatus();
      }
      best_ = std::move(as_it_stands);
    }
    return absl::OkStatus();
  }

  // Returns none as well where the frame has no volume.
  absl::StatusOr<std::optional<Eigen::Matrix3d>> FindOrientationOn(int frame, int resolution) {
    const absl::StatusOr<std::shared_ptr<const BodyVolume>> volume = VolumeOf(frame, resolution);
    if (absl::IsCancelled(volume.status())) return volume.status();
    if (!volume.ok()) return std::optional<Eigen::Matrix3d>();
    return FindOrientation(**volume);
  }

  // Looks at a frame again as if its forearms may point anywhere: arms folded before the chest.
  absl::Status TryFoldedArms(int frame) {
    has_folded_arms_ = true;
    PLEAT_RETURN_IF_ERROR(TryAt(frame, options_.volume.resolution, Eigen::Matrix3d::Identity()));
    has_folded_arms_ = false;
    return absl::OkStatus();
  }

  // Returns the orientation with the least residual under kTurnedRatio trusted ones, made exact by
  // what the skeleton itself says about up; none when there is no such. Each bound is the best
  // residual so far, so hopeless orientations are cheap.
  absl::StatusOr<std::optional<Eigen::Matrix3d>> FindOrientation(const BodyVolume& volume) const {
    std::optional<Eigen::Matrix3d> best;
    Eigen::Matrix3Xd joints;
    double least = kTurnedRatio * options_.trusted_residual;
    for (const Eigen::Matrix3d& turn : OrientationsToTry(volume.body->shell)) {
      PLEAT_RETURN_IF_ERROR(progress_.Report(.8));
      EmbeddingOptions embedding = EmbeddingOptionsFor(turn);
      embedding.search.max_bound = std::min(embedding.search.max_bound, least);
      const absl::StatusOr<Embedding> found = EmbedSkeleton(volume, embedding, progress_);
      if (absl::IsCancelled(found.status())) return found.status();
      if (!found.ok() || !(found->residual < least)) continue;
      least = found->residual;
      best = turn;
      joints = found->joints;
    }
    if (!best) return best;
    const Eigen::Matrix3d own = UprightFromJoints(joints);
    if (options_.yaw_degrees || !own.allFinite()) return best;
    const absl::StatusOr<Embedding> found =
        EmbedSkeleton(volume, EmbeddingOptionsFor(own), progress_);
    if (absl::IsCancelled(found.status())) return found.status();
    if (found.ok() && found->residual < least) best = own;
    return best;
  }

  // A doubtful rig whose other frames do not fit at all is a pose in which a beast looks human.
  bool IsLuckyFrame() const {
    if (probe_residuals_.empty() || best_.embedding.residual < kDoubtfulResidual) return false;
    std::vector<double> sorted = probe_residuals_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2] > options_.refused_residual;
  }

  absl::Status Judge(int num_frames_tried) const {
    if (best_.frame < 0) {
      return absl::FailedPreconditionError(
          absl::StrCat("no frame of ", sequence_.name(), " (", num_frames_tried,
                       " tried) can be rigged: ", failure_.message(), "; ", kRigAdvice));
    }
    if (!options_.placed_joints.empty()) return absl::OkStatus();
    if (best_.embedding.residual > options_.refused_residual) {
      return absl::FailedPreconditionError(absl::StrFormat(
          "%s does not look like one standing human: in the best of %d frames, frame %d, the "
          "skeleton fits with a residual of %.3f, above %.3f (%.0f %% of the surface is far from "
          "every bone); %s",
          sequence_.name(), num_frames_tried, best_.frame, best_.embedding.residual,
          options_.refused_residual, 100 * best_.embedding.uncovered_share, kRigAdvice));
    }
    if (IsLuckyFrame()) {
      return absl::FailedPreconditionError(absl::StrFormat(
          "%s does not look like one standing human: frame %d fits the skeleton with a residual of "
          "%.3f, but most of the %d frames tried are above %.3f; %s",
          sequence_.name(), best_.frame, best_.embedding.residual, num_frames_tried,
          options_.refused_residual, kRigAdvice));
    }
    return absl::OkStatus();
  }

  const MeshSequence& sequence_;
  const AutoRigOptions& options_;
  const Progress& progress_;
  FrameEmbedding best_;
  std::map<int, std::shared_ptr<const BodySurface>> surfaces_;  // by frame; of the few tried
  // By frame and resolution; the full ones are of one or two frames.
  std::map<std::pair<int, int>, std::shared_ptr<const BodyVolume>> volumes_;
  std::optional<int> growth_;  // BodySurface::growth of the first repaired surface
  double least_residual_ = std::numeric_limits<double>::infinity();  // over all frames tried
  bool has_folded_arms_ = false;
  std::vector<int> probed_;              // best first
  std::vector<double> probe_residuals_;  // infinite where nothing fits
  absl::Status failure_;                 // what kept the first failed frame from a rig
};

}  // namespace

absl::StatusOr<FrameEmbedding> FindRestFrame(const MeshSequence& sequence,
                                             const AutoRigOptions& options, AutoRigSummary* summary,
                                             const Progress& progress) {
  return RestFrameSearch(sequence, options, progress).Run(&summary->num_frames_tried);
}

}  // namespace pleat
