// Dense symmetric linear algebra of the Gram term, on the fastest kernels of this processor.
//
// Processors with FMA (all since 2013) give the same bits, whatever their register width; older
// ones differ in the last digits.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/simd/dense_ops.h"
#include "pleat/simd/dispatch.h"

namespace pleat {

// Those this processor can run, the fastest first.
const KernelVariants<const DenseOps*>& DenseVariants();
// The kernels this process uses: the first of them.
const DenseOps& ChosenDenseOps();

inline DenseView ViewOf(const Eigen::MatrixXd& m, DenseShape shape = DenseShape::kFull) {
  return {m.data(), 1, m.outerStride(), shape};
}

// The rows of a matrix as products read them.
class PackedRows {
 public:
  PackedRows() = default;
  PackedRows(PackedRows&&) = default;  // no copies: data_ points into storage_
  PackedRows& operator=(PackedRows&&) = default;

  // `view`: rows x cols.
  void Pack(const DenseOps& ops, const DenseView& view, ptrdiff_t rows, ptrdiff_t cols);
  // Some columns of it; columns.begin is a multiple of kDenseDepth.
  void Pack(const DenseOps& ops, const DenseView& view, ptrdiff_t rows, DenseChunk columns);
  // Room for the product of an m x k by a k x n matrix that has `shape`; sets where it goes.
  void Receive(const DenseOps& ops, DenseShape shape, ptrdiff_t m, ptrdiff_t n,
               DenseProduct* product);

  ptrdiff_t rows() const { return rows_; }
  DenseChunk columns() const { return columns_; }
  // The chunk of the columns from `begin` on, a multiple of kDenseDepth.
  PackedChunk chunk(ptrdiff_t begin) const;
  double SquaredNorm(const DenseOps& ops) const;

 private:
  void Resize(const DenseOps& ops, DenseShape shape, ptrdiff_t rows, DenseChunk columns);

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

  // h = W f for f (N x r), or h = W^T f with `transposed`.
  void MultiplyByFactor(const Eigen::MatrixXd& w, bool transposed, const Eigen::MatrixXd& f,
                        Eigen::MatrixXd& h);

  // s (lower) = b b^T.
  void OuterProduct(const Eigen::MatrixXd& b, Eigen::MatrixXd& s);

  // y = M x for x (N x q) and M symmetric, of which the lower triangle is given.
  void SymmetricMultiply(const Eigen::MatrixXd& m, const Eigen::MatrixXd& x, Eigen::MatrixXd& y);

  // tr(K^-1 G) of G = F F^T (F: N x r, lower triangular with `f_lower`) from W = L^-1. Keeps W F
  // for Gradient.
  double Whiten(const Eigen::MatrixXd& w, const Eigen::MatrixXd& f, bool f_lower);
  // After Whiten: a (lower) = D K^-1 - K^-1 G K^-1, twice the gradient in K of
  // D/2 log|K| + 1/2 tr(K^-1 G). `solution` = K^-1 F (N x r), unless F is lower triangular.
  void Gradient(const Eigen::MatrixXd& w, double num_outputs, Eigen::MatrixXd& solution,
                Eigen::MatrixXd& a);

  // C = or += alpha A B^T for A (m x k) and B (n x k), with the rest of `product` as given.
  void MultiplyRows(const DenseView& a, const DenseView& b, ptrdiff_t k,
                    const DenseProduct& product);

 private:
  bool FactorBlock(double* k, double* w, ptrdiff_t n, ptrdiff_t ld, size_t level);
  void GradientOfSquare(double num_outputs, Eigen::MatrixXd& a);
  void GradientOfNarrow(double num_outputs, Eigen::MatrixXd& solution, Eigen::MatrixXd& a);
  void Multiply(const PackedRows& a, const PackedRows& b, DenseProduct product);

  const DenseOps& ops_;
  PackedRows first_, second_;
  PackedRows whitened_;             // H = W F when F is lower triangular, else H^T
  bool whitened_square_ = false;    // which of the two
  std::vector<PackedRows> levels_;  // of the recursion of FactorBlock
};

}  // namespace pleat
