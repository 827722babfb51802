// Training that stops where a test wants and gives a small model of the clip's own mesh.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "pleat/base/random.h"
#include "pleat/character/character_model.h"
#include "pleat/character/train_character.h"
#include "pleat/learner/detail_model.h"
#include "pleat/mesh/bounds.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// A closed tube of `rings` x `sides` vertices that sways: T frames.
inline MeshSequence MakeSwayingTube(int num_frames, const std::string& name = "tube",
                                    int rings = 12, int sides = 8) {
  std::vector<int32_t> corners, sizes;
  for (int r = 0; r + 1 < rings; ++r) {
    for (int s = 0; s < sides; ++s) {
      const int next = (s + 1) % sides;
      corners.insert(corners.end(), {r * sides + s, r * sides + next, (r + 1) * sides + next,
                                     (r + 1) * sides + s});
      sizes.push_back(4);
    }
  }
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < num_frames; ++t) {
    Eigen::Matrix3Xf frame(3, rings * sides);
    for (int r = 0; r < rings; ++r) {
      const float height = 1.6f * static_cast<float>(r) / static_cast<float>(rings - 1);
      for (int s = 0; s < sides; ++s) {
        const float angle = 6.2831853f * static_cast<float>(s) / static_cast<float>(sides);
        const float sway = .1f * height * std::sin(.3f * static_cast<float>(t));
        frame.col(r * sides + s) << .2f * std::cos(angle) + sway, height, .2f * std::sin(angle);
      }
    }
    frames.push_back(std::move(frame));
  }
  Topology topology = Topology::Create(rings * sides, corners, sizes).value();
  return MeshSequence::Create(
             std::move(topology), std::move(frames),
             {.name = name, .frame_rate = {25, 1}, .appearance = {}, .frame_names = {}})
      .value();
}

// A chain of three joints up the mesh, weights by height, and a detail of a few millimeters.
// Depends on clip and seed only.
inline std::shared_ptr<const CharacterModel> MakeFakeModel(const MeshSequence& clip,
                                                           const TrainOptions& options) {
  constexpr int kRows = 4, kComponents = 2;
  const int num_vertices = clip.num_vertices();
  Random random(options.seed);
  const auto matrix = [&](int rows, int columns) {
    Eigen::MatrixXd result(rows, columns);
    for (double& entry : result.reshaped()) entry = random.Uniform(-1, 1);
    return result;
  };
  CharacterModel::Parts parts;
  parts.name = clip.name();
  parts.frame_rate = clip.frame_rate();
  parts.topology = clip.topology();
  parts.appearance = clip.appearance();
  parts.options = options;
  parts.options.learner = LearnerChoice::kGp;
  parts.rig.rest_positions = clip.FrameAsDouble(0);
  parts.rig.skeleton =
      Skeleton::Create(
          {{"hips", -1, {0, .1, 0}}, {"chest", 0, {0, .9, 0}}, {"head", 1, {0, 1.5, 0}}})
          .value();
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(num_vertices, 3);
  for (int v = 0; v < num_vertices; ++v) {
    const double upper = std::clamp(parts.rig.rest_positions(1, v) / 1.6, 0.0, 1.0);
    weights.row(v) << 0, 1 - upper, upper;
  }
  parts.rig.weights = SkinWeights::FromDense(weights).value();
  const int num_values = 2 * NumCoordinates(options.rotations);  // 2 bones
  parts.feature_reference = Eigen::VectorXd::Zero(num_values);
  for (int v = 0; v < num_vertices; ++v) parts.control_vertices.push_back(v);
  GpRegressionParameters stage;
  const int num_features = num_values * options.history;
  stage.kernel_options.linear = true;
  stage.input_mean = Eigen::VectorXd::Zero(num_features);
  stage.input_scales = Eigen::VectorXd::Ones(num_features);
  stage.inputs = matrix(kRows, num_features);
  stage.output_mean = matrix(kComponents, 1).col(0);
  stage.alpha = matrix(kRows, kComponents);
  stage.whitener = Eigen::MatrixXf::Identity(kRows, kRows);
  DetailModelParameters detail;
  detail.learner = Learner::kGp;
  detail.stages = {stage};
  const Eigen::VectorXf mean = matrix(3 * num_vertices, 1).col(0).cast<float>() * .005f;
  detail.basis = PartedBasisParameters::Whole(
      DetailBasis::Quantize(mean, matrix(3 * num_vertices, kComponents) * .005,
                            Eigen::VectorXd::Constant(kComponents, 1e-6))
          .value()
          .parameters());
  parts.detail_model =
      std::make_shared<const DetailModel>(DetailModel::FromParameters(std::move(detail)).value());
  parts.record.learner = "gp";
  parts.record.num_frames = clip.num_frames();
  parts.record.diagonal_m = BoundsDiagonal(parts.rig.rest_positions);
  parts.record.warnings = {"made by a test"};
  return CharacterModel::Create(std::move(parts)).value();
}

// Trains in 20 steps that take no time, and stops where it is told.
class FakeTrainer {
 public:
  std::atomic<int> num_started = 0;

  // From now on trainings report `step` of 20 and stop there, until Release, a later step given
  // here, or their cancellation.
  void HoldAt(int step) {
    std::lock_guard lock(mutex_);
    hold_at_ = step;
    changed_.notify_all();
  }
  void Hold() { HoldAt(kNumSteps / 2); }
  void Release() { HoldAt(kNumSteps); }
  // Returns when a training has stopped.
  void WaitUntilHeld() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return num_held_ > 0; });
  }

  auto function() {
    return
        [this](const std::vector<MeshSequence>& clips, const TrainOptions& options,
               const TrainResources&, TrainSummary*,
               const Progress& progress) -> absl::StatusOr<std::shared_ptr<const CharacterModel>> {
          ++num_started;
          const Progress learning = progress.Stage("learn", 0, 1);
          for (int step = 0; step < kNumSteps; ++step) {
            const double fraction = step / static_cast<double>(kNumSteps);
            if (absl::Status status = learning.Report(fraction, 100.0 - step); !status.ok()) {
              return status;
            }
            PassHold(step, learning);
          }
          if (options.iterations == 13)
            return absl::FailedPreconditionError("no human-like rig fits");
          return MakeFakeModel(clips[0], options);
        };
  }

 private:
  static constexpr int kNumSteps = 20;

  void PassHold(int step, const Progress& progress) {
    std::unique_lock lock(mutex_);
    ++num_held_;
    changed_.notify_all();
    while (step >= hold_at_ && !progress.cancelled()) {
      // A cancellation rings no bell, so it is asked for.
      changed_.wait_for(lock, std::chrono::milliseconds(1));
    }
    --num_held_;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  int hold_at_ = kNumSteps;  // guarded by mutex_
  int num_held_ = 0;         // guarded by mutex_
};

// A motion of a model's skeleton.
inline PoseTrack MakeMotion(const Skeleton& skeleton, int num_frames, double fps = 25) {
  PoseTrack::Parts track{.fps = fps};
  for (int t = 0; t < num_frames; ++t) {
    Pose pose = Pose::Rest(skeleton);
    pose.root_position += Eigen::Vector3d(.02 * t, 0, .01 * t);
    for (size_t j = 0; j < pose.rotations.size(); ++j) {
      pose.rotations[j] =
          Eigen::AngleAxisd(.3 * std::sin(.2 * t + static_cast<double>(j)),
                            Eigen::Vector3d(.3, .5, static_cast<double>(j) + 1).normalized());
    }
    track.poses.push_back(pose);
  }
  return PoseTrack::FromValid(std::move(track));
}

}  // namespace pleat
