// Conjugate gradients need a step length for each direction, and the usual way to find one is a
// line search of several evaluations. Moller's idea is to take the step from a local quadratic
// model instead and to guard it with a trust parameter lambda, as Levenberg and Marquardt do. With
// the direction d, mu = d.grad f (negative) and kappa = |d|^2, one iteration is:
//
// 1. ProbeCurvature: theta, the curvature along d, from a finite difference at x + sigma d. The
//    step sigma d has the length sigma0 whatever |d| is. This is done only after an accepted step:
//    a rejected one changes lambda alone, and theta still holds.
// 2. Step: delta = theta + lambda kappa is the curvature of the damped model. If it is not
//    positive, the objective is not convex along d; lambda grows by -theta / kappa, which makes
//    delta the old lambda kappa. The model has its minimum at alpha = -mu / delta.
// 3. Comparison: the model promises a decrease of -alpha mu / 2. The ratio of the true decrease to
//    the promised one says how good the model was. A step is accepted when the ratio is not
//    negative, that is when f does not rise. Above 3/4 lambda is halved, below 1/4 it is multiplied
//    by 4, and between it stays. At a point outside of the domain (a kernel matrix that cannot be
//    factored) the ratio counts as -1 and lambda grows by 100, since nothing is known of the scale
//    there.
// 4. ChooseDirection: d = gamma d - grad with gamma = (grad_old - grad_new).grad_new / mu, which is
//    the formula of Hestenes and Stiefel for an exact step. After as many accepted steps as there
//    are unknowns d starts again from -grad; it also does in ProbeCurvature when rounding has
//    turned d uphill.
//
// So an iteration costs one gradient for the trial point, which becomes the gradient of the next
// iteration when the step is accepted, and one probe after each accepted step. The probe needs a
// gradient only through its component along d. Where a value costs half of a gradient, as with
// Gaussian processes, it is cheaper to take theta from values (ScgCurvature::kValues): f(x + sigma
// d) = f + sigma mu + sigma^2/2 theta + ... The error of rounding is then eps |f| / sigma^2 instead
// of eps |grad| / sigma, so sigma is ten times as long, and a difference that rounding could have
// made is thrown away and the gradient is taken after all.

#include "pleat/optimize/scg.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pleat/base/status.h"
#include "start.h"

namespace pleat {
namespace {

constexpr double kValueStep = 10;  // step of a second difference, in steps of gradients
// The smallest share of the value that such a difference may be. Values of likelihoods with kernel
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

// The Taylor series f(x + sigma d) = f + sigma mu + sigma^2/2 theta + ... solved for theta. theta_
// is of use only when true is returned.
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
  if (delta <= 0) {  // makes the model convex
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
  // Outside of the domain nothing is known of the scale: shrink fast.
  if (comparison < .25) lambda_ = std::min((finite ? 4 : 100) * lambda_, options_.max_lambda);
  if (comparison > .75) lambda_ = std::max(.5 * lambda_, options_.min_lambda);
  return accepted;
}

void ScaledConjugateGradients::ChooseDirection(bool accepted) {
  if (num_accepted_ >= x_.size()) {
    direction_ = -gradient_;
    num_accepted_ = 0;
  } else if (accepted) {
    // After the swap in Step() probe_gradient_ is the gradient of the point before, and mu_ its
    // slope.
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
  ReportEnd(evaluations_, value_, gradient_, &summary);
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
