// The same code is compiled for three instruction sets: everything is inlined into SkinBlockFor...
#include "skin_block.h"

#include <cmath>
#include <vector>

#define PLEAT_INLINE inline __attribute__((always_inline))

namespace pleat {
namespace {

constexpr int kLanes = 16, kParameters = 16;

typedef float Four __attribute__((vector_size(16)));
typedef float Sixteen __attribute__((vector_size(64)));
typedef float UnalignedFour __attribute__((vector_size(16), aligned(4), may_alias));
typedef float UnalignedSixteen __attribute__((vector_size(64), aligned(4), may_alias));
typedef int FourIndices __attribute__((vector_size(16)));

// Multiplies the fourth row, the quaternion, by the sign.
alignas(64) constexpr float kSigns[2][16] = {{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
                                             {1, 1, 1, -1, 1, 1, 1, -1, 1, 1, 1, -1, 1, 1, 1, -1}};

PLEAT_INLINE float QuaternionDot(const float* a, const float* b) {
  return (a[3] * b[3] + a[7] * b[7]) + (a[11] * b[11] + a[15] * b[15]);
}

// sum_b w_b columns_b of one vertex.
PLEAT_INLINE void Blend(const VertexInfluences& influences, const float* columns, bool with_axes,
                        float* blended) {
  const float* strongest = columns + kParameters * influences.bones[0];
  Sixteen sum = influences.weights[0] * *reinterpret_cast<const UnalignedSixteen*>(strongest);
  for (int k = 1; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
    const float* bone = columns + kParameters * influences.bones[k];
    const Sixteen motion = *reinterpret_cast<const UnalignedSixteen*>(bone);
    if (with_axes) {
      const Sixteen& signs =
          *reinterpret_cast<const Sixteen*>(kSigns[QuaternionDot(strongest, bone) < 0 ? 1 : 0]);
      sum += (influences.weights[k] * signs) * motion;
    } else {
      sum += influences.weights[k] * motion;
    }
  }
  *reinterpret_cast<Sixteen*>(blended) = sum;
}

// lanes[parameter][lane] = blended[lane][parameter], four by four.
PLEAT_INLINE void Transpose(const float (&blended)[kLanes][kParameters],
                            float (&lanes)[kParameters][kLanes]) {
  for (int lane = 0; lane < kLanes; lane += 4) {
    for (int parameter = 0; parameter < kParameters; parameter += 4) {
      const auto row = [&](int i) {
        return *reinterpret_cast<const Four*>(&blended[lane + i][parameter]);
      };
      const Four a = row(0), b = row(1), c = row(2), d = row(3);
      const Four ab_low = __builtin_shuffle(a, b, FourIndices{0, 4, 1, 5});
      const Four ab_high = __builtin_shuffle(a, b, FourIndices{2, 6, 3, 7});
      const Four cd_low = __builtin_shuffle(c, d, FourIndices{0, 4, 1, 5});
      const Four cd_high = __builtin_shuffle(c, d, FourIndices{2, 6, 3, 7});
      const auto column = [&](int i) -> Four& {
        return *reinterpret_cast<Four*>(&lanes[parameter + i][lane]);
      };
      column(0) = __builtin_shuffle(ab_low, cd_low, FourIndices{0, 1, 4, 5});
      column(1) = __builtin_shuffle(ab_low, cd_low, FourIndices{2, 3, 6, 7});
      column(2) = __builtin_shuffle(ab_high, cd_high, FourIndices{0, 1, 4, 5});
      column(3) = __builtin_shuffle(ab_high, cd_high, FourIndices{2, 3, 6, 7});
    }
  }
}

// position[axis] += R(q) detail, q the normalised fourth row of `m`.
PLEAT_INLINE void AddDetails(const Sixteen* m, const float* details, Sixteen* position) {
  const Sixteen squared = (m[3] * m[3] + m[7] * m[7]) + (m[11] * m[11] + m[15] * m[15]);
  // R(q) d = d + 2 / |q|^2 (w u + q x u), u = q x d: no root is needed.
  const Sixteen scale = 2.0f / squared;
  Sixteen detail[3];
  for (int axis = 0; axis < 3; ++axis) {
    detail[axis] = *reinterpret_cast<const UnalignedSixteen*>(details + axis * kLanes);
  }
  Sixteen u[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    u[axis] = m[4 * next + 3] * detail[last] - m[4 * last + 3] * detail[next];
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    const Sixteen turned =
        m[15] * u[axis] + (m[4 * next + 3] * u[last] - m[4 * last + 3] * u[next]);
    position[axis] += detail[axis] + scale * turned;
  }
}

PLEAT_INLINE void SkinBlock(const VertexInfluences* influences, const double* rest, int count,
                            const float* columns, const float* details, float* positions) {
  alignas(64) float blended[kLanes][kParameters];
  alignas(64) float lanes[kParameters][kLanes];
  alignas(64) float points[3][kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const int v = lane < count ? lane : count - 1;
    Blend(influences[v], columns, details != nullptr, blended[lane]);
    for (int axis = 0; axis < 3; ++axis) {
      points[axis][lane] = static_cast<float>(rest[3 * v + axis]);
    }
  }
  Transpose(blended, lanes);
  const auto* m = reinterpret_cast<const Sixteen*>(&lanes[0][0]);
  const auto* x = reinterpret_cast<const Sixteen*>(&points[0][0]);
  Sixteen position[3];
  for (int axis = 0; axis < 3; ++axis) {
    position[axis] = (m[axis] * x[0] + m[4 + axis] * x[1]) + (m[8 + axis] * x[2] + m[12 + axis]);
  }
  if (details != nullptr) AddDetails(m, details, position);
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int axis = 0; axis < 3; ++axis) positions[3 * lane + axis] = position[axis][lane];
  }
}

void SkinBlockForAny(const VertexInfluences* influences, const double* rest, int count,
                     const float* columns, const float* details, float* positions) {
  SkinBlock(influences, rest, count, columns, details, positions);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void SkinBlockForAvx2(const VertexInfluences* influences,
                                                      const double* rest, int count,
                                                      const float* columns, const float* details,
                                                      float* positions) {
  SkinBlock(influences, rest, count, columns, details, positions);
}
__attribute__((target("avx512f,prefer-vector-width=512"))) void SkinBlockForAvx512(
    const VertexInfluences* influences, const double* rest, int count, const float* columns,
    const float* details, float* positions) {
  SkinBlock(influences, rest, count, columns, details, positions);
}
#endif

std::vector<SkinBlockFunction> FindUsable() {
  std::vector<SkinBlockFunction> usable;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) usable.push_back(SkinBlockForAvx512);
  if (__builtin_cpu_supports("avx2")) usable.push_back(SkinBlockForAvx2);
#endif
  usable.push_back(SkinBlockForAny);
  return usable;
}

}  // namespace

std::span<const SkinBlockFunction> UsableSkinBlocks() {
  static const std::vector<SkinBlockFunction> usable = FindUsable();
  return usable;
}

SkinBlockFunction ChosenSkinBlock() { return UsableSkinBlocks().front(); }

}  // namespace pleat
