// The table of dense kernels that are compiled once per instruction set.
#pragma once

#include <stddef.h>

namespace pleat {

// What is known of a matrix. Entries that follow from the rest are not used.
enum class DenseShape {
  kFull,
  kLower,      // zero above the diagonal
  kUpper,      // zero below the diagonal
  kSymmetric,  // given by its lower triangle
};

// A matrix that is read with any strides, so that a transpose costs nothing.
struct DenseView {
  const double* data = nullptr;
  ptrdiff_t row_stride = 1, col_stride = 0;
  DenseShape shape = DenseShape::kFull;

  DenseView Transposed() const {
    if (shape == DenseShape::kSymmetric) return *this;
    return {data, col_stride, row_stride,
            shape == DenseShape::kLower   ? DenseShape::kUpper
            : shape == DenseShape::kUpper ? DenseShape::kLower
                                          : DenseShape::kFull};
  }
};

// Which entries of a product are needed; what else is written is not defined.
enum class DensePart {
  kAll,
  kLower,  // on and below the diagonal
  kUpper,  // on and above the diagonal
};

// C (m x n, leading dimension ldc) = or += alpha A B^T for packed A (m x k) and B (n x k).
struct DenseProduct {
  double alpha = 1;
  double* c = nullptr;
  ptrdiff_t ldc = 0, m = 0, n = 0;
  DensePart part = DensePart::kAll;
  bool overwrite = false;  // C is not read
  bool packed = false;     // C becomes packed rows; ldc: their number as padded
};

// Columns of a matrix. Products sum over one chunk after the other.
struct DenseChunk {
  ptrdiff_t begin = 0, end = 0;
};

// The rows of a matrix in the order in which a product reads one chunk of its columns.
struct PackedChunk {
  const double* data = nullptr;
  DenseShape shape = DenseShape::kFull;
};

// Lower-triangular sums of the Gram gradient; off-diagonal entries count twice.
struct GramSums {
  double trace = 0;      // sum_i A_ii
  double total = 0;      // sum_ij A_ij
  double amplitude = 0;  // sum_ij P_ij
  double distance = 0;   // sum_ij P_ij R_ij
  double linear = 0;     // sum_ij A_ij T_ij
};

constexpr ptrdiff_t kDenseLeaf = 24;
constexpr ptrdiff_t kDenseDepth = 256;  // columns in a chunk; part of the result, do not tune
constexpr ptrdiff_t kDenseAlignment = 64;

// All matrices are column-major with leading dimension `n` unless a stride is given; "lower" means
// that entries above the diagonal are neither read nor defined.
struct DenseOps {
  ptrdiff_t panel_rows;  // a packed chunk has a multiple of this many rows

  // Packs one chunk of `rows` rows of `a`; `packed` is aligned to kDenseAlignment bytes.
  void (*pack)(const DenseView& a, ptrdiff_t rows, DenseChunk chunk, double* packed);

  // Adds the part of the product that one chunk gives (chunk.begin = 0 comes first). Each entry is
  // a sum in the order of k, chunk after chunk: the same bits whatever the width of the registers.
  void (*multiply)(const DenseProduct& product, DenseChunk chunk, const PackedChunk& a,
                   const PackedChunk& b);

  // Sum of the squares of one packed chunk that has its shape's zeros.
  double (*squared_norm)(const PackedChunk& a, ptrdiff_t rows, DenseChunk chunk);

  // Cholesky K = L L^T of the lower triangle of K (n x n, n <= kDenseLeaf, leading dimension ld) in
  // place, and W = L^-1 with zeros above the diagonal. False when K is not positive definite.
  bool (*factor_leaf)(double* k, double* w, ptrdiff_t n, ptrdiff_t ld);

  // values[i] = exp(values[i]) for count values <= 0 (relative error below 1e-15).
  void (*exp_in_place)(double* values, ptrdiff_t count);

  // R (lower) = squared distances of the rows of X (n x q).
  void (*squared_distances)(const double* x, ptrdiff_t n, ptrdiff_t q, double* r);

  // K (lower) = K0 + bias + c T with K0 = a exp(-g/2 R); T may be null. No diagonal noise.
  void (*kernel)(const double* r, const double* t, ptrdiff_t n, double g, double a, double bias,
                 double c, double* k);

  // `gradient` (lower) is replaced by A = half_weight gradient; P (lower) = A o K0 and may take its
  // place. K0 is computed again, which costs no more than to store and read it.
  GramSums (*gram_gradient)(double* gradient, const double* r, const double* t, ptrdiff_t n,
                            double g, double a, double half_weight, double* p);
};

const DenseOps* BaselineDenseOps();
// Null when the build has no such kernels.
const DenseOps* Avx2DenseOps();
const DenseOps* Avx512DenseOps();

}  // namespace pleat
