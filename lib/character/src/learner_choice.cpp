// The learners, and their choice by validation inside the training frames
// (docs/method/learner.md#choice-of-the-learner).
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/learner/detail_model.h"
#include "training_steps.h"

namespace pleat {
namespace {

constexpr int kNumValidationBlocks = 4;
constexpr double kValidationShare = 0.2;  // the share of the training frames that is held out
constexpr int kMinFramesToValidate = 20;  // with fewer, too little is left to learn from

struct RowSplit {
  std::vector<int> train, held_out;
  std::vector<int> train_clip_starts;  // rows of `train` whose predecessor is not the row before
};

// Holds out evenly spaced, contiguous blocks. Single frames would be too easy to predict, since the
// frames on both sides of them would be in training.
RowSplit HoldOutBlocks(int num_rows, const std::vector<int>& clip_starts) {
  RowSplit split;
  const int block =
      std::max(1, static_cast<int>(num_rows * kValidationShare) / kNumValidationBlocks);
  std::vector<bool> held_out(num_rows, false);
  for (int b = 0; b < kNumValidationBlocks; ++b) {
    const int middle = num_rows * (2 * b + 1) / (2 * kNumValidationBlocks);
    for (int t = middle - block / 2; t < middle - block / 2 + block; ++t) {
      if (t >= 0 && t < num_rows) held_out[t] = true;
    }
  }
  for (int t = 0; t < num_rows; ++t) {
    if (held_out[t]) {
      split.held_out.push_back(t);
      continue;
    }
    const bool starts_clip =
        t == 0 || held_out[t - 1] || std::binary_search(clip_starts.begin(), clip_starts.end(), t);
    if (starts_clip) split.train_clip_starts.push_back(static_cast<int>(split.train.size()));
    split.train.push_back(t);
  }
  return split;
}

// These are enough to compare learners; a sequence may have thousands.
constexpr int kMaxHeldOutRows = 400;

// Returns the mean vertex distance, in meters, between the predicted and the true details of the
// held-out rows.
double HeldOutError(const DetailModel& model, const LearningData& data,
                    const std::vector<int>& rows) {
  DetailModel::Workspace workspace;
  Eigen::VectorXf predicted(model.num_details());
  const int step = (static_cast<int>(rows.size()) + kMaxHeldOutRows - 1) / kMaxHeldOutRows;
  double sum = 0;
  int count = 0;
  for (size_t i = 0; i < rows.size(); i += step, ++count) {
    const int t = rows[i];
    model.Predict(data.FeaturesOf(model, t), &workspace, predicted);
    const Eigen::VectorXd difference =
        data.DetailOf(data.details.scores.row(t).transpose()) - predicted.cast<double>();
    sum += difference.reshaped(3, difference.size() / 3).colwise().norm().mean();
  }
  return sum / count;
}

DetailModelOptions ModelOptionsOf(LearnerChoice learner, const TrainOptions& options,
                                  const LearningData& data) {
  DetailModelOptions result;
  result.gp.input_groups = data.feature_groups;
  result.max_components = options.max_components;
  result.pca_energy = options.detail_energy;
  result.num_pose_features = static_cast<int>(data.features.cols());
  switch (learner) {
    case LearnerChoice::kAuto:  // refused by LearnDetails
      break;
    case LearnerChoice::kRegional:
    case LearnerChoice::kRegionalFast:
      result.learner = Learner::kRegional;
      break;
    case LearnerChoice::kGp:
      result.learner = Learner::kGp;
      break;
    case LearnerChoice::kRidge:
      result.learner = Learner::kRidge;
      break;
    case LearnerChoice::kSgplvm:
    case LearnerChoice::kBackConstrained:
      result.learner = Learner::kSgplvm;
      if (learner == LearnerChoice::kSgplvm) result.sgplvm = SharedGplvmOptions::Paper();
      result.sgplvm.latent_dimension = options.latent_dimensions;
      result.sgplvm.max_iterations = options.iterations;
      result.sgplvm.dynamics_weight = options.dynamics_weight;
      break;
  }
  return result;
}

}  // namespace

Eigen::VectorXd LearningData::FeaturesOf(const DetailModel& model, int t) const {
  Eigen::VectorXd row(model.num_features());
  row.head(features.cols()) = features.row(t).transpose();
  const Eigen::Index num_skin = row.size() - features.cols();
  if (num_skin > 0) row.tail(num_skin) = regional.skin_rows.row(t).head(num_skin).transpose();
  return row;
}

absl::StatusOr<std::shared_ptr<const DetailModel>> LearnDetails(
    const LearningData& data, const Rig& rig, LearnerChoice learner, const TrainOptions& options,
    const Progress& progress, DirectGp* direct_gp) {
  if (learner == LearnerChoice::kAuto) {
    return absl::InternalError("a learner must be chosen before it can be trained");
  }
  DetailModelOptions model_options = ModelOptionsOf(learner, options, data);
  if (direct_gp && *direct_gp) model_options.trained_gp = &**direct_gp;
  if (data.differential) {
    model_options.output_map = [&data](const Eigen::MatrixXd& columns) {
      return data.differential->DecodeColumns(columns);
    };
  }
  Eigen::MatrixXd features = data.features;
  if (model_options.learner == Learner::kRegional) {
    const RegionalData regional =
        learner == LearnerChoice::kRegionalFast ? data.regional.WithoutPatches(rig) : data.regional;
    model_options.regions = regional.regions;
    model_options.num_part_regions = regional.num_bone_regions;
    if (regional.skin_features) {
      features.conservativeResize(Eigen::NoChange,
                                  data.features.cols() + regional.skin_rows.cols());
      features.rightCols(regional.skin_rows.cols()) = regional.skin_rows;
    }
  }
  PLEAT_ASSIGN_OR_RETURN(
      DetailModel model,
      TrainDetailModel(features, data.details, data.clip_starts, model_options, nullptr, progress));
  // That of a regional model has kept one output only.
  if (direct_gp && learner == LearnerChoice::kGp && !*direct_gp) {
    *direct_gp = model.stages().front();
  }
  return std::make_shared<const DetailModel>(std::move(model));
}

absl::StatusOr<LearnerChoice> ChooseLearner(const LearningData& data, const Rig& rig,
                                            const TrainOptions& options, double diagonal_m,
                                            LearnerValidation* validation,
                                            const Progress& progress) {
  if (options.learner != LearnerChoice::kAuto) return options.learner;
  const int num_rows = static_cast<int>(data.features.rows());
  if (num_rows < kMinFramesToValidate) return LearnerChoice::kGp;
  const RowSplit split = HoldOutBlocks(num_rows, data.clip_starts);
  // The rows are held out, but not the basis of the details: it comes from all training frames and
  // is the same for every candidate.
  LearningData part;
  part.features = data.features(split.train, Eigen::all);
  part.regional = data.regional.OfRows(split.train);
  part.details = data.details;
  part.details.scores = data.details.scores(split.train, Eigen::all);
  part.clip_starts = split.train_clip_starts;
  part.feature_groups = data.feature_groups;
  part.differential = data.differential;
  const std::vector<LearnerChoice> candidates = {LearnerChoice::kGp, LearnerChoice::kRegional,
                                                 LearnerChoice::kSgplvm};
  DirectGp direct_gp;
  std::optional<LearnerChoice> best;
  double best_error = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < candidates.size(); ++i) {
    const double begin = static_cast<double>(i) / candidates.size();
    PLEAT_ASSIGN_OR_RETURN(
        const std::shared_ptr<const DetailModel> model,
        LearnDetails(part, rig, candidates[i], options,
                     progress.Stage(absl::StrCat("validate ", ChoiceName(candidates[i])), begin,
                                    begin + 1.0 / candidates.size()),
                     &direct_gp));
    const double error = HeldOutError(*model, data, split.held_out);
    if (validation) {
      validation->num_held_out_frames = static_cast<int>(split.held_out.size());
      validation->mean_percent[ChoiceName(candidates[i])] = 100 * error / diagonal_m;
    }
    if (error < best_error) {
      best_error = error;
      best = candidates[i];
    }
  }
  if (!best) return absl::FailedPreconditionError("no learner gave a finite validation error");
  return *best;
}

}  // namespace pleat
