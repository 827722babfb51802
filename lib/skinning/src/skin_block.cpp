// The same body is compiled for each instruction set. Each sum has one order, over the
// influences of a vertex, whatever the width of the registers; so all kernels give the same bits,
// and a prediction does not depend on the machine.
#include "skin_block.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace pleat {
namespace {

constexpr int kLanes = kSkinningLanes, kParameters = kMotionParameters;

typedef float Four __attribute__((vector_size(16)));
typedef float Sixteen __attribute__((vector_size(64)));
typedef float UnalignedSixteen __attribute__((vector_size(64), aligned(4), may_alias));

// The fourth row of a bone's columns, its quaternion.
constexpr bool IsQuaternion(int parameter) { return parameter % 4 == 3; }
alignas(64) constexpr float kOnQuaternion[kParameters] = {0, 0, 0, 1, 0, 0, 0, 1,
                                                          0, 0, 0, 1, 0, 0, 0, 1};

// lanes[parameter][lane] = blended[lane][parameter], four by four.
PLEAT_ALWAYS_INLINE void Transpose(const float (&blended)[kLanes][kParameters],
                                   float (&lanes)[kParameters][kLanes]) {
  for (int lane = 0; lane < kLanes; lane += 4) {
    for (int parameter = 0; parameter < kParameters; parameter += 4) {
      const auto row = [&](int i) {
        return *reinterpret_cast<const Four*>(&blended[lane + i][parameter]);
      };
      const Four a = row(0), b = row(1), c = row(2), d = row(3);
      const Four ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5);
      const Four ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
      const Four cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5);
      const Four cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
      const auto column = [&](int i) -> Four& {
        return *reinterpret_cast<Four*>(&lanes[parameter + i][lane]);
      };
      column(0) = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
      column(1) = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
      column(2) = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
      column(3) = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
    }
  }
}

// m[parameter] = sum_k w_k (parameter of bone k), vertex by vertex.
template <int kInfluences>
PLEAT_ALWAYS_INLINE void BlendVertices(const SkinBlockInputs& inputs, Sixteen* m) {
  alignas(64) float blended[kLanes][kParameters];
  alignas(64) float lanes[kParameters][kLanes];
  const FrameSkinning::Block& block = *inputs.block;
  const Sixteen on_quaternion = *reinterpret_cast<const Sixteen*>(kOnQuaternion);
  for (int lane = 0; lane < kLanes; ++lane) {
    Sixteen sum;
    for (int k = 0; k < kInfluences; ++k) {
      const float weight = block.weights[k * kLanes + lane];
      // The other sign is exact: w - 2 w = -w.
      const float change = inputs.quaternion_weights[k * kLanes + lane] - weight;
      const Sixteen motion = *reinterpret_cast<const UnalignedSixteen*>(
          inputs.columns + kParameters * block.bones[k * kLanes + lane]);
      const Sixteen part = (weight + change * on_quaternion) * motion;
      sum = k == 0 ? part : sum + part;
    }
    *reinterpret_cast<Sixteen*>(blended[lane]) = sum;
  }
  Transpose(blended, lanes);
  for (int p = 0; p < kParameters; ++p) m[p] = *reinterpret_cast<const Sixteen*>(lanes[p]);
}

// position[axis] += R(q) detail, q the normalized fourth row of `m`.
PLEAT_ALWAYS_INLINE void AddDetails(const Sixteen* m, const float* details, Sixteen* position) {
  const Sixteen squared = (m[3] * m[3] + m[7] * m[7]) + (m[11] * m[11] + m[15] * m[15]);
  // R(q) d = d + 2 / |q|^2 (w u + q x u), u = q x d: no root is needed.
  const Sixteen scale = 2.0f / squared;
  Sixteen detail[3];
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    detail[axis] = *reinterpret_cast<const UnalignedSixteen*>(details + axis * kLanes);
  }
  Sixteen u[3];
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    u[axis] = m[4 * next + 3] * detail[last] - m[4 * last + 3] * detail[next];
  }
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    const Sixteen turned =
        m[15] * u[axis] + (m[4 * next + 3] * u[last] - m[4 * last + 3] * u[next]);
    position[axis] += detail[axis] + scale * turned;
  }
}

// position = [m] rest.
PLEAT_ALWAYS_INLINE void Move(const Sixteen* m, const SkinBlockInputs& inputs, Sixteen* position) {
  const auto* x = reinterpret_cast<const Sixteen*>(inputs.block->rest);
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    position[axis] = (m[axis] * x[0] + m[4 + axis] * x[1]) + (m[8 + axis] * x[2] + m[12 + axis]);
  }
}

