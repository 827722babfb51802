// What turns a pose into a detail: a chain of Gaussian processes and a basis of details.
//
//   gp        features -> coefficients
//   sgplvm    features -> latent point (the paper's back-map) -> coefficients
//   ridge     features -> coefficients, linear
//   regional  features -> coefficients of every region's own basis -> coefficients
//   detail  = mean + basis * coefficients
//
// The confidence of `regional` is that of a direct GP beside it. Models before version 4 of the
// file have regions that share one basis and mix with the direct GP; they are read, no longer
// trained.
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
#include "pleat/learner/coefficient_fold.h"
#include "pleat/learner/parted_basis.h"
#include "pleat/learner/regional_gp.h"
#include "pleat/learner/ridge.h"
#include "pleat/math/pca.h"

namespace pleat {

enum class Learner {
  kGp,        // direct regression with an RBF + linear kernel
  kSgplvm,    // the paper's shared GPLVM
  kRegional,  // regression per body region, additive over near and far joints and the skin
  kRidge,     // linear regression
};
inline constexpr std::array kAllLearners = {Learner::kGp, Learner::kSgplvm, Learner::kRegional,
                                            Learner::kRidge};

// A part of the body that the regional learner predicts by itself.
struct DetailRegion {
  std::vector<int> rows;    // entries of Y_M that the region has a share in, ascending
  Eigen::VectorXd weights;  // the share of each; over all regions the sum of an entry's shares is 1
  std::vector<std::vector<int>> feature_sets;  // columns of Y_S, as in GpRegion
  int max_components = 0;                      // of its basis; 0: as RegionalBasisOptions has it
};

// The bases of the regional learner. A region's own basis spans its share of the details; a part of
// the body is the vertices of which one region has the largest share, and its basis is what a query
// expands. Measured in docs/performance.md.
struct RegionalBasisOptions {
  int max_region_components = 128;
  // What a region's basis may leave out: a root mean square per entry, as a share of that of all
  // details. What is left out of large details matters; small ones need no exact basis.
  double region_rest = .003;
  int max_part_components = 128;
  double part_rest = .005;
  double fold_rest = .005;  // what of a region a part may leave out altogether, as the others
  // The basis of all details has so many; those of regions and parts are made from it.
  int max_components = 256;
};

// "gp", "sgplvm", "regional", "ridge".
std::string LearnerName(Learner learner);

struct DetailModelOptions {
  Learner learner = Learner::kGp;
  GpRegressionOptions gp{};      // of the direct learner
  SharedGplvmOptions sgplvm{};   // of the shared GPLVM
  RidgeOptions ridge{};          // of the linear learner
  RegionalGpOptions regional{};  // of the regional learner
  RegionalBasisOptions regional_basis{};
  std::vector<DetailRegion> regions{};  // what it needs; may be empty for the others
  int num_part_regions = 0;             // so many leading ones make the parts; 0: all
  // Only so many leading features describe the pose; those behind describe the skin, and only the
  // regional learner reads them. 0: all.
  int num_pose_features = 0;
  // Frames that get a latent point each: all, or so many of them, spread evenly.
  int max_latents = 600;
  // Of Y_S -> X, after training. With back-constraints the constraint itself is the map.
  GpRegressionOptions back_map{.kernel = {.bias = true, .linear = false}};

  // As many principal components of the details as this share of their energy needs, up to a cap.
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

  // Below this confidence the prediction fades smoothly to the mean detail. The mean of a Gaussian
  // process falls back by itself; this stops what its linear part could do far away. A narrower
  // band pops: with .02 a detail could be gone within a fifth of a degree (docs/performance.md).
  // The regional learner never fades: its rows are bounded instead (RegionalGpOptions).
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
  PartedBasisParameters basis;                 // of details; nearly orthonormal as trained
  double fade_confidence = .02;
  double regional_share = 0;                     // of `regional` in the prediction, 0..1
  std::optional<RegionalGpParameters> regional;  // with Learner::kRegional only
  // From the outputs of the regions to the coefficients of the basis. Empty: they are the same, as
  // in models before version 4.
  std::vector<CoefficientFoldBlock> fold;
};

// Immutable: queries share it without locks.
class DetailModel {
 public:
  // What one thread needs for its queries; reused without allocation.
  struct Workspace {
    std::vector<GpRegression::Workspace> stages;
    Eigen::VectorXd latent;        // q
    Eigen::VectorXd outputs;       // of the last stage
    Eigen::VectorXd coefficients;  // r
    Eigen::VectorXf single;        // r
    PartedBasis::Query query;
    RegionalGp::Workspace regional;
    Eigen::VectorXd regional_outputs;         // of all regions
    Eigen::VectorXf single_regional, folded;  // the same; r
    CoefficientFold::Workspace fold;
  };

  // kInvalidArgument when sizes do not fit together or a number is not finite.
  static absl::StatusOr<DetailModel> FromParameters(DetailModelParameters parameters);
  DetailModelParameters parameters() const;

  Learner learner() const { return learner_; }
  int num_features() const {  // D_S
    return regional_ ? regional_->num_inputs() : stages_.front().num_inputs();
  }
  // How many leading features the stages read: those of the pose.
  int num_pose_features() const { return stages_.front().num_inputs(); }
  int num_components() const { return basis_.num_coefficients(); }  // r
  int num_details() const { return basis_.num_details(); }          // D_M
  const PartedBasis& basis() const { return basis_; }
  const std::vector<GpRegression>& stages() const { return stages_; }
  double fade_confidence() const { return fade_confidence_; }
  const std::optional<RegionalGp>& regional() const { return regional_; }
  const std::optional<CoefficientFold>& fold() const { return fold_; }

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

  // What the stages predict at `features`, in workspace->outputs, and how sure they are.
  struct Certainty {
    double confidence = 0, fade = 0;
  };
  Certainty PredictStages(const Eigen::Ref<const Eigen::VectorXd>& features,
                          Workspace* workspace) const;
  absl::Status TakeRegional(DetailModelParameters* parameters);
  void PredictRegional(std::span<Workspace* const> workspaces) const;

  Learner learner_ = Learner::kGp;
  std::vector<GpRegression> stages_;
  PartedBasis basis_;
  double fade_confidence_ = 0;
  double regional_share_ = 0;
  std::optional<RegionalGp> regional_;
  std::optional<CoefficientFold> fold_;

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
