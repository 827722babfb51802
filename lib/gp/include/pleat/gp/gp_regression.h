// Gaussian process regression of several outputs that share one kernel: exact, or through inducing
// rows where there are many.
// Source: Rasmussen and Williams, "Gaussian Processes for Machine Learning" (2006), chapters 2, 5.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/gp/kernel.h"
#include "pleat/optimize/summary.h"

namespace pleat {

struct GpRegressionOptions {
  KernelOptions kernel{.bias = true, .linear = true};
  // Says whether inputs are centered and divided by one scalar so that rows have mean squared norm
  // 1; false takes them as they are (latent points).
  bool normalize_inputs = true;
  // Disjoint sets of columns. Each gets a factor on its squared distances that is learned with the
  // kernel (automatic relevance determination): joints whose motion says nothing about the output
  // make no two frames look different. Columns in no set keep factor 1.
  std::vector<std::vector<int>> input_groups{};
  // The precision, per row and output, of a Gaussian prior around 0 on the logs of those factors.
  double relevance_precision = .003;
  int max_iterations = 60;  // limit of L-BFGS on the marginal likelihood
  // The precision, per row and output, of a Gaussian prior on log g around log(1 /
  // (prior_width_factor^2 * median squared distance)); 0: none. Frames of one clip are so alike
  // that the likelihood alone prefers widths that generalize badly. Chosen on blocks held out
  // inside the training frames of captured clips (docs/performance.md, "Choices").
  double prior_precision = .003;
  double prior_width_factor = 1;
  // Hyperparameters are learned on at most this many rows, spread evenly: the cost grows with the
  // cube.
  int max_hyperparameter_rows = 800;
  // More rows than this are not kept: all of them are learned through this many inducing rows,
  // spread evenly, at a cost that grows linearly.
  int max_rows = 600;
};

struct GpRegressionSummary {
  OptimizationSummary optimization;
  int num_rows = 0;  // rows that predictions are made from: all, or the inducing ones
  int num_hyperparameter_rows = 0;
};

// Everything that a prediction needs, and what a model file holds.
struct GpRegressionParameters {
  KernelOptions kernel_options;
  KernelLogs kernel;             // in normalized units
  Eigen::VectorXd input_mean;    // D
  Eigen::VectorXd input_scales;  // D, units of the inputs
  Eigen::MatrixXd inputs;        // N x D, normalized: (x - mean) / scale
  Eigen::VectorXd output_mean;   // r
  double output_scale = 1;       // unit of the outputs
  Eigen::MatrixXd alpha;         // N x r, K^-1 (y - mean) / scale
  Eigen::MatrixXf whitener;      // N x N, lower triangular: K^-1 = W^T W; only for the variance
};

// Immutable after training: queries share it without locks.
class GpRegression {
 public:
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  // The memory that one thread needs for its queries. It is sized by the first query and reused
  // without allocation.
  struct Workspace {
    Eigen::VectorXd row;       // D, normalized
    Eigen::VectorXd products;  // N
    Eigen::VectorXd rbf;       // N
    Eigen::VectorXd kernel;    // N
    Eigen::VectorXf kernel_f;  // N
    Eigen::VectorXf whitened;  // N
    Eigen::MatrixXd slopes;    // N x D, only with an input variance
    Eigen::MatrixXd jacobian;  // r x D, only with an input variance
  };

  // Learns the hyperparameters from inputs (N x D) and outputs (N x r), whose rows are samples. The
  // error is kInvalidArgument for empty or not finite data, sizes that differ or groups that
  // overlap, and kCancelled. See docs/method/learner.md#direct-gp.
  static absl::StatusOr<GpRegression> Train(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                            const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                            const GpRegressionOptions& options = {},
                                            GpRegressionSummary* summary = nullptr,
                                            const Progress& progress = {});

  // Conditions on the data with given hyperparameters (in normalized units), without training.
  static absl::StatusOr<GpRegression> Condition(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                                const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                                const KernelLogs& kernel,
                                                const GpRegressionOptions& options = {});

  // Takes parameters from a file: checks sizes and that every number is finite (kInvalidArgument
  // naming which).
  static absl::StatusOr<GpRegression> FromParameters(GpRegressionParameters parameters);

  const GpRegressionParameters& parameters() const { return parameters_; }
  int num_rows() const { return static_cast<int>(parameters_.inputs.rows()); }
  int num_inputs() const { return static_cast<int>(parameters_.inputs.cols()); }
  int num_outputs() const { return static_cast<int>(parameters_.alpha.cols()); }

  // Computes the mean (r entries) of the outputs at `row` (D entries). `variance`, when not null,
  // receives the variance of the noise-free function, the same for all outputs, (output unit)^2.
  // For uncertain inputs `input_variance` ((input unit)^2, the same for all inputs) is carried
  // through to first order, averaged over the outputs.
  void Predict(const Eigen::Ref<const Eigen::VectorXd>& row, double input_variance,
               Workspace* workspace, Eigen::Ref<Eigen::VectorXd> mean, double* variance) const;

  // Returns the variance of the function before any data, at a typical training input, in (output
  // unit)^2. The bias is left out: any data fix it, so that far from all of them the variance is a,
  // not a + b.
  double prior_variance() const { return prior_variance_; }

 private:
  explicit GpRegression(GpRegressionParameters parameters);

  GpRegressionParameters parameters_;
  KernelValues values_;
  RowMajorMatrix alpha_rows_;      // alpha once more, in the order in which a query reads it
  Eigen::VectorXd squared_norms_;  // N, of the normalized inputs
  double prior_variance_ = 1;
};

}  // namespace pleat
