// The dense kernels for processors with AVX-512; compiled with -mavx512f -mfma.
#include "pleat/simd/dense_ops.h"

#if defined(__AVX512F__)
#include <immintrin.h>

namespace pleat {
namespace dense_avx512 {
constexpr ptrdiff_t kWidth = 8, kPanelRegisters = 3, kPanelColumns = 8;
typedef double Register __attribute__((vector_size(64)));
typedef double UnalignedRegister __attribute__((vector_size(64), aligned(8), may_alias));
inline Register Broadcast(double value) { return _mm512_set1_pd(value); }
inline Register FusedMultiplyAdd(Register a, Register b, Register c) {
  return _mm512_fmadd_pd(a, b, c);
}
}  // namespace dense_avx512
}  // namespace pleat

#define PLEAT_DENSE_NAMESPACE dense_avx512
#include "dense_body.inc"

namespace pleat {
const DenseOps* Avx512DenseOps() { return &dense_avx512::kOps; }
}  // namespace pleat
#else
namespace pleat {
const DenseOps* Avx512DenseOps() { return nullptr; }
}  // namespace pleat
#endif
