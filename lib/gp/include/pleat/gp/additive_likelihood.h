// The negative log marginal likelihood of outputs that share one additive kernel
//
//   k = b + sum_e [ a_e exp(-g_e/2 R_e) + c_e S_e ] + (s^2 + floor) [same row]
//
// over its logs, in the order log g_1.., log a_1.., log c_1.., log s^2, log b, with a Gaussian
// prior on every log g around 1 / median distance. Source: docs/method/learner.md#gram-term;
// Duvenaud et al. 2011.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/base/progress.h"
#include "pleat/gp/gram_term.h"
#include "pleat/optimize/objective.h"
#include "pleat/simd/dense.h"

namespace pleat {

class AdditiveLikelihood : public Objective {
 public:
  // sets: one N x D_e matrix for each scale, rows with mean squared norm about 1; there must be at
  // least one. prior_precision: of log g, for each row and output. Keeps three N x N matrices per
  // set.
  AdditiveLikelihood(const std::vector<Eigen::MatrixXd>& sets, GramData data,
                     double prior_precision, Progress progress);

  int num_unknowns() const override { return 3 * num_scales() + 2; }
  // NaN when the kernel matrix cannot be factored or `progress` was cancelled.
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override;

  // Returns the logs that training starts from: widths at the median distances, and amplitudes and
  // slopes that sum to 1.
  Eigen::VectorXd Start() const;
  // Returns the whole noise variance, s^2 + floor. values: exp of the logs, in the order above.
  static double Noise(const Eigen::VectorXd& values);
  // Computes K^-1 y for other right-hand sides (N x r), with the K of the last Evaluate.
  void Solve(const Eigen::MatrixXd& right, Eigen::MatrixXd& solution);

 private:
  int num_scales() const { return static_cast<int>(distances_.size()); }
  bool Factor(const Eigen::VectorXd& values);
  void Gradient(const Eigen::VectorXd& values, Eigen::VectorXd& gradient);

  GramData data_;
  Progress progress_;
  DenseSolver solver_;
  Eigen::Index n_;
  std::vector<Eigen::MatrixXd> distances_, products_, rbf_;  // N x N each, lower
  Eigen::VectorXd prior_center_;                             // center of the prior on log g
  double precision_;
  Eigen::MatrixXd kernel_, whitener_, solution_, outer_;
};

}  // namespace pleat
