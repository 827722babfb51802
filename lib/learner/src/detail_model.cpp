#include "pleat/learner/detail_model.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr size_t kMostTogether = 16;  // queries

absl::Status RefuseModel(const std::string& what) {
  return absl::InvalidArgumentError("detail model parameters: " + what);
}

// 1 where `stage` is sure, 0 where it knows no more than its prior; also 0 for not a number.
double Confidence(double variance, const GpRegression& stage) {
  const double confidence = std::min(1 - variance / stage.prior_variance(), 1.0);
  return confidence > 0 ? confidence : 0;
}

// 0 at 0, 1 from `full` on, smooth between.
double Fade(double confidence, double full) {
  if (confidence >= full) return 1;
  const double t = confidence / full;
  return t * t * (3 - 2 * t);
}

}  // namespace

std::string LearnerName(Learner learner) {
  switch (learner) {
    case Learner::kGp:
      return "gp";
    case Learner::kSgplvm:
      return "sgplvm";
    case Learner::kRegional:
      return "regional";
    case Learner::kRidge:
      return "ridge";
  }
  return "unknown";
}

absl::StatusOr<DetailModel> DetailModel::FromParameters(DetailModelParameters parameters) {
  const size_t expected = parameters.learner == Learner::kSgplvm ? 2 : 1;
  if (parameters.stages.size() != expected) {
    return RefuseModel(absl::StrCat("the learner ", LearnerName(parameters.learner), " has ",
                                    expected, " stages, got ", parameters.stages.size()));
  }
  DetailModel model;
  for (GpRegressionParameters& stage : parameters.stages) {
    PLEAT_ASSIGN_OR_RETURN(GpRegression regression, GpRegression::FromParameters(std::move(stage)));
    model.stages_.push_back(std::move(regression));
  }
  if (expected == 2 && model.stages_[0].num_outputs() != model.stages_[1].num_inputs()) {
    return RefuseModel(absl::StrCat("the first stage has ", model.stages_[0].num_outputs(),
                                    " outputs, the second ", model.stages_[1].num_inputs(),
                                    " inputs"));
  }
  PLEAT_ASSIGN_OR_RETURN(model.basis_, PartedBasis::FromParameters(parameters.basis));
  if (!(parameters.fade_confidence >= 0 && parameters.fade_confidence <= 1)) {
    return RefuseModel("the fading confidence is not between 0 and 1");
  }
  if (parameters.regional.has_value() != (parameters.learner == Learner::kRegional) ||
      !(parameters.regional_share >= 0 && parameters.regional_share <= 1)) {
    return RefuseModel(
        "regions and learner do not belong together, or their share is not in 0 to 1");
  }
  if (parameters.fold.empty() &&
      model.basis_.num_coefficients() != model.stages_.back().num_outputs()) {
    return RefuseModel(absl::StrCat("the basis has ", model.basis_.num_coefficients(),
                                    " components, the last stage ",
                                    model.stages_.back().num_outputs(), " outputs"));
  }
  if (parameters.regional) PLEAT_RETURN_IF_ERROR(model.TakeRegional(&parameters));
  model.regional_share_ = parameters.regional_share;
  model.learner_ = parameters.learner;
  model.fade_confidence_ = parameters.fade_confidence;
  return model;
}

absl::Status DetailModel::TakeRegional(DetailModelParameters* parameters) {
  PLEAT_ASSIGN_OR_RETURN(regional_, RegionalGp::FromParameters(*std::move(parameters->regional)));
  if (!parameters->fold.empty()) {
    PLEAT_ASSIGN_OR_RETURN(
        fold_, CoefficientFold::FromBlocks(std::move(parameters->fold), regional_->num_outputs(),
                                           basis_.num_coefficients()));
    if (regional_->num_inputs() >= stages_[0].num_inputs()) return absl::OkStatus();
  } else if (regional_->num_inputs() == stages_[0].num_inputs() &&
             regional_->num_outputs() == stages_[0].num_outputs()) {
    return absl::OkStatus();
  }
  return RefuseModel("the regions have other inputs or outputs than the first stage");
}

DetailModelParameters DetailModel::parameters() const {
  DetailModelParameters p;
  p.learner = learner_;
  for (const GpRegression& stage : stages_) p.stages.push_back(stage.parameters());
  p.basis = basis_.parameters();
  p.fade_confidence = fade_confidence_;
  p.regional_share = regional_share_;
  if (regional_) p.regional = regional_->parameters();
  if (fold_) p.fold = fold_->blocks();
  return p;
}

