#include "dense.h"

#include <algorithm>
#include <cmath>

namespace pleat {
namespace {

constexpr ptrdiff_t kBlock = 48;  // granularity of the triangles: a multiple of every micro tile
constexpr ptrdiff_t kLeaf = 24;   // below it the factorisation is written out

// Unblocked Cholesky and inverse of an n x n leaf.
bool FactorLeaf(double* k, double* w, ptrdiff_t n, ptrdiff_t ld) {
  for (ptrdiff_t j = 0; j < n; ++j) {
    double* column = k + j * ld;
    for (ptrdiff_t p = 0; p < j; ++p) {
      const double* previous = k + p * ld;
      const double factor = previous[j];
      for (ptrdiff_t i = j; i < n; ++i) column[i] -= factor * previous[i];
    }
    if (!(column[j] > 0) || !std::isfinite(column[j])) return false;
    const double pivot = std::sqrt(column[j]);
    column[j] = pivot;
    for (ptrdiff_t i = j + 1; i < n; ++i) column[i] /= pivot;
  }
  for (ptrdiff_t j = 0; j < n; ++j) {  // forward substitution of unit vector j
    double* column = w + j * ld;
    column[j] = 1;
    for (ptrdiff_t i = j + 1; i < n; ++i) column[i] = 0;
    for (ptrdiff_t p = j; p < n; ++p) {
      const double* factor = k + p * ld;
      column[p] /= factor[p];
      for (ptrdiff_t i = p + 1; i < n; ++i) column[i] -= column[p] * factor[i];
    }
  }
  return true;
}

const DenseOps* Choose() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && Avx512DenseOps()) return Avx512DenseOps();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && Avx2DenseOps()) {
    return Avx2DenseOps();
  }
#endif
  return BaselineDenseOps();
}

}  // namespace

const DenseOps& ChosenDenseOps() {
  static const DenseOps* const ops = Choose();
  return *ops;
}

DenseSolver::DenseSolver(const DenseOps& ops) : ops_(ops), pack_(ops.pack_size) {}

void DenseSolver::MultiplyAdd(double alpha, DenseView a, DenseView b, double* c, ptrdiff_t ldc,
                              ptrdiff_t m, ptrdiff_t n, ptrdiff_t k, bool lower) {
  if (m > 0 && n > 0 && k > 0) ops_.multiply_add(alpha, a, b, c, ldc, m, n, k, lower, pack_.data());
}

bool DenseSolver::FactorAndInvert(Eigen::MatrixXd& k, Eigen::MatrixXd& w) {
  const ptrdiff_t n = k.rows();
  w.setZero(n, n);
  temporary_.resize(std::max<size_t>(temporary_.size(), (n / 2 + 1) * (n / 2 + 1)));
  return n == 0 || FactorBlock(k.data(), w.data(), n, n);
}

// Recursion on [K11 .; K21 K22]: with W11 = L11^-1 everything else is products.
// L21 = K21 W11^T, K22 -= L21 L21^T, W21 = -W22 L21 W11.
bool DenseSolver::FactorBlock(double* k, double* w, ptrdiff_t n, ptrdiff_t ld) {
  if (n <= kLeaf) return FactorLeaf(k, w, n, ld);
  ptrdiff_t half = n / 2;
  if (half > kBlock) half = half / kBlock * kBlock;
  const ptrdiff_t rest = n - half;
  if (!FactorBlock(k, w, half, ld)) return false;

  double* k21 = k + half;
  double* w21 = w + half;
  double* k22 = k21 + half * ld;
  double* w22 = w21 + half * ld;
  // Column block j of L21 needs columns 0..j of K21: from the right, in place into W21 first.
  for (ptrdiff_t j = 0; j < half; j += kBlock) {
    const ptrdiff_t cols = std::min(kBlock, half - j);
    MultiplyAdd(1, {k21, 1, ld}, DenseView{w, 1, ld}.Block(j, 0).Transposed(), w21 + j * ld, ld,
                rest, cols, j + cols);
  }
  for (ptrdiff_t j = 0; j < half; ++j) {
    std::copy_n(w21 + j * ld, rest, k21 + j * ld);
    std::fill_n(w21 + j * ld, rest, 0.0);
  }
  MultiplyAdd(-1, {k21, 1, ld}, DenseView{k21, 1, ld}.Transposed(), k22, ld, rest, rest, half,
              true);
  if (!FactorBlock(k22, w22, rest, ld)) return false;

  // The temporary is free: the recursions above have returned.
  temporary_.resize(std::max<size_t>(temporary_.size(), rest * half));
  double* product = temporary_.data();
  std::fill_n(product, rest * half, 0.0);
  for (ptrdiff_t j = 0; j < half; j += kBlock) {
    const ptrdiff_t cols = std::min(kBlock, half - j);
    MultiplyAdd(1, DenseView{k21, 1, ld}.Block(0, j), DenseView{w, 1, ld}.Block(j, j),
                product + j * rest, rest, rest, cols, half - j);
  }
  for (ptrdiff_t i = 0; i < rest; i += kBlock) {
    const ptrdiff_t rows = std::min(kBlock, rest - i);
    MultiplyAdd(-1, DenseView{w22, 1, ld}.Block(i, 0), {product, 1, rest}, w21 + i, ld, rows, half,
                i + rows);
  }
  return true;
}

void DenseSolver::InverseFromFactor(const Eigen::MatrixXd& w, Eigen::MatrixXd& q) {
  const ptrdiff_t n = w.rows();
  q.setZero(n, n);
  const DenseView view = ViewOf(w);
  for (ptrdiff_t i = 0; i < n; i += kBlock) {
    const ptrdiff_t rows = std::min(kBlock, n - i);
    MultiplyAdd(1, view.Block(i, i).Transposed(), view.Block(i, 0), q.data() + i, n, rows, i + rows,
                n - i);
  }
}

void DenseSolver::MultiplyByFactor(const Eigen::MatrixXd& w, bool transposed,
                                   const Eigen::MatrixXd& f, bool f_lower, Eigen::MatrixXd& h) {
  const ptrdiff_t n = w.rows(), r = f.cols();
  h.setZero(n, r);
  const DenseView left = transposed ? ViewOf(w).Transposed() : ViewOf(w);
  const DenseView right = ViewOf(f);
  const ptrdiff_t column_block = f_lower ? kBlock : r;
  for (ptrdiff_t i = 0; i < n; i += kBlock) {
    const ptrdiff_t rows = std::min(kBlock, n - i);
    for (ptrdiff_t j = 0; j < r; j += column_block) {
      // W is zero right of row i + rows, W^T left of row i, f above its diagonal.
      const ptrdiff_t begin = std::max(transposed ? i : 0, f_lower ? j : 0);
      const ptrdiff_t end = transposed ? n : i + rows;
      MultiplyAdd(1, left.Block(i, begin), right.Block(begin, j), h.data() + i + j * n, n, rows,
                  std::min(column_block, r - j), end - begin);
    }
  }
}

void DenseSolver::OuterProduct(const Eigen::MatrixXd& b, Eigen::MatrixXd& s) {
  const ptrdiff_t n = b.rows();
  s.setZero(n, n);
  MultiplyAdd(1, ViewOf(b), ViewOf(b).Transposed(), s.data(), n, n, n, b.cols(), true);
}

}  // namespace pleat
