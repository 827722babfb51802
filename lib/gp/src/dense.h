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

inline DenseView ViewOf(const Eigen::MatrixXd& m, DenseShape shape = DenseShape::kFull) {
  return {m.data(), 1, m.outerStride(), shape};
}

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

  // y = M x for x (N x q) and M symmetric, of which the lower triangle is given.
  void SymmetricMultiply(const Eigen::MatrixXd& m, const Eigen::MatrixXd& x, Eigen::MatrixXd& y);

  // a (lower) = D K^-1 - K^-1 G K^-1, twice the gradient of D/2 log|K| + 1/2 tr(K^-1 G) in K, from
  // W = L^-1. G = F F^T with F square and lower triangular, given by h = W F (lower; lost).
  void GradientFromSquare(const Eigen::MatrixXd& w, double num_outputs, Eigen::MatrixXd& h,
                          Eigen::MatrixXd& a);
  // The same from K^-1 F (N x r).
  void GradientFromNarrow(const Eigen::MatrixXd& w, double num_outputs,
                          const Eigen::MatrixXd& solution, Eigen::MatrixXd& a);

  void Multiply(const DenseProduct& product);

 private:
  bool FactorBlock(double* k, double* w, ptrdiff_t n, ptrdiff_t ld);

  const DenseOps& ops_;
  std::vector<double> pack_;
  std::vector<double> temporary_;  // of FactorBlock
};

}  // namespace pleat
