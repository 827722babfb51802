// The dense kernels for processors with AVX2 and FMA; compiled with -mavx2 -mfma.
#include "pleat/simd/dense_ops.h"

#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>

namespace pleat {
namespace dense_avx2 {
constexpr ptrdiff_t kWidth = 4, kPanelRegisters = 3, kPanelColumns = 4;
typedef double Register __attribute__((vector_size(32)));
typedef double UnalignedRegister __attribute__((vector_size(32), aligned(8), may_alias));
inline Register Broadcast(double value) { return _mm256_set1_pd(value); }
inline Register FusedMultiplyAdd(Register a, Register b, Register c) {
  return _mm256_fmadd_pd(a, b, c);
}
}  // namespace dense_avx2
}  // namespace pleat

#define PLEAT_DENSE_NAMESPACE dense_avx2
#include "dense_body.inc"

namespace pleat {
const DenseOps* Avx2DenseOps() { return &dense_avx2::kOps; }
}  // namespace pleat
#else
namespace pleat {
const DenseOps* Avx2DenseOps() { return nullptr; }
}  // namespace pleat
#endif
