// The dense kernels for any processor.
#include "pleat/simd/dense_ops.h"

namespace pleat {
namespace dense_baseline {
constexpr ptrdiff_t kWidth = 2, kPanelRegisters = 2, kPanelColumns = 4;
typedef double Register __attribute__((vector_size(16)));
typedef double UnalignedRegister __attribute__((vector_size(16), aligned(8), may_alias));
inline Register Broadcast(double value) { return Register{value, value}; }
inline Register FusedMultiplyAdd(Register a, Register b, Register c) { return a * b + c; }
}  // namespace dense_baseline
}  // namespace pleat

#define PLEAT_DENSE_NAMESPACE dense_baseline
#include "dense_body.inc"

namespace pleat {
const DenseOps* BaselineDenseOps() { return &dense_baseline::kOps; }
}  // namespace pleat
