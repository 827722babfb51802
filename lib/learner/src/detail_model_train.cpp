#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/learner/detail_model.h"
#include "pleat/math/clip_starts.h"
#include "pleat/math/pca.h"
#include "pleat/math/spread_rows.h"
#include "regional_training.h"
#include "score_pca.h"

namespace pleat {
namespace {

absl::Status CheckTrainingData(const Eigen::Ref<const Eigen::MatrixXd>& features,
                               const PrincipalComponents& details,
                               const std::vector<int>& clip_starts,
                               const DetailModelOptions& options) {
  const Eigen::Index num_details = details.mean.size();
  if (features.rows() != details.scores.rows() || features.rows() < 2 || features.cols() < 1 ||
      num_details < 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("a detail model needs at least two frames of features and details, got ",
                     features.rows(), " x ", features.cols(), " features and ",
                     details.scores.rows(), " x ", num_details, " details"));
  }
  if (details.basis.rows() != num_details || details.basis.cols() != details.scores.cols()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the basis of the details is ", details.basis.rows(), " x ", details.basis.cols(),
        ", expected ", num_details, " x ", details.scores.cols()));
  }
  if (!features.allFinite() || !details.mean.allFinite() || !details.basis.allFinite() ||
      !details.scores.allFinite()) {
    return absl::InvalidArgumentError("features or details hold a value that is not finite");
  }
  if (!(options.fade_confidence >= 0 && options.fade_confidence <= 1) || !(options.rounding >= 0)) {
    return absl::InvalidArgumentError(
        "a detail model needs a fading confidence in [0, 1] and a rounding of at least 0");
  }
  if (options.num_pose_features < 0 || options.num_pose_features > features.cols()) {
    return absl::InvalidArgumentError(
        absl::StrCat(options.num_pose_features, " features of the pose among ", features.cols()));
  }
  if (options.learner == Learner::kRegional && options.regions.empty()) {
    return absl::InvalidArgumentError("the regional learner needs regions");
  }
  for (const DetailRegion& region : options.regions) {
    if (region.rows.empty() ||
        region.weights.size() != static_cast<Eigen::Index>(region.rows.size()) ||
        region.rows.front() < 0 || region.rows.back() >= num_details ||
        std::adjacent_find(region.rows.begin(), region.rows.end(), std::greater_equal<>()) !=
            region.rows.end()) {
      return absl::InvalidArgumentError(
          absl::StrCat("a region has ", region.weights.size(), " weights for ", region.rows.size(),
                       " details, or they do not ascend below ", num_details));
    }
  }
  if (options.num_part_regions < 0 ||
      options.num_part_regions > static_cast<int>(options.regions.size())) {
    return absl::InvalidArgumentError(absl::StrCat(
        options.num_part_regions, " of ", options.regions.size(), " regions make the parts"));
  }
  return CheckClipStarts(clip_starts, features.rows());
}

// Rows spread evenly over all clips, and which of them begin a clip.
struct SpreadClips {
  std::vector<Eigen::Index> rows;
  std::vector<int> clip_starts;
};

SpreadClips SpreadOverClips(Eigen::Index num_rows, const std::vector<int>& clip_starts,
                            int max_rows) {
  SpreadClips spread{SpreadRows(num_rows, max_rows), {}};
  for (const int start : clip_starts) {
    const auto first = std::lower_bound(spread.rows.begin(), spread.rows.end(), start);
    const int row = static_cast<int>(first - spread.rows.begin());
    if (first == spread.rows.end() ||
        (!spread.clip_starts.empty() && spread.clip_starts.back() == row))
      continue;
    spread.clip_starts.push_back(row);
  }
  return spread;
}

