#include "pleat/optimize/lbfgs.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "pleat/base/status.h"
#include "start.h"

namespace pleat {
namespace {

// An accepted step and the change of the gradient along it.
struct Pair {
  Eigen::VectorXd step, change;
  double inverse_product;  // 1 / (step . change)
};

// A point on the search ray.
struct RayPoint {
  double alpha = 0, value = 0, slope = 0;
};

// Returns the minimum of the cubic through two values and slopes, kept away from both ends by a
// tenth of the interval, so that Zoom() shrinks it by at least that much each time.
double CubicMinimum(const RayPoint& a, const RayPoint& b) {
  const double low = std::min(a.alpha, b.alpha), high = std::max(a.alpha, b.alpha);
  const double d1 = a.slope + b.slope - 3 * (a.value - b.value) / (a.alpha - b.alpha);
  const double square = d1 * d1 - a.slope * b.slope;
  double alpha = .5 * (low + high);
  if (square >= 0) {
    const double d2 = std::copysign(std::sqrt(square), b.alpha - a.alpha);
    const double candidate =
        b.alpha - (b.alpha - a.alpha) * (b.slope + d2 - d1) / (b.slope - a.slope + 2 * d2);
    if (std::isfinite(candidate)) alpha = candidate;
  }
  return std::clamp(alpha, low + .1 * (high - low), high - .1 * (high - low));
}

class Lbfgs {
 public:
  Lbfgs(Objective& objective, const LbfgsOptions& options)
      : objective_(objective), options_(options) {}

  absl::StatusOr<Eigen::VectorXd> Run(const Eigen::VectorXd& start, OptimizationSummary& summary,
                                      const Progress& progress);

 private:
  void ChooseDirection();
  RayPoint EvaluateOnRay(double alpha);
  // Looks for a step that meets the strong Wolfe conditions (Nocedal and Wright, algorithm 3.5) and
  // leaves it in trial_ and trial_gradient_; false when no decrease was found. `value` receives the
  // objective there.
  bool SearchLine(double first_alpha, const Progress& progress, double* value);
  // Narrows an interval that holds such a step (algorithm 3.6). `low` is the end with the lower
  // value, which may be the right one.
  bool Zoom(RayPoint low, RayPoint high, const RayPoint& origin, int budget,
            const Progress& progress, double* value);
  bool Decreases(const RayPoint& point, const RayPoint& origin) const {
    return point.value <= origin.value + options_.sufficient_decrease * point.alpha * origin.slope;
  }
  bool Flat(const RayPoint& point, const RayPoint& origin) const {
    return std::abs(point.slope) <= -options_.curvature * origin.slope;
  }

