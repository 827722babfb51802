// What turns a pose into a detail: a chain of Gaussian processes and a basis of details.
//
//   gp        features -> coefficients
//   sgplvm    features -> latent point (the paper's back-map) -> coefficients
//   ridge     features -> coefficients, linear
//   regional  features -> coefficients, a sum over body regions, mixed with a share of gp
//   detail  = mean + basis * coefficients
//
// Source: the paper, section IV-B (prediction); docs/method/prediction.md#confidence.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/gp/gp_regression.h"
#include "pleat/gp/shared_gplvm.h"
#include "pleat/learner/detail_basis.h"
#include "pleat/learner/regional_gp.h"
#include "pleat/learner/ridge.h"
#include "pleat/math/pca.h"

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
  // Frames that get a latent point each: all, or so many of them, spread evenly.
  int max_latents = 600;
  // Of Y_S -> X, after training. With back-constraints the constraint itself is the map.
  GpRegressionOptions back_map{.kernel = {.bias = true, .linear = false}};

  // Where the details themselves are given: as many principal components as this share of their
  // energy needs, up to a cap.
  double pca_energy = .9999;
  int max_components = 128;
  // The basis is rounded to integers, each component so that its RMS error over the training frames
  // is at most this share of the RMS detail.
  double rounding = 1e-3;

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
  // process falls back by itself; this stops what its linear part could do far away. A narrower
  // band pops: with .02 a detail could be gone within a fifth of a degree (docs/performance.md).
  double fade_confidence = .3;
};

struct DetailModelSummary {
  int num_components = 0;
  double kept_energy = 1;  // share of the centered details that the components carry
  GpRegressionSummary gp;  // of the direct learner or the back-map
  SharedGplvmSummary sgplvm;
  double training_rms = 0;  // over all entries of Y_M, unit of Y_M, of the model's own predictions
};

// Everything in a model: what a model file holds.
struct DetailModelParameters {
  Learner learner = Learner::kGp;
  std::vector<GpRegressionParameters> stages;  // one or two, applied in this order
  DetailBasisParameters basis;                 // of details; nearly orthonormal as trained
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
    DetailBasis::Query query;
    RegionalGp::Workspace regional;
    Eigen::VectorXd regional_coefficients;  // r
  };

  // kInvalidArgument when sizes do not fit together or a number is not finite.
  static absl::StatusOr<DetailModel> FromParameters(DetailModelParameters parameters);
  DetailModelParameters parameters() const;

  Learner learner() const { return learner_; }
  int num_features() const { return stages_.front().num_inputs(); }  // D_S
  int num_components() const { return basis_.num_components(); }     // r
  int num_details() const { return basis_.num_details(); }           // D_M
  const DetailBasis& basis() const { return basis_; }
  const std::vector<GpRegression>& stages() const { return stages_; }
  double fade_confidence() const { return fade_confidence_; }
  const std::optional<RegionalGp>& regional() const { return regional_; }

  // Coefficients (r) of the detail at a feature row (D_S), faded; returns the confidence: 1 at the
  // training poses, 0 where they say nothing. No allocation after the first call.
  double PredictCoefficients(const Eigen::Ref<const Eigen::VectorXd>& features,
                             Workspace* workspace, Eigen::Ref<Eigen::VectorXf> coefficients) const;

  // The same for several rows, which read the model once; the same bits.
  struct Query {
    const double* features = nullptr;  // D_S
    Workspace* workspace = nullptr;    // another for each query
    float* coefficients = nullptr;     // r, out
    double confidence = 0;             // out
  };
  void PredictCoefficients(std::span<Query> queries) const;

  // The same expanded: detail (D_M), unit of Y_M.
  double Predict(const Eigen::Ref<const Eigen::VectorXd>& features, Workspace* workspace,
                 Eigen::Ref<Eigen::VectorXf> detail) const;

 private:
  DetailModel() = default;

  // What the stages predict at `features`, in workspace->coefficients, and how sure they are.
  struct Certainty {
    double confidence = 0, fade = 0;
  };
  Certainty PredictStages(const Eigen::Ref<const Eigen::VectorXd>& features,
                          Workspace* workspace) const;
  void MixRegional(std::span<Workspace* const> workspaces) const;

  Learner learner_ = Learner::kGp;
  std::vector<GpRegression> stages_;
  DetailBasis basis_;
  double fade_confidence_ = 0;
  double regional_share_ = 0;
  std::optional<RegionalGp> regional_;

  friend class DetailModelTrainer;
};

// Learns from features Y_S (N x D_S) and the principal components of the details Y_M (N scores of r
// components), row t = frame t; `clip_starts` holds the first row of each clip. Errors:
// kInvalidArgument for sizes or values; kCancelled.
absl::StatusOr<DetailModel> TrainDetailModel(const Eigen::Ref<const Eigen::MatrixXd>& features,
                                             const PrincipalComponents& details,
                                             const std::vector<int>& clip_starts,
                                             const DetailModelOptions& options = {},
                                             DetailModelSummary* summary = nullptr,
                                             const Progress& progress = {});

// The same from the details themselves (N x D_M), in the basis that `options` asks for.
absl::StatusOr<DetailModel> TrainDetailModel(const Eigen::Ref<const Eigen::MatrixXd>& features,
                                             const Eigen::Ref<const Eigen::MatrixXd>& details,
                                             const std::vector<int>& clip_starts,
                                             const DetailModelOptions& options = {},
                                             DetailModelSummary* summary = nullptr,
                                             const Progress& progress = {});

}  // namespace pleat