struct SkinBlockBody {
  static PLEAT_ALWAYS_INLINE void Run(const SkinBlockInputs& inputs, float* positions) {
    Sixteen m[kParameters], position[3];
    if (inputs.block->num_influences == kStandardInfluences) {
      BlendVertices<kStandardInfluences>(inputs, m);
    } else {
      BlendVertices<kMaxInfluences>(inputs, m);
    }
    Move(m, inputs, position);
    if (inputs.details != nullptr) AddDetails(m, inputs.details, position);
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int axis = 0; axis < 3; ++axis) positions[3 * lane + axis] = position[axis][lane];
    }
  }
};

#if defined(__x86_64__)
// The same sums with all vertices side by side: the bones' numbers lie in registers.
template <int kInfluences>
PLEAT_TARGET_AVX512 PLEAT_ALWAYS_INLINE void BlendByLookup(const SkinBlockInputs& inputs,
                                                           bool with_axes, Sixteen* m) {
  const FrameSkinning::Block& block = *inputs.block;
  __m512i bones[kInfluences];
#pragma GCC unroll 8
  for (int k = 0; k < kInfluences; ++k) {
    // The plain conversion reads an undefined register, of which gcc 12 warns.
    bones[k] = _mm512_maskz_cvtepu16_epi32(
        0xffff, _mm256_load_si256(reinterpret_cast<const __m256i*>(block.bones + k * kLanes)));
  }
#pragma GCC unroll 16
  for (int p = 0; p < kParameters; ++p) {
    if (IsQuaternion(p) && !with_axes) continue;
    const float* weights = IsQuaternion(p) ? inputs.quaternion_weights : block.weights;
    const __m512 low = _mm512_loadu_ps(inputs.tables + p * kLookupBones);
    const __m512 high = _mm512_loadu_ps(inputs.tables + p * kLookupBones + kLanes);
#pragma GCC unroll 8
    for (int k = 0; k < kInfluences; ++k) {
      const Sixteen weight = *reinterpret_cast<const UnalignedSixteen*>(weights + k * kLanes);
      const Sixteen part = weight * _mm512_permutex2var_ps(low, bones[k], high);
      m[p] = k == 0 ? part : m[p] + part;
    }
  }
}

// Where each number of xyz of 16 vertices comes from: x and y first, then z into their gaps.
struct Interleaving {
  int from_xy[3 * kLanes], from_z[3 * kLanes];
};
constexpr Interleaving kInterleaving = [] {
  Interleaving from{};
  for (int i = 0; i < 3 * kLanes; ++i) {
    const int lane = i / 3, axis = i % 3;
    from.from_xy[i] = axis == 1 ? kLanes + lane : lane;
    from.from_z[i] = axis == 2 ? kLanes + lane : i % kLanes;
  }
  return from;
}();

PLEAT_TARGET_AVX512 PLEAT_ALWAYS_INLINE void StoreByVertex(const Sixteen* position,
                                                           float* positions) {
#pragma GCC unroll 3
  for (int part = 0; part < 3; ++part) {
    const __m512i from_xy = _mm512_loadu_si512(kInterleaving.from_xy + part * kLanes);
    const __m512i from_z = _mm512_loadu_si512(kInterleaving.from_z + part * kLanes);
    const __m512 xy = _mm512_permutex2var_ps(position[0], from_xy, position[1]);
    _mm512_storeu_ps(positions + part * kLanes, _mm512_permutex2var_ps(xy, from_z, position[2]));
  }
}

PLEAT_TARGET_AVX512 void SkinBlockForAvx512(const SkinBlockInputs& inputs, float* positions) {
  if (inputs.tables == nullptr) {
    SkinBlockBody::Run(inputs, positions);
    return;
  }
  Sixteen m[kParameters], position[3];
  const bool with_axes = inputs.details != nullptr;
  if (inputs.block->num_influences == kStandardInfluences) {
    BlendByLookup<kStandardInfluences>(inputs, with_axes, m);
  } else {
    BlendByLookup<kMaxInfluences>(inputs, with_axes, m);
  }
  Move(m, inputs, position);
  if (with_axes) AddDetails(m, inputs.details, position);
  StoreByVertex(position, positions);
}
#endif

}  // namespace

const KernelVariants<SkinBlockFunction>& SkinBlockVariants() {
  using enum InstructionSet;
  static const auto variants = RunnableVariants<SkinBlockFunction>({
#if defined(__x86_64__)
    {kAvx512, SkinBlockForAvx512},
#endif
        {kAvx2, CompileFor<SkinBlockBody, kAvx2>()},
        {kBaseline, CompileFor<SkinBlockBody, kBaseline>()},
  });
  return variants;
}

}  // namespace pleat
