#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/gp/gp_regression.h"
#include "pleat/gp/gram_term.h"
#include "pleat/gp/inducing.h"
#include "pleat/gp/marginal_likelihood.h"
#include "pleat/gp/scaling.h"
#include "pleat/math/spread_rows.h"
#include "pleat/optimize/lbfgs.h"
#include "pleat/simd/dense.h"

namespace pleat {
namespace {

absl::Status CheckData(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                       const Eigen::Ref<const Eigen::MatrixXd>& outputs) {
  if (inputs.rows() < 1 || inputs.cols() < 1 || outputs.cols() < 1 ||
      inputs.rows() != outputs.rows()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "GP regression of ", outputs.rows(), " x ", outputs.cols(), " outputs on ", inputs.rows(),
        " x ", inputs.cols(), " inputs: both need as many rows, and at least one row and column"));
  }
  if (!inputs.allFinite() || !outputs.allFinite()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "GP regression: an ", inputs.allFinite() ? "output" : "input", " is not finite"));
  }
  return absl::OkStatus();
}

absl::Status CheckGroups(const std::vector<std::vector<int>>& groups, Eigen::Index num_inputs) {
  std::vector<bool> taken(num_inputs, false);
  for (const std::vector<int>& group : groups) {
    for (const int column : group) {
      if (column < 0 || column >= num_inputs || taken[column]) {
        return absl::InvalidArgumentError(
            absl::StrCat("GP regression: the groups of inputs need columns below ", num_inputs,
                         ", each at most once; column ", column, " is not so"));
      }
      taken[column] = true;
    }
  }
  return absl::OkStatus();
}

// Returns centered and scaled copies of the data, and what was taken off. `alpha` holds the outputs
// until the kernel is known.
GpRegressionParameters Normalize(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                 const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                 const GpRegressionOptions& options) {
  GpRegressionParameters p;
  p.kernel_options = options.kernel;
  p.input_mean.setZero(inputs.cols());
  p.input_scales.setOnes(inputs.cols());
  p.inputs = inputs;
  if (options.normalize_inputs) {
    p.input_mean = inputs.colwise().mean().transpose();
    p.inputs.rowwise() -= p.input_mean.transpose();
    p.input_scales *= PositiveRoot(p.inputs.squaredNorm() / double(inputs.rows()));
    p.inputs /= p.input_scales[0];
  }
  p.output_mean = outputs.colwise().mean().transpose();
  p.alpha = outputs.rowwise() - p.output_mean.transpose();  // K^-1 is applied later
  p.output_scale = PositiveRoot(p.alpha.squaredNorm() / double(p.alpha.size()));
  p.alpha /= p.output_scale;
  return p;
}

Eigen::MatrixXd TakeRows(const Eigen::MatrixXd& all, const std::vector<Eigen::Index>& rows) {
  return all(rows, Eigen::all);
}

// Finishes `parameters`, whose `alpha` holds the normalized outputs, for the given kernel.
absl::Status Solve(const Progress& progress, GpRegressionParameters* p) {
  GramTerm term(static_cast<int>(p->inputs.rows()), p->kernel_options);
  term.SetInputs(p->inputs);
  // Only the factor of K is wanted; the outputs of this evaluation are zero.
  GramData none{Eigen::MatrixXd::Zero(p->inputs.rows(), 1), false, 1};
  const double value = term.Evaluate(p->kernel, none, 1, false, progress);
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  if (!std::isfinite(value)) {
    return absl::InvalidArgumentError(
        "GP regression: the kernel matrix cannot be factored; raise the noise floor");
  }
  Eigen::MatrixXd alpha;
  term.Solve(p->alpha, alpha);
  p->alpha = std::move(alpha);
  p->whitener = term.whitener().cast<float>();
  return absl::OkStatus();
}

// Does the same from all rows through the inducing rows `rows`, which are what is kept.
absl::Status SolveInducedRows(const std::vector<Eigen::Index>& rows, const Progress& progress,
                              GpRegressionParameters* p) {
  const KernelValues values = KernelValuesOf(p->kernel_options, p->kernel);
  const std::vector<AdditiveTerm> terms = {
      {.inverse_width = values.g, .amplitude = values.a, .linear = values.c}};
  const std::vector<Eigen::MatrixXd> inducing = {TakeRows(p->inputs, rows)};
  const auto cross = [&](Eigen::Index begin, Eigen::Index count) {
    return AdditiveCovariance({p->inputs.middleRows(begin, count)}, inducing, terms, values.b);
  };
  InducedWeights weights;
  const double noise = values.s2 + p->kernel_options.relative_noise_floor * values.a +
                       p->kernel_options.absolute_jitter;
  const bool solved = SolveInduced(
      AdditiveCovariance(inducing, inducing, terms, values.b), noise, p->alpha, cross,
      [&] { return progress.cancelled(); }, true, &weights);
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  if (!solved) {
    return absl::InvalidArgumentError(
        "GP regression: the kernel matrix cannot be factored; raise the noise floor");
  }
  p->inputs = inducing[0];
  p->alpha = std::move(weights.alpha);
  p->whitener = std::move(weights.whitener);
  return absl::OkStatus();
}

