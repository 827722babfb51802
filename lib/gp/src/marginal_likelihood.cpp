#include "pleat/gp/marginal_likelihood.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pleat {

Eigen::VectorXd RelevanceFactors(const std::vector<std::vector<int>>& groups,
                                 const Eigen::Ref<const Eigen::VectorXd>& logs,
                                 Eigen::Index num_inputs) {
  Eigen::VectorXd factors = Eigen::VectorXd::Ones(num_inputs);
  for (size_t i = 0; i < groups.size(); ++i) {
    const double log = logs[static_cast<Eigen::Index>(i)];
    const double factor = std::exp(.5 * std::clamp(log, -kMaxKernelLog, kMaxKernelLog));
    for (const int column : groups[i]) factors[column] = factor;
  }
  return factors;
}

MarginalLikelihood::MarginalLikelihood(Eigen::MatrixXd inputs, GramData data,
                                       const GpRegressionOptions& options, double prior_center,
                                       Progress progress)
    : options_(options),
      inputs_(std::move(inputs)),
      data_(std::move(data)),
      term_(static_cast<int>(inputs_.rows()), options.kernel),
      num_values_(static_cast<double>(inputs_.rows()) * data_.num_outputs),
      prior_center_(prior_center),
      progress_(std::move(progress)) {
  term_.SetInputs(inputs_);
}

double MarginalLikelihood::Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
  const KernelLogs logs = UnpackKernelLogs(options_.kernel, x.head(num_kernel_unknowns()));
  const auto relevance = x.tail(num_groups());
  if (num_groups() > 0) {
    scaled_ =
        inputs_ * RelevanceFactors(options_.input_groups, relevance, inputs_.cols()).asDiagonal();
    term_.SetInputs(scaled_);
  }
  const double away = logs.inverse_width - prior_center_;
  const double value = term_.Evaluate(logs, data_, 1, gradient != nullptr, progress_);
  if (gradient != nullptr) {
    gradient->resize(num_unknowns());
    gradient->head(num_kernel_unknowns()) = term_.log_gradient();
    (*gradient)[0] += options_.prior_precision * num_values_ * away;
    if (num_groups() > 0) RelevanceGradient(relevance, gradient->tail(num_groups()));
  }
  return value + .5 * num_values_ *
                     (options_.prior_precision * away * away +
                      options_.relevance_precision * relevance.squaredNorm());
}

// The derivatives by the logs: a column is proportional to exp(log / 2), so its derivative by the
// log is half of the column.
void MarginalLikelihood::RelevanceGradient(const Eigen::Ref<const Eigen::VectorXd>& logs,
                                           Eigen::Ref<Eigen::VectorXd> gradient) {
  term_.InputGradient(input_gradient_);
  gradient = options_.relevance_precision * num_values_ * logs;
  for (int i = 0; i < num_groups(); ++i) {
    if (std::abs(logs[i]) > kMaxKernelLog) continue;  // clamped
    for (const int column : options_.input_groups[i]) {
      gradient[i] += .5 * input_gradient_.col(column).dot(scaled_.col(column));
    }
  }
}

}  // namespace pleat
