// The table of dense kernels that are compiled once per instruction set.
#pragma once

#include <stddef.h>

namespace pleat {

// A matrix that is read with any strides, so that a transpose costs nothing.
struct DenseView {
  const double* data;
  ptrdiff_t row_stride, col_stride;

  DenseView Transposed() const { return {data, col_stride, row_stride}; }
  DenseView Block(ptrdiff_t row, ptrdiff_t col) const {
    return {data + row * row_stride + col * col_stride, row_stride, col_stride};
  }
};

// Lower-triangular sums of the Gram gradient; off-diagonal entries count twice.
struct GramSums {
  double trace = 0;      // sum_i A_ii
  double total = 0;      // sum_ij A_ij
  double amplitude = 0;  // sum_ij P_ij
  double distance = 0;   // sum_ij P_ij R_ij
  double linear = 0;     // sum_ij A_ij T_ij
};

// All matrices are column-major with leading dimension `n` unless a stride is given; "lower" means
// that entries above the diagonal are neither read nor defined.
struct DenseOps {
  const char* name;
  ptrdiff_t pack_size;  // doubles of scratch that `multiply_add` needs

  // C (m x n, leading dimension ldc) += alpha A (m x k) B (k x n). With `lower` only the entries
  // on and below the diagonal of C are needed. Each entry is a sum in the order of k, in chunks
  // of fixed length: the same bits whatever the width of the registers.
  void (*multiply_add)(double alpha, DenseView a, DenseView b, double* c, ptrdiff_t ldc,
                       ptrdiff_t m, ptrdiff_t n, ptrdiff_t k, bool lower, double* scratch);

  // values[i] = exp(values[i]) for count values <= 0 (relative error below 1e-15).
  void (*exp_in_place)(double* values, ptrdiff_t count);

  // R (lower) = squared distances of the rows of X (n x q).
  void (*squared_distances)(const double* x, ptrdiff_t n, ptrdiff_t q, double* r);

  // K0 (lower) = a exp(-g/2 R), K (lower) = K0 + bias + c T; T may be null. No diagonal noise.
  void (*kernel)(const double* r, const double* t, ptrdiff_t n, double g, double a, double bias,
                 double c, double* k0, double* k);

  // With A = half_weight (num_outputs Q - S), all lower: replaces Q by A and S by P = A o K0.
  GramSums (*gram_gradient)(double* q, double* s, const double* k0, const double* r,
                            const double* t, ptrdiff_t n, double half_weight, double num_outputs);

  // Y (n x q) = M X with M symmetric, of which the lower triangle is given.
  void (*symmetric_multiply)(const double* m, const double* x, ptrdiff_t n, ptrdiff_t q, double* y);
};

const DenseOps* BaselineDenseOps();
// Null when the build has no such kernels.
const DenseOps* Avx2DenseOps();
const DenseOps* Avx512DenseOps();

}  // namespace pleat
