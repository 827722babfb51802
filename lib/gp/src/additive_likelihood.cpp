// The likelihood behind the regional learner. One GP has one kernel over all inputs; here the
// kernel is a sum over sets of inputs ("all joints", "joints near the region", "nearest joints"),
// each with a width g_e, an amplitude a_e and a slope c_e of its own, plus shared noise and bias. A
// sum of kernels is the kernel of a sum of functions, so the model may explain one part of the
// output by near joints alone, and that part carries over to poses whose far joints are new. Nobody
// chooses how much: the likelihood does, by moving amplitude from one set to another.
//
// For N rows and E sets the squared distances R_e and products S_e never change while
// hyperparameters are learned. The constructor computes them, and an evaluation costs E N^2
// exponentials and one Cholesky factorization with its inverse, O(N^3), whatever the numbers of
// inputs and outputs are. Outputs enter through a factor of their Gram matrix only (gram_term.h),
// as for a single kernel.
//
// With G = Y Y^T and A = (D K^-1 - K^-1 G K^-1) / 2, the gradient by a log hyperparameter h is
// sum_ij A_ij dK_ij/dh, and each dK/dh is a matrix that is there already: the RBF part of a set
// (amplitude), the same times -g/2 R (width), c S (slope), and diagonals or constants for noise and
// bias. So all 3 E + 2 derivatives are sums of products with entries of A.
//
// Only lower triangles are valid. The kernels in the upper triangle are exp of distances that were
// never computed, so A is zeroed there before it is multiplied with them.
//
// There is no second try with more jitter as in gram_term.cpp: the noise floor, a share of the
// summed amplitudes, is part of the model and of its gradient, and where K cannot be factored all
// the same, the value is NaN and the optimizer steps back. A prior on every log g keeps widths near
// the median distances (docs/method/learner.md#priors-and-floors says why). Logs outside of +-14
// act as the bound; their gradient is zero but for the prior, which leads back.
//
// An object serves one thread: Evaluate() leaves the factor behind for Solve().

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

// Computes K, its Cholesky factor (in place of K) and the factor's inverse.
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
  // A = (D K^-1 - K^-1 G K^-1) / 2, of which outer_ holds twice the lower triangle: entries off the
  // diagonal then count for both halves of a sum.
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