// The back-constraint X = K_b A as a regression stage: same kernel, same weights.
absl::StatusOr<GpRegression> BackConstraintStage(const Eigen::Ref<const Eigen::MatrixXd>& features,
                                                 const SharedGplvm& model,
                                                 const SharedGplvmOptions& options) {
  KernelLogs logs{.inverse_width = model.back_log_inverse_width,
                  .amplitude = 0,
                  .noise = std::log(options.back_noise)};
  // Normalizing rescales the inputs; the kernel's width follows. Poses that never differ have no
  // scale and stay as they are.
  const Eigen::MatrixXd centered = features.rowwise() - features.colwise().mean();
  const double mean_square = centered.squaredNorm() / double(centered.rows());
  if (mean_square > 0) logs.inverse_width += std::log(mean_square);
  PLEAT_ASSIGN_OR_RETURN(const GpRegression fitted,
                         GpRegression::Condition(features, model.latents, logs,
                                                 {.kernel = {.bias = false, .linear = false}}));
  GpRegressionParameters p = fitted.parameters();
  p.output_mean.setZero();
  p.alpha = model.back_weights / p.output_scale;
  return GpRegression::FromParameters(std::move(p));
}

}  // namespace

class DetailModelTrainer {
 public:
  DetailModelTrainer(const Eigen::Ref<const Eigen::MatrixXd>& features,
                     const PrincipalComponents& details, const std::vector<int>& clip_starts,
                     const DetailModelOptions& options, DetailModelSummary& summary,
                     const Progress& progress)
      : features_(features),
        pose_features_(features.leftCols(options.num_pose_features > 0 ? options.num_pose_features
                                                                       : features.cols())),
        fine_details_(details),
        details_(FirstComponents(details, options.max_components, options.pca_energy)),
        clip_starts_(clip_starts),
        options_(options),
        summary_(summary),
        progress_(progress) {}

  absl::StatusOr<DetailModel> Train() {
    model_.learner_ = options_.learner;
    model_.fade_confidence_ = options_.fade_confidence;
    if (options_.learner != Learner::kRegional) PLEAT_RETURN_IF_ERROR(MakeBasis());
    PLEAT_RETURN_IF_ERROR(progress_.Stage("basis", 0, .1).Report(1));
    if (options_.learner == Learner::kSgplvm) {
      PLEAT_RETURN_IF_ERROR(TrainSgplvm());
    } else if (options_.learner == Learner::kRidge) {
      PLEAT_RETURN_IF_ERROR(TrainRidge());
    } else {
      PLEAT_RETURN_IF_ERROR(TrainGp());
    }
    if (options_.learner == Learner::kRegional) PLEAT_RETURN_IF_ERROR(TrainRegions());
    summary_.num_components = model_.num_components();
    PLEAT_RETURN_IF_ERROR(MeasureTraining());
    PLEAT_RETURN_IF_ERROR(progress_.Stage("done", 0, 1).Report(1));
    return std::move(model_);
  }

 private:
  Eigen::MatrixXd Mapped(const Eigen::MatrixXd& columns) const {
    return options_.output_map ? options_.output_map(columns) : columns;
  }

  // The basis of all learners but the regional one: the components of all details.
  absl::Status MakeBasis() {
    const Eigen::MatrixXd basis = Mapped(details_.basis);
    const Eigen::VectorXd score_rms =
        (details_.scores.colwise().squaredNorm() / double(details_.scores.rows())).cwiseSqrt();
    PLEAT_ASSIGN_OR_RETURN(
        const DetailBasis rounded,
        DetailBasis::Quantize(
            Mapped(details_.mean).cast<float>(), basis,
            LargestSteps(score_rms, DetailRms(basis, score_rms), options_.rounding)));
    PLEAT_ASSIGN_OR_RETURN(model_.basis_, PartedBasis::FromParameters(
                                              PartedBasisParameters::Whole(rounded.parameters())));
    return absl::OkStatus();
  }

  absl::Status TrainRidge() {
    PLEAT_ASSIGN_OR_RETURN(GpRegression stage,
                           TrainRidgeGp(pose_features_, details_.scores, options_.ridge));
    model_.stages_.push_back(std::move(stage));
    return absl::OkStatus();
  }

