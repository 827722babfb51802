#include "dense.h"

#include <algorithm>

namespace pleat {
namespace {

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

void DenseSolver::Multiply(const DenseProduct& product) {
  if (product.m > 0 && product.n > 0) ops_.multiply(product, pack_.data());
}

bool DenseSolver::FactorAndInvert(Eigen::MatrixXd& k, Eigen::MatrixXd& w) {
  const ptrdiff_t n = k.rows();
  w.resize(n, n);
  temporary_.resize(std::max<size_t>(temporary_.size(), (n / 2 + 1) * (n / 2 + kDenseLeaf)));
  return n == 0 || FactorBlock(k.data(), w.data(), n, n);
}

// Recursion on [K11 .; K21 K22]: with W11 = L11^-1 everything else is products.
// L21 = K21 W11^T, K22 -= L21 L21^T, W21 = -W22 L21 W11.
bool DenseSolver::FactorBlock(double* k, double* w, ptrdiff_t n, ptrdiff_t ld) {
  if (n <= kDenseLeaf) return ops_.factor_leaf(k, w, n, ld);
  const ptrdiff_t half = std::max(n / 2 / kDenseLeaf, ptrdiff_t{1}) * kDenseLeaf;
  const ptrdiff_t rest = n - half;
  if (!FactorBlock(k, w, half, ld)) return false;

  double* k21 = k + half;
  double* w21 = w + half;
  double* k22 = k21 + half * ld;
  double* w22 = w21 + half * ld;
  const DenseView w11{w, 1, ld, DenseShape::kLower}, l21{k21, 1, ld};
  Multiply({.a = {k21, 1, ld},
            .b = w11.Transposed(),
            .c = w21,
            .ldc = ld,
            .m = rest,
            .n = half,
            .k = half,
            .overwrite = true});
  for (ptrdiff_t j = 0; j < half; ++j) std::copy_n(w21 + j * ld, rest, k21 + j * ld);
  Multiply({.alpha = -1,
            .a = l21,
            .b = l21.Transposed(),
            .c = k22,
            .ldc = ld,
            .m = rest,
            .n = rest,
            .k = half,
            .lower = true});
  if (!FactorBlock(k22, w22, rest, ld)) return false;

  // The temporary is free: the recursions above have returned.
  temporary_.resize(std::max<size_t>(temporary_.size(), rest * half));
  double* product = temporary_.data();
  Multiply({.a = l21,
            .b = w11,
            .c = product,
            .ldc = rest,
            .m = rest,
            .n = half,
            .k = half,
            .overwrite = true});
  Multiply({.alpha = -1,
            .a = {w22, 1, ld, DenseShape::kLower},
            .b = {product, 1, rest},
            .c = w21,
            .ldc = ld,
            .m = rest,
            .n = half,
            .k = rest,
            .overwrite = true});
  for (ptrdiff_t j = half; j < n; ++j) std::fill_n(w + j * ld, half, 0.0);
  return true;
}

void DenseSolver::InverseFromFactor(const Eigen::MatrixXd& w, Eigen::MatrixXd& q) {
  const ptrdiff_t n = w.rows();
  q.resize(n, n);
  const DenseView view = ViewOf(w, DenseShape::kLower);
  Multiply({.a = view.Transposed(),
            .b = view,
            .c = q.data(),
            .ldc = n,
            .m = n,
            .n = n,
            .k = n,
            .lower = true,
            .overwrite = true});
}

void DenseSolver::MultiplyByFactor(const Eigen::MatrixXd& w, bool transposed,
                                   const Eigen::MatrixXd& f, bool f_lower, Eigen::MatrixXd& h) {
  const ptrdiff_t n = w.rows(), r = f.cols();
  h.resize(n, r);
  const DenseView view = ViewOf(w, DenseShape::kLower);
  Multiply({.a = transposed ? view.Transposed() : view,
            .b = ViewOf(f, f_lower ? DenseShape::kLower : DenseShape::kFull),
            .c = h.data(),
            .ldc = n,
            .m = n,
            .n = r,
            .k = n,
            .overwrite = true});
}

void DenseSolver::OuterProduct(const Eigen::MatrixXd& b, Eigen::MatrixXd& s) {
  const ptrdiff_t n = b.rows();
  s.setZero(n, n);
  Multiply({.a = ViewOf(b),
            .b = ViewOf(b).Transposed(),
            .c = s.data(),
            .ldc = n,
            .m = n,
            .n = n,
            .k = b.cols(),
            .lower = true});
}

void DenseSolver::SymmetricMultiply(const Eigen::MatrixXd& m, const Eigen::MatrixXd& x,
                                    Eigen::MatrixXd& y) {
  const ptrdiff_t n = m.rows();
  y.resize(n, x.cols());
  Multiply({.a = ViewOf(m, DenseShape::kSymmetric),
            .b = ViewOf(x),
            .c = y.data(),
            .ldc = n,
            .m = n,
            .n = x.cols(),
            .k = n,
            .overwrite = true});
}

// W^T (D I - H H^T) W. Of T = (D I - H H^T) W the product with W^T sees the lower triangle only.
void DenseSolver::GradientFromSquare(const Eigen::MatrixXd& w, double num_outputs,
                                     Eigen::MatrixXd& h, Eigen::MatrixXd& a) {
  const ptrdiff_t n = w.rows();
  a.resize(n, n);
  const DenseView lower = ViewOf(h, DenseShape::kLower), factor = ViewOf(w, DenseShape::kLower);
  Multiply({.alpha = -1,
            .a = lower,
            .b = lower.Transposed(),
            .c = a.data(),
            .ldc = n,
            .m = n,
            .n = n,
            .k = n,
            .lower = true,
            .overwrite = true});
  a.diagonal().array() += num_outputs;
  Multiply({.a = ViewOf(a, DenseShape::kSymmetric),
            .b = factor,
            .c = h.data(),
            .ldc = n,
            .m = n,
            .n = n,
            .k = n,
            .lower = true,
            .overwrite = true});
  Multiply({.a = factor.Transposed(),
            .b = lower,
            .c = a.data(),
            .ldc = n,
            .m = n,
            .n = n,
            .k = n,
            .lower = true,
            .overwrite = true});
}

void DenseSolver::GradientFromNarrow(const Eigen::MatrixXd& w, double num_outputs,
                                     const Eigen::MatrixXd& solution, Eigen::MatrixXd& a) {
  const ptrdiff_t n = w.rows();
  a.resize(n, n);
  const DenseView factor = ViewOf(w, DenseShape::kLower), narrow = ViewOf(solution);
  Multiply({.alpha = num_outputs,
            .a = factor.Transposed(),
            .b = factor,
            .c = a.data(),
            .ldc = n,
            .m = n,
            .n = n,
            .k = n,
            .lower = true,
            .overwrite = true});
  Multiply({.alpha = -1,
            .a = narrow,
            .b = narrow.Transposed(),
            .c = a.data(),
            .ldc = n,
            .m = n,
            .n = n,
            .k = solution.cols(),
            .lower = true});
}

}  // namespace pleat
