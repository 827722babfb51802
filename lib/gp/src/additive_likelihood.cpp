#include "pleat/gp/additive_likelihood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pleat/gp/kernel.h"
#include "pleat/gp/scaling.h"

namespace pleat {
namespace {

constexpr double kNoiseFloor = 1e-6;  // share of the amplitudes

}  // namespace

AdditiveLikelihood::AdditiveLikelihood(const std::vector<Eigen::MatrixXd>& sets, GramData data,
                                       double prior_precision, Progress progress)
    : data_(std::move(data)),
      progress_(std::move(progress)),
      n_(sets.front().rows()),
      prior_center_(static_cast<Eigen::Index>(sets.size())),
      precision_(prior_precision * double(n_) * data_.num_outputs) {
  distances_.assign(sets.size(), Eigen::MatrixXd::Zero(n_, n_));
  products_ = rbf_ = distances_;
  kernel_ = whitener_ = outer_ = Eigen::MatrixXd::Zero(n_, n_);
  for (size_t e = 0; e < sets.size(); ++e) {
    solver_.ops().squared_distances(sets[e].data(), n_, sets[e].cols(), distances_[e].data());
    solver_.OuterProduct(sets[e], products_[e]);
    prior_center_[e] = -std::log(MedianSquaredDistance(distances_[e]));
  }
}

Eigen::VectorXd AdditiveLikelihood::Start() const {
  const int scales = num_scales();
  Eigen::VectorXd start(num_unknowns());
  start.head(scales) = prior_center_;
  start.segment(scales, 2 * scales).setConstant(std::log(.5 / scales));
  start[3 * scales] = std::log(1e-2);
  start[3 * scales + 1] = -4;
  return start;
}

double AdditiveLikelihood::Noise(const Eigen::VectorXd& values) {
  const Eigen::Index scales = (values.size() - 2) / 3;
  return values[3 * scales] + kNoiseFloor * values.segment(scales, scales).sum();
}

// K, its Cholesky factor and the factor's inverse.
bool AdditiveLikelihood::Factor(const Eigen::VectorXd& values) {
  const int scales = num_scales();
  kernel_.setConstant(values[3 * scales + 1]);
  for (int e = 0; e < scales; ++e) {
    rbf_[e] = -.5 * values[e] * distances_[e];
    solver_.ops().exp_in_place(rbf_[e].data(), rbf_[e].size());
    rbf_[e] *= values[scales + e];
    kernel_ += rbf_[e] + values[2 * scales + e] * products_[e];
  }
  kernel_.diagonal().array() += Noise(values);
  return solver_.FactorAndInvert(kernel_, whitener_);
}

void AdditiveLikelihood::Gradient(const Eigen::VectorXd& values, Eigen::VectorXd& gradient) {
  const int scales = num_scales();
  solver_.Gradient(whitener_, data_.num_outputs, solution_, outer_);
  // A = (D K^-1 - K^-1 G K^-1) / 2 below the diagonal, doubled there: sums run over both halves.
  outer_.triangularView<Eigen::StrictlyUpper>().setZero();
  outer_.diagonal() *= .5;
  const double trace = outer_.trace();
  for (int e = 0; e < scales; ++e) {
    const double amplitude = (outer_.array() * rbf_[e].array()).sum();
    const double distance = (outer_.array() * rbf_[e].array() * distances_[e].array()).sum();
    gradient[e] = -.5 * values[e] * distance;
    gradient[scales + e] = amplitude + kNoiseFloor * values[scales + e] * trace;
    gradient[2 * scales + e] =
        values[2 * scales + e] * (outer_.array() * products_[e].array()).sum();
  }
  gradient[3 * scales] = values[3 * scales] * trace;
  gradient[3 * scales + 1] = values[3 * scales + 1] * outer_.sum();
}

double AdditiveLikelihood::Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
  const int scales = num_scales();
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const Eigen::VectorXd values = x.cwiseMax(-kMaxKernelLog).cwiseMin(kMaxKernelLog).array().exp();
  if (progress_.cancelled() || !Factor(values)) return kNone;
  const double log_determinant = 2 * kernel_.diagonal().array().log().sum();
  const double trace = solver_.Whiten(whitener_, data_.factor, data_.lower_triangular);
  const Eigen::VectorXd away = x.head(scales) - prior_center_;
  const double value =
      .5 * (data_.num_outputs * log_determinant + trace) + .5 * precision_ * away.squaredNorm();
  if (gradient) {
    gradient->resize(num_unknowns());
    Gradient(values, *gradient);
    for (int i = 0; i < num_unknowns(); ++i) {
      if (std::abs(x[i]) > kMaxKernelLog) (*gradient)[i] = 0;
    }
    gradient->head(scales) += precision_ * away;
  }
  return value;
}

void AdditiveLikelihood::Solve(const Eigen::MatrixXd& right, Eigen::MatrixXd& solution) {
  Eigen::MatrixXd whitened;
  solver_.MultiplyByFactor(whitener_, false, right, whitened);
  solver_.MultiplyByFactor(whitener_, true, whitened, solution);
}

}  // namespace pleat