KernelLogs StartingLogs(double median) {
  return {.inverse_width = -std::log(median),
          .amplitude = std::log(.5),
          .bias = -4,
          .noise = std::log(1e-2),
          .linear = std::log(.5)};
}

// Learns the kernel and the relevance of the inputs from the normalized data in `p`, and scales its
// inputs by the relevance, so that a query pays nothing for it.
absl::Status LearnKernel(const GpRegressionOptions& options, const Progress& progress,
                         GpRegressionSummary* summary, GpRegressionParameters* p) {
  const auto rows = SpreadRows(p->inputs.rows(), options.max_hyperparameter_rows);
  summary->num_hyperparameter_rows = static_cast<int>(rows.size());
  Eigen::MatrixXd inputs = TakeRows(p->inputs, rows);
  const Eigen::Index n = inputs.rows();
  Eigen::MatrixXd distances = Eigen::MatrixXd::Zero(n, n);
  ChosenDenseOps().squared_distances(inputs.data(), n, inputs.cols(), distances.data());
  const double median = MedianSquaredDistance(distances);
  distances.resize(0, 0);
  PLEAT_ASSIGN_OR_RETURN(GramData data, MakeGramData(TakeRows(p->alpha, rows)));
  const double width_factor = std::log(options.prior_width_factor);
  MarginalLikelihood objective(std::move(inputs), std::move(data), options,
                               -std::log(median) - 2 * width_factor, progress);
  Eigen::VectorXd start = Eigen::VectorXd::Zero(objective.num_unknowns());
  PackKernelLogs(options.kernel, StartingLogs(median), start.head(objective.num_kernel_unknowns()));
  PLEAT_ASSIGN_OR_RETURN(
      const Eigen::VectorXd logs,
      MinimizeLbfgs(objective, start,
                    {.max_iterations = options.max_iterations, .objective_tolerance = 1e-9},
                    &summary->optimization, progress));
  p->kernel = UnpackKernelLogs(options.kernel, logs.head(objective.num_kernel_unknowns()));
  const Eigen::VectorXd factors =
      RelevanceFactors(options.input_groups, logs.tail(objective.num_groups()), p->inputs.cols());
  p->inputs *= factors.asDiagonal();
  p->input_scales = p->input_scales.cwiseQuotient(factors);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<GpRegression> GpRegression::Train(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                                 const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                                 const GpRegressionOptions& options,
                                                 GpRegressionSummary* summary,
                                                 const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckData(inputs, outputs));
  PLEAT_RETURN_IF_ERROR(CheckGroups(options.input_groups, inputs.cols()));
  GpRegressionSummary local;
  GpRegressionSummary& report = summary ? *summary : local;
  GpRegressionParameters p = Normalize(inputs, outputs, options);

  PLEAT_RETURN_IF_ERROR(LearnKernel(options, progress.Stage("gp", 0, .9), &report, &p));

  const auto rows = SpreadRows(inputs.rows(), options.max_rows);
  report.num_rows = static_cast<int>(rows.size());
  const Progress solving = progress.Stage("gp", .9, 1);
  PLEAT_RETURN_IF_ERROR(report.num_rows < inputs.rows() ? SolveInducedRows(rows, solving, &p)
                                                        : Solve(solving, &p));
  return GpRegression(std::move(p));
}

absl::StatusOr<GpRegression> GpRegression::Condition(
    const Eigen::Ref<const Eigen::MatrixXd>& inputs,
    const Eigen::Ref<const Eigen::MatrixXd>& outputs, const KernelLogs& kernel,
    const GpRegressionOptions& options) {
  PLEAT_RETURN_IF_ERROR(CheckData(inputs, outputs));
  PLEAT_RETURN_IF_ERROR(CheckKernelLogs(options.kernel, kernel, "GP regression"));
  GpRegressionParameters p = Normalize(inputs, outputs, options);
  p.kernel = kernel;
  PLEAT_RETURN_IF_ERROR(Solve({}, &p));
  return GpRegression(std::move(p));
}

}  // namespace pleat
