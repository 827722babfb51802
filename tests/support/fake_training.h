// Training that takes as long as a test wants and gives a small model of the clip's own mesh.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>
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
  detail.basis = DetailBasis::Quantize(mean, matrix(3 * num_vertices, kComponents) * .005,
                                       Eigen::VectorXd::Constant(kComponents, 1e-6))
                     .value()
                     .parameters();
  parts.detail_model =
      std::make_shared<const DetailModel>(DetailModel::FromParameters(std::move(detail)).value());
  parts.record.learner = "gp";
  parts.record.num_frames = clip.num_frames();
  parts.record.diagonal_m = BoundsDiagonal(parts.rig.rest_positions);
  parts.record.warnings = {"made by a test"};
  return CharacterModel::Create(std::move(parts)).value();
}

class FakeTrainer {
 public:
  std::atomic<int> step_ms = 0;  // how long each of the 20 steps takes
  std::atomic<int> num_started = 0;

  auto function() {
    return
        [this](const std::vector<MeshSequence>& clips, const TrainOptions& options,
               const TrainResources&, TrainSummary*,
               const Progress& progress) -> absl::StatusOr<std::shared_ptr<const CharacterModel>> {
          ++num_started;
          const Progress learning = progress.Stage("learn", 0, 1);
          for (int step = 0; step < 20; ++step) {
            if (absl::Status status = learning.Report(step / 20.0, 100.0 - step); !status.ok()) {
              return status;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(step_ms));
          }
          if (options.iterations == 13)
            return absl::FailedPreconditionError("no human-like rig fits");
          return MakeFakeModel(clips[0], options);
        };
  }
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