  absl::Status TrainGp() {
    if (options_.trained_gp) {
      if (options_.trained_gp->num_inputs() != pose_features_.cols() ||
          options_.trained_gp->num_outputs() != details_.scores.cols()) {
        return absl::InvalidArgumentError("the trained GP has other inputs or outputs");
      }
      model_.stages_.push_back(*options_.trained_gp);
      return absl::OkStatus();
    }
    const double end = options_.learner == Learner::kRegional ? .3 : .95;
    PLEAT_ASSIGN_OR_RETURN(GpRegression stage,
                           GpRegression::Train(pose_features_, details_.scores, options_.gp,
                                               &summary_.gp, progress_.Stage("gp", .1, end)));
    model_.stages_.push_back(std::move(stage));
    return absl::OkStatus();
  }

  absl::Status TrainRegions() {
    // What the direct GP has learned about the joints holds for their parts of the body too.
    GpRegressionParameters direct = model_.stages_.front().parameters();
    PLEAT_ASSIGN_OR_RETURN(RegionalTraining training,
                           TrainRegional(features_, fine_details_, direct.input_scales, options_,
                                         progress_.Stage("regions", .3, .95)));
    PLEAT_ASSIGN_OR_RETURN(model_.basis_, PartedBasis::FromParameters(training.basis));
    PLEAT_ASSIGN_OR_RETURN(model_.regional_,
                           RegionalGp::FromParameters(std::move(training.regional)));
    PLEAT_ASSIGN_OR_RETURN(
        model_.fold_,
        CoefficientFold::FromBlocks(std::move(training.fold), model_.regional_->num_outputs(),
                                    model_.basis_.num_coefficients()));
    scores_to_coefficients_ = std::move(training.scores_to_coefficients);
    // Only the variance of the direct GP is asked for, so one output is enough.
    direct.alpha = direct.alpha.leftCols(1).eval();
    direct.output_mean = direct.output_mean.head(1).eval();
    PLEAT_ASSIGN_OR_RETURN(model_.stages_.front(), GpRegression::FromParameters(std::move(direct)));
    model_.regional_share_ = 1;
    model_.fade_confidence_ = 0;
    return absl::OkStatus();
  }

  absl::Status TrainSgplvm() {
    const SharedGplvmOptions& options = options_.sgplvm;
    // A latent point for every frame is too many where there are thousands.
    const SpreadClips part = SpreadOverClips(features_.rows(), clip_starts_, options_.max_latents);
    const Eigen::MatrixXd features = pose_features_(part.rows, Eigen::all);
    const Eigen::MatrixXd scores = details_.scores(part.rows, Eigen::all);
    PLEAT_ASSIGN_OR_RETURN(
        const SharedGplvm latent,
        TrainSharedGplvm(features, MakeDetailView(details_, part.rows, options.scaling),
                         part.clip_starts, options, &summary_.sgplvm,
                         progress_.Stage("sgplvm", .1, .85)));
    if (options.back_constraints) {
      PLEAT_ASSIGN_OR_RETURN(GpRegression stage, BackConstraintStage(features, latent, options));
      model_.stages_.push_back(std::move(stage));
    } else {
      PLEAT_ASSIGN_OR_RETURN(
          GpRegression stage,
          GpRegression::Train(features, latent.latents, options_.back_map, &summary_.gp,
                              progress_.Stage("back-map", .85, .95)));
      model_.stages_.push_back(std::move(stage));
    }
    PLEAT_ASSIGN_OR_RETURN(
        GpRegression stage,
        GpRegression::Condition(latent.latents, scores, latent.detail_kernel,
                                {.kernel = latent.detail_options, .normalize_inputs = false}));
    model_.stages_.push_back(std::move(stage));
    return absl::OkStatus();
  }

