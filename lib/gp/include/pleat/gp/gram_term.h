// The negative log likelihood of D independent outputs that share one Gaussian process, seen
// through the Gram matrix of the outputs alone.
//
//   w [ D/2 log|K| + 1/2 tr(K^-1 G) ],   G = Y Y^T (N x N)
//
// The cost of an evaluation is O(N^3), whatever D is. Source: the paper, section IV-B, equation of
// the shared GPLVM; Lawrence, "Probabilistic non-linear principal component analysis with Gaussian
// process latent variable models", JMLR 6 (2005). No 2 pi constants.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/gp/kernel.h"

namespace pleat {

// The outputs Y (N x D) as the Gram term needs them.
struct GramData {
  Eigen::MatrixXd factor;         // F, N x r with G = F F^T
  bool lower_triangular = false;  // F is square and lower triangular: cheaper
  double num_outputs = 0;         // D
};

// Returns the factor of Y Y^T: Y itself when it is narrow, else a Cholesky factor of Y Y^T (with
// 1e-12 of its mean diagonal added, as it is singular for centered data). The error is
// kInvalidArgument when the matrix is not finite or not semidefinite.
absl::StatusOr<GramData> MakeGramData(const Eigen::Ref<const Eigen::MatrixXd>& outputs);

// Returns the same from the Gram matrix of `num_outputs` outputs (N x N, symmetric; the lower
// triangle is read).
absl::StatusOr<GramData> MakeGramDataFromGram(const Eigen::Ref<const Eigen::MatrixXd>& gram,
                                              double num_outputs);

// Computes values and gradients in memory that is allocated once. Not for two threads at once.
class GramTerm {
 public:
  GramTerm(int num_rows, const KernelOptions& options);
  ~GramTerm();
  GramTerm(GramTerm&&) noexcept;
  GramTerm& operator=(GramTerm&&) noexcept;

  // Sets the kernel's inputs, N x Q: call it before Evaluate and after every change.
  void SetInputs(const Eigen::Ref<const Eigen::MatrixXd>& inputs);
  // From now on both terms have the inputs that either is given, so their distances are computed
  // once. Both must have the same number of rows and the same `linear`.
  void ShareInputs(const GramTerm& other);
  // From now on both terms work in the same memory, which stays in the cache: what one has computed
  // lasts until the other is evaluated, and they must not be used by two threads.
  void ShareScratch(const GramTerm& other);

  // Returns the value; NaN when K cannot be factored even with more jitter (up to 1e-3 a), or when
  // `progress` was cancelled on the way.
  double Evaluate(const KernelLogs& logs, const GramData& data, double weight, bool with_gradient,
                  const Progress& progress = {});

  // After Evaluate(..., with_gradient = true): the derivatives by the log hyperparameters in the
  // order of PackKernelLogs; zero where a log is clamped.
  const Eigen::VectorXd& log_gradient() const;
  // The derivatives by the inputs, N x Q. Call it before another term in the same scratch is
  // evaluated.
  void InputGradient(Eigen::MatrixXd& gradient);
  // weight * K^-1 F = d/dF, N x r; only for a factor that is not lower triangular.
  const Eigen::MatrixXd& weighted_solution() const;

  // Computes K^-1 y for other right-hand sides (N x r), with the K of the last Evaluate.
  void Solve(const Eigen::MatrixXd& right, Eigen::MatrixXd& solution);
  // W = L^-1 of the last Evaluate, lower triangular with K = L L^T, so that K^-1 = W^T W.
  const Eigen::MatrixXd& whitener() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pleat
