#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/gp/detail_model.h"
#include "pleat/math/pca.h"

namespace pleat {
namespace {

absl::Status CheckData(const Eigen::Ref<const Eigen::MatrixXd>& features,
                       const Eigen::Ref<const Eigen::MatrixXd>& details,
                       const std::vector<int>& clip_starts, const DetailModelOptions& options) {
  if (features.rows() != details.rows() || features.rows() < 2 || features.cols() < 1 ||
      details.cols() < 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("a detail model needs at least two frames of features and details, got ",
                     features.rows(), " x ", features.cols(), " features and ", details.rows(),
                     " x ", details.cols(), " details"));
  }
  if (!features.allFinite() || !details.allFinite()) {
    return absl::InvalidArgumentError("features or details hold a value that is not finite");
  }
  if (options.max_components < 1 || !(options.pca_energy > 0) || !(options.pca_energy <= 1) ||
      !(options.fade_confidence >= 0 && options.fade_confidence <= 1)) {
    return absl::InvalidArgumentError(
        "a detail model needs at least one component, an energy in (0, 1] and a fading confidence "
        "in [0, 1]");
  }
  if (options.learner == Learner::kRegional && options.regions.empty()) {
    return absl::InvalidArgumentError("the regional learner needs regions");
  }
  for (const DetailRegion& region : options.regions) {
    if (region.weights.size() != details.cols()) {
      return absl::InvalidArgumentError(absl::StrCat("a region has ", region.weights.size(),
                                                     " weights for ", details.cols(), " details"));
    }
  }
  return CheckClipStarts(clip_starts, features.rows());
}

// The back-constraint X = K_b A as a regression stage: same kernel, same weights.
absl::StatusOr<GpRegression> BackConstraintStage(const Eigen::Ref<const Eigen::MatrixXd>& features,
                                                 const SharedGplvm& model,
                                                 const SharedGplvmOptions& options) {
  KernelLogs logs{.inverse_width = model.back_log_inverse_width,
                  .amplitude = 0,
                  .noise = std::log(options.back_noise)};
  // Normalising rescales the inputs; the kernel's width follows.
  const Eigen::MatrixXd centred = features.rowwise() - features.colwise().mean();
  logs.inverse_width += std::log(centred.squaredNorm() / double(centred.rows()));
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
                     const Eigen::Ref<const Eigen::MatrixXd>& details,
                     const std::vector<int>& clip_starts, const DetailModelOptions& options,
                     DetailModelSummary& summary, const Progress& progress)
      : features_(features),
        details_(details),
        clip_starts_(clip_starts),
        options_(options),
        summary_(summary),
        progress_(progress) {}

  absl::StatusOr<DetailModel> Train() {
    PrincipalComponents pca = ComputePca(
        details_, {.max_components = options_.max_components, .min_energy = options_.pca_energy});
    if (pca.scores.cols() == 0) {  // all details are the same: one component that stays zero
      pca.scores.setZero(details_.rows(), 1);
      pca.basis = Eigen::VectorXd::Unit(details_.cols(), 0);
    }
    PLEAT_RETURN_IF_ERROR(progress_.Stage("pca", 0, .1).Report(1));
    model_.learner_ = options_.learner;
    model_.mean_ = Mapped(pca.mean).cast<float>();
    model_.basis_ = Mapped(pca.basis).cast<float>();
    model_.fade_confidence_ = options_.fade_confidence;
    summary_.num_components = static_cast<int>(pca.basis.cols());
    summary_.kept_energy = pca.kept_energy;
    if (options_.learner == Learner::kSgplvm) {
      PLEAT_RETURN_IF_ERROR(TrainSgplvm(pca.scores));
    } else if (options_.learner == Learner::kRidge) {
      PLEAT_RETURN_IF_ERROR(TrainRidge(pca.scores));
    } else {
      PLEAT_RETURN_IF_ERROR(TrainGp(pca.scores));
    }
    if (options_.learner == Learner::kRegional) PLEAT_RETURN_IF_ERROR(TrainRegional(pca));
    PLEAT_RETURN_IF_ERROR(MeasureTraining(pca));
    PLEAT_RETURN_IF_ERROR(progress_.Stage("done", 0, 1).Report(1));
    return std::move(model_);
  }

 private:
  Eigen::MatrixXd Mapped(const Eigen::MatrixXd& columns) const {
    return options_.output_map ? options_.output_map(columns) : columns;
  }

  absl::Status TrainRidge(const Eigen::MatrixXd& scores) {
    PLEAT_ASSIGN_OR_RETURN(GpRegression stage, TrainRidgeGp(features_, scores, options_.ridge));
    model_.stages_.push_back(std::move(stage));
    return absl::OkStatus();
  }

