// The negative log marginal likelihood of outputs that share one kernel, with priors, over the
// kernel's logs and those of the relevance of groups of inputs (docs/method/learner.md#relevance).
//
// Source: Rasmussen and Williams (2006), chapter 5; automatic relevance determination: D. MacKay,
// "Bayesian non-linear modeling for the prediction competition", ASHRAE Transactions 100 (1994).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/base/progress.h"
#include "pleat/gp/gp_regression.h"
#include "pleat/gp/gram_term.h"
#include "pleat/optimize/objective.h"

namespace pleat {

// Returns what multiplies each of `num_inputs` columns when `logs` are those of the groups' factors
// on squared distances: exp(log / 2), and 1 for columns in no group.
Eigen::VectorXd RelevanceFactors(const std::vector<std::vector<int>>& groups,
                                 const Eigen::Ref<const Eigen::VectorXd>& logs,
                                 Eigen::Index num_inputs);

// The unknowns are those of PackKernelLogs, then one log for each of options.input_groups.
class MarginalLikelihood : public Objective {
 public:
  // inputs: N x D, normalized. prior_center: of log g. `options` must outlive this object.
  MarginalLikelihood(Eigen::MatrixXd inputs, GramData data, const GpRegressionOptions& options,
                     double prior_center, Progress progress);

  int num_kernel_unknowns() const { return NumKernelUnknowns(options_.kernel); }
  int num_groups() const { return static_cast<int>(options_.input_groups.size()); }
  int num_unknowns() const override { return num_kernel_unknowns() + num_groups(); }
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override;

 private:
  void RelevanceGradient(const Eigen::Ref<const Eigen::VectorXd>& logs,
                         Eigen::Ref<Eigen::VectorXd> gradient);

  const GpRegressionOptions& options_;
  Eigen::MatrixXd inputs_, scaled_, input_gradient_;  // N x D
  GramData data_;
  GramTerm term_;
  double num_values_;  // rows times outputs
  double prior_center_;
  Progress progress_;
};

}  // namespace pleat
