#include "pleat/simd/dense.h"

#include <algorithm>
#include <cstdint>

namespace pleat {
namespace {

DenseView LowerView(const double* data, ptrdiff_t ld) { return {data, 1, ld, DenseShape::kLower}; }

}  // namespace

const KernelVariants<const DenseOps*>& DenseVariants() {
  using enum InstructionSet;
  static const auto variants = RunnableVariants<const DenseOps*>(
      {{kAvx512, Avx512DenseOps()}, {kAvx2, Avx2DenseOps()}, {kBaseline, BaselineDenseOps()}});
  return variants;
}

const DenseOps& ChosenDenseOps() { return *DenseVariants().front().kernel; }

void PackedRows::Resize(const DenseOps& ops, DenseShape shape, ptrdiff_t rows, DenseChunk columns) {
  rows_ = rows;
  columns_ = columns;
  shape_ = shape;
  padded_rows_ = (rows + ops.panel_rows - 1) / ops.panel_rows * ops.panel_rows;
  constexpr size_t kSpare = kDenseAlignment / sizeof(double);
  const size_t size = static_cast<size_t>(padded_rows_ * (columns.end - columns.begin)) + kSpare;
  if (storage_.size() < size) storage_.resize(size);
  const size_t past = reinterpret_cast<uintptr_t>(storage_.data()) % kDenseAlignment;
  data_ = storage_.data() + (kSpare - past / sizeof(double)) % kSpare;
}

void PackedRows::Pack(const DenseOps& ops, const DenseView& view, ptrdiff_t rows,
                      DenseChunk columns) {
  Resize(ops, view.shape, rows, columns);
  for (ptrdiff_t begin = columns.begin; begin < columns.end; begin += kDenseDepth) {
    ops.pack(view, rows, {begin, std::min(begin + kDenseDepth, columns.end)},
             data_ + (begin - columns.begin) * padded_rows_);
  }
}

void PackedRows::Pack(const DenseOps& ops, const DenseView& view, ptrdiff_t rows, ptrdiff_t cols) {
  Pack(ops, view, rows, DenseChunk{0, cols});
}

void PackedRows::Receive(const DenseOps& ops, DenseShape shape, ptrdiff_t m, ptrdiff_t n,
                         DenseProduct* product) {
  Resize(ops, shape, m, {0, n});
  product->c = data_;
  product->ldc = padded_rows_;
  product->part = shape == DenseShape::kLower   ? DensePart::kLower
                  : shape == DenseShape::kUpper ? DensePart::kUpper
                                                : DensePart::kAll;
  product->overwrite = true;
  product->packed = true;
}

PackedChunk PackedRows::chunk(ptrdiff_t begin) const {
  return {data_ + (begin - columns_.begin) * padded_rows_, shape_};
}

double PackedRows::SquaredNorm(const DenseOps& ops) const {
  double norm = 0;
  for (ptrdiff_t begin = columns_.begin; begin < columns_.end; begin += kDenseDepth) {
    norm +=
        ops.squared_norm(chunk(begin), rows_, {begin, std::min(begin + kDenseDepth, columns_.end)});
  }
  return norm;
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
  return n == 0 || FactorBlock(k.data(), w.data(), n, n, 0);
}

// Recursion on [K11 .; K21 K22]: with W11 = L11^-1 everything else is products.
// L21 = K21 W11^T, K22 -= L21 L21^T, W21 = -W22 L21 W11.
bool DenseSolver::FactorBlock(double* k, double* w, ptrdiff_t n, ptrdiff_t ld, size_t level) {
  if (n <= kDenseLeaf) return ops_.factor_leaf(k, w, n, ld);
  const ptrdiff_t half = std::max(n / 2 / kDenseLeaf, ptrdiff_t{1}) * kDenseLeaf;
  const ptrdiff_t rest = n - half;
  if (!FactorBlock(k, w, half, ld, level + 1)) return false;

  double* const k21 = k + half;
  double* const w21 = w + half;
  double* const k22 = k21 + half * ld;
  double* const w22 = w21 + half * ld;
  const DenseView w11 = LowerView(w, ld);
  first_.Pack(ops_, {k21, 1, ld}, rest, half);
  second_.Pack(ops_, w11, half, half);
  Multiply(first_, second_, {.c = k21, .ldc = ld, .overwrite = true});
  first_.Pack(ops_, {k21, 1, ld}, rest, half);
  Multiply(first_, first_, {.alpha = -1, .c = k22, .ldc = ld, .part = DensePart::kLower});
  second_.Pack(ops_, w11.Transposed(), half, half);
  if (levels_.size() <= level) levels_.resize(level + 1);
  DenseProduct transposed;  // (L21 W11)^T
  levels_[level].Receive(ops_, DenseShape::kFull, half, rest, &transposed);
  Multiply(second_, first_, transposed);
  if (!FactorBlock(k22, w22, rest, ld, level + 1)) return false;

  first_.Pack(ops_, LowerView(w22, ld), rest, rest);
  Multiply(first_, levels_[level], {.alpha = -1, .c = w21, .ldc = ld, .overwrite = true});
  return true;
}

void DenseSolver::MultiplyByFactor(const Eigen::MatrixXd& w, bool transposed,
                                   const Eigen::MatrixXd& f, Eigen::MatrixXd& h) {
  const ptrdiff_t n = w.rows(), r = f.cols();
  h.resize(n, r);
  const DenseView factor = ViewOf(w, DenseShape::kLower);
  MultiplyRows(transposed ? factor.Transposed() : factor, ViewOf(f).Transposed(), n,
               {.c = h.data(), .ldc = n, .m = n, .n = r, .overwrite = true});
}

void DenseSolver::OuterProduct(const Eigen::MatrixXd& b, Eigen::MatrixXd& s) {
  const ptrdiff_t n = b.rows();
  s.setZero(n, n);
  MultiplyRows(ViewOf(b), ViewOf(b), b.cols(),
               {.c = s.data(), .ldc = n, .m = n, .n = n, .part = DensePart::kLower});
}

void DenseSolver::SymmetricMultiply(const Eigen::MatrixXd& m, const Eigen::MatrixXd& x,
                                    Eigen::MatrixXd& y) {
  const ptrdiff_t n = m.rows(), q = x.cols();
  y.resize(n, q);
  MultiplyRows(ViewOf(m, DenseShape::kSymmetric), ViewOf(x).Transposed(), n,
               {.c = y.data(), .ldc = n, .m = n, .n = q, .overwrite = true});
}

double DenseSolver::Whiten(const Eigen::MatrixXd& w, const Eigen::MatrixXd& f, bool f_lower) {
  const ptrdiff_t n = w.rows(), r = f.cols();
  whitened_square_ = f_lower;
  first_.Pack(ops_, ViewOf(w, DenseShape::kLower), n, n);
  DenseProduct product;
  if (f_lower) {
    second_.Pack(ops_, ViewOf(f, DenseShape::kLower).Transposed(), r, n);
    whitened_.Receive(ops_, DenseShape::kLower, n, r, &product);
    Multiply(first_, second_, product);
  } else {
    second_.Pack(ops_, ViewOf(f).Transposed(), r, n);
    whitened_.Receive(ops_, DenseShape::kFull, r, n, &product);
    Multiply(second_, first_, product);
  }
  return whitened_.SquaredNorm(ops_);
}

void DenseSolver::Gradient(const Eigen::MatrixXd& w, double num_outputs, Eigen::MatrixXd& solution,
                           Eigen::MatrixXd& a) {
  const ptrdiff_t n = w.rows();
  a.resize(n, n);
  first_.Pack(ops_, ViewOf(w, DenseShape::kLower).Transposed(), n, n);
  if (whitened_square_) {
    GradientOfSquare(num_outputs, a);
  } else {
    GradientOfNarrow(num_outputs, solution, a);
  }
}

// W^T T with T = (D I - H H^T) W, of which the product sees the lower triangle only; first_: W^T.
void DenseSolver::GradientOfSquare(double num_outputs, Eigen::MatrixXd& a) {
  const ptrdiff_t n = a.rows();
  Multiply(whitened_, whitened_,
           {.alpha = -1, .c = a.data(), .ldc = n, .part = DensePart::kLower, .overwrite = true});
  a.diagonal().array() += num_outputs;
  second_.Pack(ops_, ViewOf(a, DenseShape::kSymmetric), n, n);
  DenseProduct transposed;  // T^T, in the place of H
  whitened_.Receive(ops_, DenseShape::kUpper, n, n, &transposed);
  Multiply(first_, second_, transposed);
  Multiply(first_, whitened_,
           {.c = a.data(), .ldc = n, .part = DensePart::kLower, .overwrite = true});
}

// D W^T W - S S^T with S = W^T H; first_: W^T.
void DenseSolver::GradientOfNarrow(double num_outputs, Eigen::MatrixXd& solution,
                                   Eigen::MatrixXd& a) {
  const ptrdiff_t n = a.rows(), r = whitened_.rows();
  solution.resize(n, r);
  Multiply(first_, whitened_, {.c = solution.data(), .ldc = n, .overwrite = true});
  Multiply(first_, first_,
           {.alpha = num_outputs,
            .c = a.data(),
            .ldc = n,
            .part = DensePart::kLower,
            .overwrite = true});
  second_.Pack(ops_, ViewOf(solution), n, r);
  Multiply(second_, second_, {.alpha = -1, .c = a.data(), .ldc = n, .part = DensePart::kLower});
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
