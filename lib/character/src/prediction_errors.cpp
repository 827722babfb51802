#include "prediction_errors.h"

#include <functional>

#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/skeleton/pose_history.h"

namespace pleat {
namespace {

// Calls `predict` for every test frame and collects the errors. The error of motion counts where
// the frame before is a test frame too.
absl::StatusOr<ErrorSummary> MeasureFrames(
    const TestSide& test, double diagonal_m, const Progress& progress,
    const std::function<absl::Status(int t, Eigen::Matrix3Xf* positions)>& predict) {
  ErrorAccumulator errors(diagonal_m);
  Eigen::Matrix3Xf positions;
  for (size_t i = 0; i < test.frames.size(); ++i) {
    const int t = test.frames[i];
    PLEAT_RETURN_IF_ERROR(predict(t, &positions));
    errors.AddFrame(positions.cast<double>(), test.sequence.FrameAsDouble(t),
                    i > 0 && test.frames[i - 1] == t - 1);
    PLEAT_RETURN_IF_ERROR(progress.Report((i + 1.0) / test.frames.size()));
  }
  return errors.Summarize();
}

}  // namespace

absl::StatusOr<ErrorSummary> MeasureModel(const std::shared_ptr<const CharacterModel>& model,
                                          const TestSide& test, double diagonal_m,
                                          bool skinned_only, const Progress& progress) {
  PoseEvaluator evaluator(model);
  PoseHistory history(test.track, model->frame_rate().fps(), model->options().history);
  std::vector<const Pose*> poses;
  EvaluatedFrame frame;
  return MeasureFrames(test, diagonal_m, progress, [&](int t, Eigen::Matrix3Xf* positions) {
    history.At(t, &poses);
    PLEAT_RETURN_IF_ERROR(skinned_only ? evaluator.EvaluateSkinned(*poses[0], {}, &frame)
                                       : evaluator.Evaluate(poses, {}, &frame));
    positions->swap(frame.positions);
    return absl::OkStatus();
  });
}

absl::StatusOr<ErrorSummary> MeasureBaseline(const DetailPredictor& predictor,
                                             const CharacterModel& model, const TestSide& test,
                                             double diagonal_m, const Progress& progress) {
  PoseHistory history(test.track, model.frame_rate().fps(), model.options().history);
  std::vector<const Pose*> poses;
  Eigen::VectorXd features(model.features().num_features());
  BoneTransforms transforms;
  Eigen::Matrix3Xd base;
  std::vector<Eigen::Quaterniond> rotations;
  std::vector<int> all_vertices(model.num_vertices());
  for (int v = 0; v < model.num_vertices(); ++v) all_vertices[v] = v;
  return MeasureFrames(test, diagonal_m, progress, [&](int t, Eigen::Matrix3Xf* positions) {
    history.At(t, &poses);
    model.features().ComputeRow(poses, features);
    Eigen::VectorXf details = predictor(features).cast<float>();
    if (model.parts().upsampler) {
      const Eigen::MatrixXf xyz = details.reshaped(3, details.size() / 3);
      const Eigen::MatrixXf full = model.parts().upsampler->matrix() * xyz.transpose();
      details = full.transpose().reshaped();
    }
    ComputeBoneTransforms(model.skeleton(), *poses[0], {}, &transforms);
    ComputeDetailBase(model.options().deformation, model.rig(), transforms, &base);
    ComputeDetailRotations(model.options().detail_axes, model.rig().weights, all_vertices,
                           transforms, &rotations);
    ApplyDetails(base, rotations, details, &base);
    *positions = base.cast<float>();
    return absl::OkStatus();
  });
}

}  // namespace pleat
