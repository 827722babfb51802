#include "dense.h"

#include <algorithm>
#include <cstdint>

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

DenseView LowerView(const double* data, ptrdiff_t ld) { return {data, 1, ld, DenseShape::kLower}; }

}  // namespace

const DenseOps& ChosenDenseOps() {
  static const DenseOps* const ops = Choose();
  return *ops;
}

void PackedRows::Pack(const DenseOps& ops, const DenseView& view, ptrdiff_t rows,
                      DenseChunk columns) {
  rows_ = rows;
  columns_ = columns;
  shape_ = view.shape;
  padded_rows_ = (rows + ops.panel_rows - 1) / ops.panel_rows * ops.panel_rows;
  constexpr size_t kSpare = kDenseAlignment / sizeof(double);
  const size_t size = static_cast<size_t>(padded_rows_ * (columns.end - columns.begin)) + kSpare;
  if (storage_.size() < size) storage_.resize(size);
  const size_t past = reinterpret_cast<uintptr_t>(storage_.data()) % kDenseAlignment;
  data_ = storage_.data() + (kSpare - past / sizeof(double)) % kSpare;
  for (ptrdiff_t begin = columns.begin; begin < columns.end; begin += kDenseDepth) {
    ops.pack(view, rows, {begin, std::min(begin + kDenseDepth, columns.end)},
             data_ + (begin - columns.begin) * padded_rows_);
  }
}

void PackedRows::Pack(const DenseOps& ops, const DenseView& view, ptrdiff_t rows, ptrdiff_t cols) {
  Pack(ops, view, rows, DenseChunk{0, cols});
}

PackedChunk PackedRows::chunk(ptrdiff_t begin) const {
  return {data_ + (begin - columns_.begin) * padded_rows_, shape_};
}

DenseSolver::DenseSolver(const DenseOps& ops) : ops_(ops) {}

void DenseSolver::Multiply(const PackedRows& a, const PackedRows& b, DenseProduct product) {
  const DenseChunk columns = a.columns();
  product.m = a.rows();
  product.n = b.rows();
  ptrdiff_t begin = columns.begin;
  do {  // even without columns: C may have to be overwritten
    ops_.multiply(product, {begin, std::min(begin + kDenseDepth, columns.end)}, a.chunk(begin),
                  b.chunk(begin));
    begin += kDenseDepth;
  } while (begin < columns.end);
}

bool DenseSolver::FactorAndInvert(Eigen::MatrixXd& k, Eigen::MatrixXd& w) {
  const ptrdiff_t n = k.rows();
  if (w.rows() != n || w.cols() != n) w.setZero(n, n);
  return n == 0 || FactorBlock(k.data(), w.data(), n, n);
}

// Recursion on [K11 .; K21 K22]: with W11 = L11^-1 everything else is products.
// L21 = K21 W11^T, K22 -= L21 L21^T, W21 = -W22 L21 W11.
bool DenseSolver::FactorBlock(double* k, double* w, ptrdiff_t n, ptrdiff_t ld) {
  if (n <= kDenseLeaf) return ops_.factor_leaf(k, w, n, ld);
  const ptrdiff_t half = std::max(n / 2 / kDenseLeaf, ptrdiff_t{1}) * kDenseLeaf;
  const ptrdiff_t rest = n - half;
  if (!FactorBlock(k, w, half, ld)) return false;

  double* const k21 = k + half;
  double* const w21 = w + half;
  double* const k22 = k21 + half * ld;
  double* const w22 = w21 + half * ld;
  const DenseView w11 = LowerView(w, ld);
  first_.Pack(ops_, {k21, 1, ld}, rest, half);
  second_.Pack(ops_, w11, half, half);
  Multiply(first_, second_, {.c = k21, .ldc = ld, .overwrite = true});
  first_.Pack(ops_, {k21, 1, ld}, rest, half);
  Multiply(first_, first_, {.alpha = -1, .c = k22, .ldc = ld, .lower = true});
  second_.Pack(ops_, w11.Transposed(), half, half);
  Multiply(first_, second_, {.c = w21, .ldc = ld, .overwrite = true});  // L21 W11
  if (!FactorBlock(k22, w22, rest, ld)) return false;

  first_.Pack(ops_, LowerView(w22, ld), rest, rest);
  second_.Pack(ops_, DenseView{w21, 1, ld}.Transposed(), half, rest);
  Multiply(first_, second_, {.alpha = -1, .c = w21, .ldc = ld, .overwrite = true});
  return true;
}