  absl::Status TrainGp(const Eigen::MatrixXd& scores) {
    if (options_.trained_gp) {
      if (options_.trained_gp->num_inputs() != features_.cols() ||
          options_.trained_gp->num_outputs() != scores.cols()) {
        return absl::InvalidArgumentError("the trained GP has other inputs or outputs");
      }
      model_.stages_.push_back(*options_.trained_gp);
      return absl::OkStatus();
    }
    const double end = options_.learner == Learner::kRegional ? .3 : .95;
    PLEAT_ASSIGN_OR_RETURN(GpRegression stage,
                           GpRegression::Train(features_, scores, options_.gp, &summary_.gp,
                                               progress_.Stage("gp", .1, end)));
    model_.stages_.push_back(std::move(stage));
    return absl::OkStatus();
  }

  // A region's outputs are its share of the details in the common basis, so that the regions add up
  // to coefficients and a query expands them once.
  absl::Status TrainRegional(const PrincipalComponents& pca) {
    const Eigen::MatrixXd centred = details_.rowwise() - pca.mean.transpose();
    std::vector<GpRegion> regions;
    for (const DetailRegion& region : options_.regions) {
      regions.push_back({region.feature_sets, centred * (region.weights.asDiagonal() * pca.basis)});
    }
    PLEAT_ASSIGN_OR_RETURN(model_.regional_,
                           RegionalGp::Train(features_, regions, options_.regional,
                                             progress_.Stage("regions", .3, .95)));
    model_.regional_share_ = options_.regional_share;
    return absl::OkStatus();
  }

  absl::Status TrainSgplvm(const Eigen::MatrixXd& scores) {
    const SharedGplvmOptions& options = options_.sgplvm;
    PLEAT_ASSIGN_OR_RETURN(
        const SharedGplvm latent,
        TrainSharedGplvm(features_, MakeDetailView(details_, options.scaling), clip_starts_,
                         options, &summary_.sgplvm, progress_.Stage("sgplvm", .1, .85)));
    if (options.back_constraints) {
      PLEAT_ASSIGN_OR_RETURN(GpRegression stage, BackConstraintStage(features_, latent, options));
      model_.stages_.push_back(std::move(stage));
    } else {
      PLEAT_ASSIGN_OR_RETURN(
          GpRegression stage,
          GpRegression::Train(features_, latent.latents, options_.back_map, &summary_.gp,
                              progress_.Stage("back-map", .85, .95)));
      model_.stages_.push_back(std::move(stage));
    }
    PLEAT_ASSIGN_OR_RETURN(
        GpRegression stage,
        GpRegression::Condition(latent.latents, scores, latent.detail_kernel,
                                {.kernel = latent.detail_options, .normalise_inputs = false}));
    model_.stages_.push_back(std::move(stage));
    return absl::OkStatus();
  }

  // RMS of the model on its own training frames; the dropped components count in full.
  absl::Status MeasureTraining(const PrincipalComponents& pca) {
    DetailModel::Workspace workspace;
    Eigen::VectorXd row(features_.cols());
    Eigen::VectorXf coefficients(model_.num_components());
    double squares = 0;
    for (Eigen::Index i = 0; i < features_.rows(); ++i) {
      if (i % 64 == 0)
        PLEAT_RETURN_IF_ERROR(
            progress_.Stage("check", .95, 1).Report(double(i) / double(features_.rows())));
      row = features_.row(i).transpose();
      model_.PredictCoefficients(row, &workspace, coefficients);
      squares += (coefficients.cast<double>().transpose() - pca.scores.row(i)).squaredNorm();
    }
    const double kept = pca.scores.squaredNorm();
    if (pca.kept_energy > 0) squares += kept * (1 - pca.kept_energy) / pca.kept_energy;
    summary_.training_rms = std::sqrt(squares / double(details_.size()));
    return absl::OkStatus();
  }

  const Eigen::Ref<const Eigen::MatrixXd>& features_;
  const Eigen::Ref<const Eigen::MatrixXd>& details_;
  const std::vector<int>& clip_starts_;
  const DetailModelOptions& options_;
  DetailModelSummary& summary_;
  const Progress& progress_;
  DetailModel model_;
};

absl::StatusOr<DetailModel> TrainDetailModel(const Eigen::Ref<const Eigen::MatrixXd>& features,
                                             const Eigen::Ref<const Eigen::MatrixXd>& details,
                                             const std::vector<int>& clip_starts,
                                             const DetailModelOptions& options,
                                             DetailModelSummary* summary,
                                             const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckData(features, details, clip_starts, options));
  DetailModelSummary local;
  return DetailModelTrainer(features, details, clip_starts, options, summary ? *summary : local,
                            progress)
      .Train();
}

}  // namespace pleat
