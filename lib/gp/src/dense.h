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

// The rows of a matrix as products read them.
class PackedRows {
 public:
  // `view`: rows x cols.
  void Pack(const DenseOps& ops, const DenseView& view, ptrdiff_t rows, ptrdiff_t cols);

  // Some columns of it; columns.begin is a multiple of kDenseDepth.
  void Pack(const DenseOps& ops, const DenseView& view, ptrdiff_t rows, DenseChunk columns);

  ptrdiff_t rows() const { return rows_; }
  DenseChunk columns() const { return columns_; }
  // The chunk of the columns from `begin` on, a multiple of kDenseDepth.
  PackedChunk chunk(ptrdiff_t begin) const;

 private:
  ptrdiff_t rows_ = 0, padded_rows_ = 0;
  DenseChunk columns_;
  DenseShape shape_ = DenseShape::kFull;
  std::vector<double> storage_;
  double* data_ = nullptr;  // aligned, within storage_
};

// Preallocated scratch + algorithms; not for two threads at once.
class DenseSolver {
 public:
  explicit DenseSolver(const DenseOps& ops = ChosenDenseOps());

  const DenseOps& ops() const { return ops_; }

  // Cholesky K = L L^T of the lower triangle of `k` (N x N) in place, and W = L^-1 (lower; zero
  // above the diagonal, where a `w` of that size must be zero on entry, as an earlier call leaves
  // it). False when K is not positive definite in double precision.
  bool FactorAndInvert(Eigen::MatrixXd& k, Eigen::MatrixXd& w);

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
  // The same from h = W F of a narrow F (N x r); solution = K^-1 F (N x r).
  void GradientFromNarrow(const Eigen::MatrixXd& w, double num_outputs, const Eigen::MatrixXd& h,
                          Eigen::MatrixXd& solution, Eigen::MatrixXd& a);

  // C = or += alpha A B^T for A (m x k) and B (n x k), with the rest of `product` as given.
  void MultiplyRows(const DenseView& a, const DenseView& b, ptrdiff_t k,
                    const DenseProduct& product);

 private:
  bool FactorBlock(double* k, double* w, ptrdiff_t n, ptrdiff_t ld);
  void Multiply(const PackedRows& a, const PackedRows& b, DenseProduct product);

  const DenseOps& ops_;
  PackedRows first_, second_;
};

}  // namespace pleat