void DenseSolver::MultiplyByFactor(const Eigen::MatrixXd& w, bool transposed,
                                   const Eigen::MatrixXd& f, bool f_lower, Eigen::MatrixXd& h) {
  const ptrdiff_t n = w.rows(), r = f.cols();
  h.resize(n, r);
  const DenseView factor = ViewOf(w, DenseShape::kLower);
  first_.Pack(ops_, transposed ? factor.Transposed() : factor, n, n);
  second_.Pack(ops_, ViewOf(f, f_lower ? DenseShape::kLower : DenseShape::kFull).Transposed(), r,
               n);
  Multiply(first_, second_, {.c = h.data(), .ldc = n, .overwrite = true});
}

void DenseSolver::OuterProduct(const Eigen::MatrixXd& b, Eigen::MatrixXd& s) {
  const ptrdiff_t n = b.rows();
  s.setZero(n, n);
  MultiplyRows(ViewOf(b), ViewOf(b), b.cols(),
               {.c = s.data(), .ldc = n, .m = n, .n = n, .lower = true});
}

void DenseSolver::SymmetricMultiply(const Eigen::MatrixXd& m, const Eigen::MatrixXd& x,
                                    Eigen::MatrixXd& y) {
  const ptrdiff_t n = m.rows(), q = x.cols();
  y.resize(n, q);
  MultiplyRows(ViewOf(m, DenseShape::kSymmetric), ViewOf(x).Transposed(), n,
               {.c = y.data(), .ldc = n, .m = n, .n = q, .overwrite = true});
}

// W^T (D I - H H^T) W. Of T = (D I - H H^T) W the product with W^T sees the lower triangle only.
void DenseSolver::GradientFromSquare(const Eigen::MatrixXd& w, double num_outputs,
                                     Eigen::MatrixXd& h, Eigen::MatrixXd& a) {
  const ptrdiff_t n = w.rows();
  a.resize(n, n);
  const DenseProduct to_a{.c = a.data(), .ldc = n, .lower = true, .overwrite = true};
  DenseProduct minus = to_a, to_h = to_a;
  minus.alpha = -1;
  to_h.c = h.data();
  first_.Pack(ops_, ViewOf(h, DenseShape::kLower), n, n);
  Multiply(first_, first_, minus);
  a.diagonal().array() += num_outputs;
  first_.Pack(ops_, ViewOf(a, DenseShape::kSymmetric), n, n);
  second_.Pack(ops_, ViewOf(w, DenseShape::kLower).Transposed(), n, n);
  Multiply(first_, second_, to_h);
  first_.Pack(ops_, ViewOf(h, DenseShape::kLower).Transposed(), n, n);
  Multiply(second_, first_, to_a);
}

// D W^T W - S S^T with S = W^T H.
void DenseSolver::GradientFromNarrow(const Eigen::MatrixXd& w, double num_outputs,
                                     const Eigen::MatrixXd& h, Eigen::MatrixXd& solution,
                                     Eigen::MatrixXd& a) {
  const ptrdiff_t n = w.rows(), r = h.cols();
  solution.resize(n, r);
  a.resize(n, n);
  first_.Pack(ops_, ViewOf(w, DenseShape::kLower).Transposed(), n, n);
  second_.Pack(ops_, ViewOf(h).Transposed(), r, n);
  Multiply(first_, second_, {.c = solution.data(), .ldc = n, .overwrite = true});
  Multiply(first_, first_,
           {.alpha = num_outputs, .c = a.data(), .ldc = n, .lower = true, .overwrite = true});
  second_.Pack(ops_, ViewOf(solution), n, r);
  Multiply(second_, second_, {.alpha = -1, .c = a.data(), .ldc = n, .lower = true});
}

// Packs one chunk at a time: k may be large.
void DenseSolver::MultiplyRows(const DenseView& a, const DenseView& b, ptrdiff_t k,
                               const DenseProduct& product) {
  for (ptrdiff_t begin = 0; begin == 0 || begin < k; begin += kDenseDepth) {
    const DenseChunk columns{begin, std::min(begin + kDenseDepth, k)};
    first_.Pack(ops_, a, product.m, columns);
    second_.Pack(ops_, b, product.n, columns);
    Multiply(first_, second_, product);
  }
}

}  // namespace pleat