  Objective& objective_;
  const LbfgsOptions& options_;
  Eigen::VectorXd x_, gradient_, direction_, trial_, trial_gradient_;
  double value_ = 0;
  int evaluations_ = 0;
  std::deque<Pair> pairs_;
};

// The two-loop recursion (algorithm 7.4). Between the loops the direction is scaled by (s.y) /
// |y|^2 of the newest pair, the usual guess of the inverse Hessian.
void Lbfgs::ChooseDirection() {
  direction_ = -gradient_;
  if (pairs_.empty()) return;
  Eigen::VectorXd products(pairs_.size());
  for (int i = static_cast<int>(pairs_.size()) - 1; i >= 0; --i) {
    products[i] = pairs_[i].inverse_product * pairs_[i].step.dot(direction_);
    direction_ -= products[i] * pairs_[i].change;
  }
  direction_ /= pairs_.back().inverse_product * pairs_.back().change.squaredNorm();
  for (size_t i = 0; i < pairs_.size(); ++i) {
    const double product = pairs_[i].inverse_product * pairs_[i].change.dot(direction_);
    direction_ += (products[i] - product) * pairs_[i].step;
  }
  if (!(direction_.dot(gradient_) < 0)) {  // rounding has spoilt the memory: start again
    pairs_.clear();
    direction_ = -gradient_;
  }
}

RayPoint Lbfgs::EvaluateOnRay(double alpha) {
  trial_ = x_ + alpha * direction_;
  const double value = objective_.Evaluate(trial_, &trial_gradient_);
  ++evaluations_;
  return {alpha, value, trial_gradient_.dot(direction_)};
}

bool Lbfgs::SearchLine(double first_alpha, const Progress& progress, double* value) {
  const RayPoint origin{0, value_, gradient_.dot(direction_)};
  RayPoint previous = origin;
  double alpha = first_alpha;
  int budget = options_.max_line_search_evaluations;
  while (budget > 0 && !progress.cancelled()) {
    const RayPoint point = EvaluateOnRay(alpha);
    --budget;
    if (!std::isfinite(point.value) || !std::isfinite(point.slope)) {
      alpha = previous.alpha + .1 * (alpha - previous.alpha);  // come back into the domain
      continue;
    }
    if (!Decreases(point, origin) || (previous.alpha > 0 && point.value >= previous.value)) {
      return Zoom(previous, point, origin, budget, progress, value);
    }
    *value = point.value;
    if (Flat(point, origin)) return true;
    if (point.slope >= 0) return Zoom(point, previous, origin, budget, progress, value);
    previous = point;
    alpha *= 2;
  }
  // The budget is used up. The last point that decreased is evaluated again, since trial_ no longer
  // holds it.
  if (previous.alpha <= 0) return false;
  *value = EvaluateOnRay(previous.alpha).value;
  return std::isfinite(*value);
}

bool Lbfgs::Zoom(RayPoint low, RayPoint high, const RayPoint& origin, int budget,
                 const Progress& progress, double* value) {
  while (budget-- > 0 && !progress.cancelled()) {
    const RayPoint point = EvaluateOnRay(CubicMinimum(low, high));
    if (!std::isfinite(point.value) || !Decreases(point, origin) || point.value >= low.value) {
      high = point;
      if (!std::isfinite(point.value)) high.value = std::abs(low.value) * 2 + 1, high.slope = 1;
      continue;
    }
    *value = point.value;
    if (Flat(point, origin)) return true;
    if (point.slope * (high.alpha - low.alpha) >= 0) high = low;
    low = point;
  }
  if (low.alpha <= 0) return false;
  *value = EvaluateOnRay(low.alpha).value;  // the best point that decreases
  return *value < value_;
}

absl::StatusOr<Eigen::VectorXd> Lbfgs::Run(const Eigen::VectorXd& start,
                                           OptimizationSummary& summary, const Progress& progress) {
  x_ = start;
  PLEAT_RETURN_IF_ERROR(EvaluateStart(objective_, start, progress, &value_, &gradient_));
  evaluations_ = 1;
  summary = {};
  summary.initial_objective = value_;
  trial_gradient_.resize(x_.size());
  while (summary.iterations < options_.max_iterations && evaluations_ < options_.max_evaluations) {
    if (LargestEntry(gradient_) <= options_.gradient_tolerance) {
      summary.stop_reason = StopReason::kGradientTolerance;
      break;
    }
    ChooseDirection();
    // Before the first pair nothing is known of the scale: the first step is at most 1 long.
    const double first_alpha = pairs_.empty() ? std::min(1.0, 1 / gradient_.norm()) : 1;
    double value = value_;
    const bool found = SearchLine(first_alpha, progress, &value);
    ++summary.iterations;
    PLEAT_RETURN_IF_ERROR(
        progress.Report(static_cast<double>(summary.iterations) / options_.max_iterations, value_));
    if (!found) {
      if (pairs_.empty()) {
        summary.stop_reason = StopReason::kNoProgress;
        break;
      }
      pairs_.clear();  // try once more along the gradient
      continue;
    }
    Pair pair{trial_ - x_, trial_gradient_ - gradient_, 0};
    // A pair without clearly positive curvature would make the inverse Hessian indefinite.
    const double product = pair.step.dot(pair.change);
    if (product > 1e-12 * pair.step.norm() * pair.change.norm()) {
      pair.inverse_product = 1 / product;
      pairs_.push_back(std::move(pair));
      if (static_cast<int>(pairs_.size()) > options_.history) pairs_.pop_front();
    }
    const double gain = value_ - value;
    std::swap(x_, trial_);
    std::swap(gradient_, trial_gradient_);
    value_ = value;
    if (options_.objective_tolerance > 0 &&
        gain <= options_.objective_tolerance * std::abs(value_)) {
      summary.stop_reason = StopReason::kObjectiveTolerance;
      break;
    }
  }
  ReportEnd(evaluations_, value_, gradient_, &summary);
  return x_;
}

}  // namespace

absl::StatusOr<Eigen::VectorXd> MinimizeLbfgs(Objective& objective, const Eigen::VectorXd& start,
                                              const LbfgsOptions& options,
                                              OptimizationSummary* summary,
                                              const Progress& progress) {
  OptimizationSummary local;
  return Lbfgs(objective, options).Run(start, summary ? *summary : local, progress);
}

}  // namespace pleat
