#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "dense.h"
#include "inducing.h"
#include "pleat/base/status.h"
#include "pleat/gp/gp_regression.h"
#include "pleat/gp/gram_term.h"
#include "pleat/optimize/lbfgs.h"
#include "scaling.h"

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

// The negative log marginal likelihood, and the prior, over the kernel's logs.
class MarginalLikelihood : public Objective {
 public:
  MarginalLikelihood(const Eigen::MatrixXd& inputs, GramData data,
                     const GpRegressionOptions& options, double prior_center, Progress progress)
      : options_(options),
        data_(std::move(data)),
        term_(static_cast<int>(inputs.rows()), options.kernel),
        precision_(options.prior_precision * double(inputs.rows()) * data_.num_outputs),
        prior_center_(prior_center),
        progress_(std::move(progress)) {
    term_.SetInputs(inputs);
  }
  int num_unknowns() const override { return NumKernelUnknowns(options_.kernel); }
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    const KernelLogs logs = UnpackKernelLogs(options_.kernel, x);
    const double away = logs.inverse_width - prior_center_;
    const double value = term_.Evaluate(logs, data_, 1, gradient != nullptr, progress_);
    if (gradient) {
      *gradient = term_.log_gradient();
      (*gradient)[0] += precision_ * away;
    }
    return value + .5 * precision_ * away * away;
  }

 private:
  const GpRegressionOptions& options_;
  GramData data_;
  GramTerm term_;
  double precision_, prior_center_;
  Progress progress_;
};

// Centred and scaled copies of the data, and what was taken off.
GpRegressionParameters Normalise(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                 const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                 const GpRegressionOptions& options) {
  GpRegressionParameters p;
  p.kernel_options = options.kernel;
  p.input_mean.setZero(inputs.cols());
  p.inputs = inputs;
  if (options.normalise_inputs) {
    p.input_mean = inputs.colwise().mean().transpose();
    p.inputs.rowwise() -= p.input_mean.transpose();
    p.input_scale = PositiveRoot(p.inputs.squaredNorm() / double(inputs.rows()));
    p.inputs /= p.input_scale;
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

// Finishes `parameters`, whose `alpha` holds the normalised outputs, for the given kernel.
absl::Status Solve(const Progress& progress, GpRegressionParameters* p) {
  GramTerm term(static_cast<int>(p->inputs.rows()), p->kernel_options);
  term.SetInputs(p->inputs);
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

// The same from all rows through the inducing rows `rows`, which are what is kept.
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

}  // namespace

absl::StatusOr<GpRegression> GpRegression::Train(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                                 const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                                 const GpRegressionOptions& options,
                                                 GpRegressionSummary* summary,
                                                 const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckData(inputs, outputs));
  GpRegressionSummary local;
  GpRegressionSummary& report = summary ? *summary : local;
  GpRegressionParameters p = Normalise(inputs, outputs, options);

  const auto learning_rows = SpreadRows(inputs.rows(), options.max_hyperparameter_rows);
  report.num_hyperparameter_rows = static_cast<int>(learning_rows.size());
  const Eigen::MatrixXd learning_inputs = TakeRows(p.inputs, learning_rows);
  const Eigen::Index n = learning_inputs.rows();
  Eigen::MatrixXd distances = Eigen::MatrixXd::Zero(n, n);
  ChosenDenseOps().squared_distances(learning_inputs.data(), n, learning_inputs.cols(),
                                     distances.data());
  const double median = MedianSquaredDistance(distances);
  distances.resize(0, 0);
  PLEAT_ASSIGN_OR_RETURN(GramData data, MakeGramData(TakeRows(p.alpha, learning_rows)));
  const double width_factor = std::log(options.prior_width_factor);
  MarginalLikelihood objective(learning_inputs, std::move(data), options,
                               -std::log(median) - 2 * width_factor, progress);
  Eigen::VectorXd start(objective.num_unknowns());
  PackKernelLogs(options.kernel, StartingLogs(median), start);
  PLEAT_ASSIGN_OR_RETURN(
      const Eigen::VectorXd logs,
      MinimizeLbfgs(objective, start,
                    {.max_iterations = options.max_iterations, .objective_tolerance = 1e-9},
                    &report.optimization, progress.Stage("gp", 0, .9)));
  p.kernel = UnpackKernelLogs(options.kernel, logs);

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
  GpRegressionParameters p = Normalise(inputs, outputs, options);
  p.kernel = kernel;
  PLEAT_RETURN_IF_ERROR(Solve({}, &p));
  return GpRegression(std::move(p));
}

}  // namespace pleat