DetailModel::Certainty DetailModel::PredictStages(const Eigen::Ref<const Eigen::VectorXd>& features,
                                                  Workspace* workspace) const {
  Workspace& w = *workspace;
  w.stages.resize(stages_.size());
  w.outputs.resize(stages_.back().num_outputs());
  double variance = 0;
  double fade_confidence = 0;
  if (stages_.size() == 1) {
    stages_[0].Predict(features, 0, &w.stages[0], w.outputs, &variance);
    fade_confidence = Confidence(variance, stages_[0]);
  } else {
    w.latent.resize(stages_[0].num_outputs());
    double latent_variance = 0;
    stages_[0].Predict(features, 0, &w.stages[0], w.latent, &latent_variance);
    stages_[1].Predict(w.latent, latent_variance, &w.stages[1], w.outputs, &variance);
    // The first-order variance is too careful to fade by: where the detail varies fast along the
    // latent points it is above the prior long before the back-map is lost.
    fade_confidence = Confidence(latent_variance, stages_[0]);
  }
  return {.confidence = Confidence(variance, stages_.back()),
          .fade = Fade(fade_confidence, fade_confidence_)};
}

// Takes what the regions predict at workspace->regional's rows: with a fold it is the prediction,
// else it has its share beside that of the stage.
void DetailModel::PredictRegional(std::span<Workspace* const> workspaces) const {
  std::array<RegionalGp::Workspace*, kMostTogether> regional{};
  std::array<double*, kMostTogether> means{};
  std::array<CoefficientFold::Query, kMostTogether> folds;
  for (size_t q = 0; q < workspaces.size(); ++q) {
    workspaces[q]->regional_outputs.resize(regional_->num_outputs());
    regional[q] = &workspaces[q]->regional;
    means[q] = workspaces[q]->regional_outputs.data();
  }
  regional_->PredictRows({regional.data(), workspaces.size()}, {means.data(), workspaces.size()});
  for (size_t q = 0; q < workspaces.size(); ++q) {
    Workspace& w = *workspaces[q];
    if (!fold_) {
      w.coefficients = w.outputs + regional_share_ * (w.regional_outputs - w.outputs);
      continue;
    }
    w.single_regional = w.regional_outputs.cast<float>();
    w.folded.resize(num_components());
    folds[q] = {
        .inputs = w.single_regional.data(), .outputs = w.folded.data(), .workspace = &w.fold};
  }
  if (!fold_) return;
  fold_->Apply({folds.data(), workspaces.size()});
  for (Workspace* w : workspaces) w->coefficients = w->folded.cast<double>();
}

double DetailModel::PredictCoefficients(const Eigen::Ref<const Eigen::VectorXd>& features,
                                        Workspace* workspace,
                                        Eigen::Ref<Eigen::VectorXf> coefficients) const {
  assert(coefficients.size() == num_components());
  Query query{
      .features = features.data(), .workspace = workspace, .coefficients = coefficients.data()};
  PredictCoefficients({&query, 1});
  return query.confidence;
}

void DetailModel::PredictCoefficients(std::span<Query> queries) const {
  for (size_t begin = 0; begin < queries.size(); begin += kMostTogether) {
    const std::span<Query> part =
        queries.subspan(begin, std::min(kMostTogether, queries.size() - begin));
    std::array<Certainty, kMostTogether> certainties;
    std::array<Workspace*, kMostTogether> workspaces{};
    for (size_t q = 0; q < part.size(); ++q) {
      const Eigen::Map<const Eigen::VectorXd> features(part[q].features, num_features());
      workspaces[q] = part[q].workspace;
      certainties[q] = PredictStages(features.head(num_pose_features()), workspaces[q]);
      if (regional_) regional_->SetRow(features, &workspaces[q]->regional);
    }
    if (regional_) {
      PredictRegional({workspaces.data(), part.size()});
    } else {
      for (size_t q = 0; q < part.size(); ++q) workspaces[q]->coefficients = workspaces[q]->outputs;
    }
    for (size_t q = 0; q < part.size(); ++q) {
      Eigen::Map<Eigen::VectorXf> coefficients(part[q].coefficients, num_components());
      part[q].confidence = certainties[q].confidence;
      coefficients = (certainties[q].fade * workspaces[q]->coefficients).cast<float>();
      // What a hostile model makes of a pose, or a pose beyond all bounds, may not be finite.
      if (!(certainties[q].fade > 0) || !coefficients.allFinite()) coefficients.setZero();
    }
  }
}

double DetailModel::Predict(const Eigen::Ref<const Eigen::VectorXd>& features, Workspace* workspace,
                            Eigen::Ref<Eigen::VectorXf> detail) const {
  assert(detail.size() == num_details());
  workspace->single.resize(num_components());
  const double confidence = PredictCoefficients(features, workspace, workspace->single);
  basis_.SetCoefficients(workspace->single, &workspace->query);
  basis_.Expand(workspace->query, detail);
  return confidence;
}

}  // namespace pleat