  // RMS of the model on its own training frames; the dropped components count in full.
  absl::Status MeasureTraining() {
    const bool regional = options_.learner == Learner::kRegional;
    const PrincipalComponents& details = regional ? fine_details_ : details_;
    DetailModel::Workspace workspace;
    Eigen::VectorXd row, truth;
    Eigen::VectorXf coefficients(model_.num_components());
    const Eigen::RowVectorXd mean = details.scores.colwise().mean();
    double squares = 0, kept = 0;
    for (Eigen::Index i = 0; i < features_.rows(); ++i) {
      if (i % 64 == 0)
        PLEAT_RETURN_IF_ERROR(
            progress_.Stage("check", .95, 1).Report(double(i) / double(features_.rows())));
      row = features_.row(i).head(model_.num_features()).transpose();
      model_.PredictCoefficients(row, &workspace, coefficients);
      truth = details.scores.row(i).transpose();
      if (regional) truth = scores_to_coefficients_ * (truth - mean.transpose());
      kept += truth.squaredNorm();
      squares += (coefficients.cast<double>() - truth).squaredNorm();
    }
    const double energy = details.kept_energy;
    if (energy > 0) squares += kept * (1 - energy) / energy;
    summary_.training_rms =
        std::sqrt(squares / (double(features_.rows()) * double(details.mean.size())));
    summary_.kept_energy = energy;
    return absl::OkStatus();
  }

  const Eigen::Ref<const Eigen::MatrixXd>& features_;
  const Eigen::MatrixXd pose_features_;  // the leading columns
  const PrincipalComponents& fine_details_;
  const PrincipalComponents details_;       // the first components of the fine ones
  Eigen::MatrixXd scores_to_coefficients_;  // of the regional learner
  const std::vector<int>& clip_starts_;
  const DetailModelOptions& options_;
  DetailModelSummary& summary_;
  const Progress& progress_;
  DetailModel model_;
};

absl::StatusOr<DetailModel> TrainDetailModel(const Eigen::Ref<const Eigen::MatrixXd>& features,
                                             const PrincipalComponents& details,
                                             const std::vector<int>& clip_starts,
                                             const DetailModelOptions& options,
                                             DetailModelSummary* summary,
                                             const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckTrainingData(features, details, clip_starts, options));
  if (details.scores.cols() == 0) {  // all details are the same: one component that stays zero
    PrincipalComponents constant{details.mean, Eigen::VectorXd::Unit(details.mean.size(), 0),
                                 Eigen::VectorXd::Zero(features.rows()), 1};
    return TrainDetailModel(features, constant, clip_starts, options, summary, progress);
  }
  DetailModelSummary local;
  return DetailModelTrainer(features, details, clip_starts, options, summary ? *summary : local,
                            progress)
      .Train();
}

absl::StatusOr<DetailModel> TrainDetailModel(const Eigen::Ref<const Eigen::MatrixXd>& features,
                                             const Eigen::Ref<const Eigen::MatrixXd>& details,
                                             const std::vector<int>& clip_starts,
                                             const DetailModelOptions& options,
                                             DetailModelSummary* summary,
                                             const Progress& progress) {
  if (!details.allFinite()) {
    return absl::InvalidArgumentError("features or details hold a value that is not finite");
  }
  if (options.max_components < 1 || !(options.pca_energy > 0) || !(options.pca_energy <= 1)) {
    return absl::InvalidArgumentError(
        "a detail model needs at least one component and an energy in (0, 1]");
  }
  const bool regional = options.learner == Learner::kRegional;
  const int max_components =
      regional ? std::max(options.max_components, options.regional_basis.max_components)
               : options.max_components;
  return TrainDetailModel(features,
                          ComputePca(details, {.max_components = max_components,
                                               .min_energy = regional ? 1 : options.pca_energy}),
                          clip_starts, options, summary, progress);
}

}  // namespace pleat
