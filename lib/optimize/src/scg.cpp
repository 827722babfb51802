#include "pleat/optimize/scg.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pleat/base/status.h"
#include "start.h"

namespace pleat {
namespace {

constexpr double kValueStep = 10;  // of a second difference of values, in those of gradients
// Smallest share of the value that such a difference may be. Values of likelihoods with kernel
// matrices at the edge of double precision are rounded at 1e-11 (measured), others at 1e-14.
constexpr double kSmallestSecondDifference = 1e-10;

// The state of one run; the names are Moller's.
class ScaledConjugateGradients {
 public:
  ScaledConjugateGradients(Objective& objective, const ScgOptions& options)
      : objective_(objective), options_(options), lambda_(options.initial_lambda) {}

  absl::StatusOr<Eigen::VectorXd> Run(const Eigen::VectorXd& start, OptimizationSummary& summary,
                                      const Progress& progress);

 private:
  bool ProbeCurvature();                   // false: the direction has vanished
  bool CurvatureFromValues(double sigma);  // false: not precise enough
  void CurvatureFromGradients(double sigma);
  bool Step();  // true: accepted
  void ChooseDirection(bool accepted);

  Objective& objective_;
  const ScgOptions& options_;
  Eigen::VectorXd x_, gradient_, direction_, probe_, probe_gradient_;
  double value_ = 0;
  double lambda_;
  double mu_ = 0, kappa_ = 0, theta_ = 0;  // slope, squared length, curvature along the direction
  double gain_ = 0;                        // decrease of the objective by the last accepted step
  int evaluations_ = 0;
  int num_accepted_ = 0;  // since the direction was last reset
};

bool ScaledConjugateGradients::ProbeCurvature() {
  mu_ = direction_.dot(gradient_);
  if (mu_ >= 0) {
    direction_ = -gradient_;
    mu_ = direction_.dot(gradient_);
  }
  kappa_ = direction_.squaredNorm();
  if (kappa_ < std::numeric_limits<double>::epsilon()) return false;
  const double sigma = options_.sigma0 / std::sqrt(kappa_);
  if (options_.curvature == ScgCurvature::kGradients || !CurvatureFromValues(kValueStep * sigma)) {
    CurvatureFromGradients(sigma);
  }
  return true;
}

// f(x + sigma d) = f + sigma mu + sigma^2/2 theta + ...
bool ScaledConjugateGradients::CurvatureFromValues(double sigma) {
  probe_ = x_ + sigma * direction_;
  const double value = objective_.Evaluate(probe_, nullptr);
  ++evaluations_;
  const double difference = value - value_ - sigma * mu_;
  theta_ = 2 * difference / (sigma * sigma);
  return std::abs(difference) >= kSmallestSecondDifference * std::abs(value_) &&
         std::isfinite(theta_);
}

void ScaledConjugateGradients::CurvatureFromGradients(double sigma) {
  probe_ = x_ + sigma * direction_;
  const double value = objective_.Evaluate(probe_, &probe_gradient_);
  ++evaluations_;
  theta_ = direction_.dot(probe_gradient_ - gradient_) / sigma;
  if (!std::isfinite(value) || !std::isfinite(theta_)) theta_ = 0;  // lambda alone sets the step
}

bool ScaledConjugateGradients::Step() {
  double delta = theta_ + lambda_ * kappa_;
  if (delta <= 0) {  // make the model convex
    delta = lambda_ * kappa_;
    lambda_ -= theta_ / kappa_;
  }
  const double alpha = -mu_ / delta;
  probe_ = x_ + alpha * direction_;
  const double value = objective_.Evaluate(probe_, &probe_gradient_);
  ++evaluations_;
  const bool finite = std::isfinite(value) && probe_gradient_.allFinite();
  const double comparison = finite ? 2 * (value - value_) / (alpha * mu_) : -1;
  const bool accepted = comparison >= 0;
  if (accepted) {
    gain_ = value_ - value;
    value_ = value;
    std::swap(x_, probe_);
    std::swap(gradient_, probe_gradient_);  // probe_gradient_ now holds the previous gradient
    ++num_accepted_;
  }
  // Outside the domain nothing is known of the scale: shrink fast.
  if (comparison < .25) lambda_ = std::min((finite ? 4 : 100) * lambda_, options_.max_lambda);
  if (comparison > .75) lambda_ = std::max(.5 * lambda_, options_.min_lambda);
  return accepted;
}

void ScaledConjugateGradients::ChooseDirection(bool accepted) {
  if (num_accepted_ >= x_.size()) {
    direction_ = -gradient_;
    num_accepted_ = 0;
  } else if (accepted) {
    const double gamma = (probe_gradient_ - gradient_).dot(gradient_) / mu_;
    direction_ = gamma * direction_ - gradient_;
  }
}

absl::StatusOr<Eigen::VectorXd> ScaledConjugateGradients::Run(const Eigen::VectorXd& start,
                                                              OptimizationSummary& summary,
                                                              const Progress& progress) {
  x_ = start;
  PLEAT_RETURN_IF_ERROR(EvaluateStart(objective_, start, progress, &value_, &gradient_));
  ++evaluations_;
  summary = {};
  summary.initial_objective = value_;
  direction_ = -gradient_;
  probe_gradient_.resize(x_.size());

  bool accepted = true;
  while (summary.iterations < options_.max_iterations) {
    if (LargestEntry(gradient_) <= options_.gradient_tolerance) {
      summary.stop_reason = StopReason::kGradientTolerance;
      break;
    }
    if ((accepted && !ProbeCurvature()) || lambda_ >= options_.max_lambda) {
      summary.stop_reason = StopReason::kNoProgress;
      break;
    }
    accepted = Step();
    ++summary.iterations;
    PLEAT_RETURN_IF_ERROR(
        progress.Report(static_cast<double>(summary.iterations) / options_.max_iterations, value_));
    if (accepted && gain_ <= options_.objective_tolerance * std::abs(value_) &&
        options_.objective_tolerance > 0) {
      summary.stop_reason = StopReason::kObjectiveTolerance;
      break;
    }
    ChooseDirection(accepted);
  }
  summary.evaluations = evaluations_;
  summary.final_objective = value_;
  summary.final_gradient = LargestEntry(gradient_);
  return x_;
}

}  // namespace

absl::StatusOr<Eigen::VectorXd> MinimizeScg(Objective& objective, const Eigen::VectorXd& start,
                                            const ScgOptions& options, OptimizationSummary* summary,
                                            const Progress& progress) {
  OptimizationSummary local;
  return ScaledConjugateGradients(objective, options)
      .Run(start, summary ? *summary : local, progress);
}

}  // namespace pleat
