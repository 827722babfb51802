// What turns a pose into a detail: a chain of Gaussian processes and a basis of details.
//
//   gp        features -> coefficients
//   sgplvm    features -> latent point (the paper's back-map) -> coefficients
//   ridge     features -> coefficients, linear
//   regional  features -> coefficients, a sum over body regions, mixed with a share of gp
//   detail  = mean + basis * coefficients
//
// Source: the paper, section IV-B (prediction); method.md 5.5, 5.6 (confidence and fading).
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/gp/gp_regression.h"
#include "pleat/gp/regional_gp.h"
#include "pleat/gp/ridge.h"
#include "pleat/gp/shared_gplvm.h"

namespace pleat {

enum class Learner {
  kGp,        // direct regression with an RBF + linear kernel
  kSgplvm,    // the paper's shared GPLVM
  kRegional,  // regression per body region, additive over near and far joints
  kRidge,     // linear regression
};
inline constexpr std::array kAllLearners = {Learner::kGp, Learner::kSgplvm, Learner::kRegional,
                                            Learner::kRidge};

// A part of the body that the regional learner predicts by itself.
struct DetailRegion {
  // D_M: the share of every entry of Y_M that belongs to the region; over all regions the sum is 1.
  Eigen::VectorXd weights;
  std::vector<std::vector<int>> feature_sets;  // columns of Y_S, as in GpRegion
};

// "gp", "sgplvm", "regional", "ridge".
std::string LearnerName(Learner learner);

struct DetailModelOptions {
  Learner learner = Learner::kGp;
  GpRegressionOptions gp{};             // of the direct learner
  SharedGplvmOptions sgplvm{};          // of the shared GPLVM
  RidgeOptions ridge{};                 // of the linear learner
  RegionalGpOptions regional{};         // of the regional learner
  std::vector<DetailRegion> regions{};  // what it needs; may be empty for the others
  // Of Y_S -> X, after training. With back-constraints the constraint itself is the map.
  GpRegressionOptions back_map{.kernel = {.bias = true, .linear = false}};

  // Details are predicted in the basis of their principal components: as many as this share of
  // the energy needs, up to a cap.
  double pca_energy = .9999;
  int max_components = 128;

  // Y_M may be in other coordinates than the predictions shall be: this linear map of columns
  // (D_M x k) takes mean and basis there. None: as they are.
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)> output_map{};

  // The direct GP of the same features, details, energy and components, when a model of learner gp
  // or regional has trained it before: taken as it is. Must outlive the training.
  const GpRegression* trained_gp = nullptr;

  // Of the regional learner, the rest is the direct GP's: the mean of two models errs less than
  // either, and the direct GP is what knows how far a pose is from training.
  double regional_share = .75;

  // Below this confidence the prediction fades smoothly to the mean detail. The mean of a Gaussian
  // process falls back by itself; this stops what its linear part could do far away.
  double fade_confidence = .02;
};

struct DetailModelSummary {
  int num_components = 0;
  double kept_energy = 1;  // share of the centred details that the components carry
  GpRegressionSummary gp;  // of the direct learner or the back-map
  SharedGplvmSummary sgplvm;
  double training_rms = 0;  // over all entries of Y_M, unit of Y_M, of the model's own predictions
};

// Everything in a model: what a model file holds.
struct DetailModelParameters {
  Learner learner = Learner::kGp;
  std::vector<GpRegressionParameters> stages;  // one or two, applied in this order
  Eigen::VectorXf mean;                        // D_M, unit of Y_M
  Eigen::MatrixXf basis;                       // D_M x r; orthonormal as trained
  double fade_confidence = .02;
  double regional_share = 0;                     // of `regional` in the prediction, 0..1
  std::optional<RegionalGpParameters> regional;  // with Learner::kRegional only
};

// Immutable: queries share it without locks.
class DetailModel {
 public:
  // What one thread needs for its queries; reused without allocation.
  struct Workspace {
    std::vector<GpRegression::Workspace> stages;
    Eigen::VectorXd latent;        // q
    Eigen::VectorXd coefficients;  // r
    Eigen::VectorXf single;        // r
    RegionalGp::Workspace regional;
    Eigen::VectorXd regional_coefficients;  // r
  };

  // kInvalidArgument when sizes do not fit together or a number is not finite.
  static absl::StatusOr<DetailModel> FromParameters(DetailModelParameters parameters);
  DetailModelParameters parameters() const;

  Learner learner() const { return learner_; }
  int num_features() const { return stages_.front().num_inputs(); }       // D_S
  int num_components() const { return static_cast<int>(basis_.cols()); }  // r
  int num_details() const { return static_cast<int>(basis_.rows()); }     // D_M
  const Eigen::VectorXf& mean() const { return mean_; }
  const Eigen::MatrixXf& basis() const { return basis_; }
  const std::vector<GpRegression>& stages() const { return stages_; }
  double fade_confidence() const { return fade_confidence_; }
  const std::optional<RegionalGp>& regional() const { return regional_; }

  // Coefficients (r) of the detail at a feature row (D_S), faded; returns the confidence: 1 at the
  // training poses, 0 where they say nothing. No allocation after the first call.
  double PredictCoefficients(const Eigen::Ref<const Eigen::VectorXd>& features,
                             Workspace* workspace, Eigen::Ref<Eigen::VectorXf> coefficients) const;

  // The same expanded: detail (D_M), unit of Y_M.
  double Predict(const Eigen::Ref<const Eigen::VectorXd>& features, Workspace* workspace,
                 Eigen::Ref<Eigen::VectorXf> detail) const;

 private:
  DetailModel() = default;

  Learner learner_ = Learner::kGp;
  std::vector<GpRegression> stages_;
  Eigen::VectorXf mean_;
  Eigen::MatrixXf basis_;
  double fade_confidence_ = 0;
  double regional_share_ = 0;
  std::optional<RegionalGp> regional_;

  friend class DetailModelTrainer;
};

// Learns from features Y_S (N x D_S) and details Y_M (N x D_M), row t = frame t; `clip_starts`
// holds the first row of each clip. Errors: kInvalidArgument for sizes or values; kCancelled.
absl::StatusOr<DetailModel> TrainDetailModel(const Eigen::Ref<const Eigen::MatrixXd>& features,
                                             const Eigen::Ref<const Eigen::MatrixXd>& details,
                                             const std::vector<int>& clip_starts,
                                             const DetailModelOptions& options = {},
                                             DetailModelSummary* summary = nullptr,
                                             const Progress& progress = {});

}  // namespace pleat
