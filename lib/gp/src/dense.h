// Dense symmetric linear algebra of the Gram term, on the fastest kernels of this processor.
//
// Processors with FMA (all since 2013) give the same bits, whatever their register width; older
// ones differ in the last digits.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "dense_ops.h"

namespace pleat {

// The kernels this process uses.
const DenseOps& ChosenDenseOps();

inline DenseView ViewOf(const Eigen::MatrixXd& m) { return {m.data(), 1, m.outerStride()}; }

// Preallocated scratch + algorithms; not for two threads at once.
class DenseSolver {
 public:
  explicit DenseSolver(const DenseOps& ops = ChosenDenseOps());

  const DenseOps& ops() const { return ops_; }

  // Cholesky K = L L^T of the lower triangle of `k` (N x N) in place, and W = L^-1 (lower; zero
  // above the diagonal). False when K is not positive definite in double precision.
  bool FactorAndInvert(Eigen::MatrixXd& k, Eigen::MatrixXd& w);

  // q (lower) = W^T W = K^-1.
  void InverseFromFactor(const Eigen::MatrixXd& w, Eigen::MatrixXd& q);

  // h = W f for f (N x r), or h = W^T f with `transposed`. `f_lower`: f is square and lower
  // triangular.
  void MultiplyByFactor(const Eigen::MatrixXd& w, bool transposed, const Eigen::MatrixXd& f,
                        bool f_lower, Eigen::MatrixXd& h);

  // s (lower) = b b^T.
  void OuterProduct(const Eigen::MatrixXd& b, Eigen::MatrixXd& s);

  // c += alpha op(a) op(b).
  void MultiplyAdd(double alpha, DenseView a, DenseView b, double* c, ptrdiff_t ldc, ptrdiff_t m,
                   ptrdiff_t n, ptrdiff_t k, bool lower = false);

 private:
  bool FactorBlock(double* k, double* w, ptrdiff_t n, ptrdiff_t ld);

  const DenseOps& ops_;
  std::vector<double> pack_;
  std::vector<double> temporary_;  // of FactorBlock
};

}  // namespace pleat
