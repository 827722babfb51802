// One block of 16 vertices, on the widest registers of this processor.
#pragma once

#include "pleat/simd/dispatch.h"
#include "pleat/skinning/frame_skinning.h"

namespace pleat {

inline constexpr int kMotionParameters = 16;  // of a bone

// Up to so many bones the processor can look up in registers.
inline constexpr int kLookupBones = 32;

// columns: 16 numbers of each bone. tables: kMotionParameters x kLookupBones, the parameters of all
// bones; null where there are more bones. quaternion_weights: those of `block` with signs (4 x 16).
// details: 48 values, x of all, y, z; or null. positions: 48 values, xyz of each vertex. All
// kernels give the same bits.
struct SkinBlockInputs {
  const FrameSkinning::Block* block = nullptr;
  const float* columns = nullptr;
  const float* tables = nullptr;
  const float* quaternion_weights = nullptr;
  const float* details = nullptr;
};

// Those this processor can run, the fastest first.
const KernelVariants<SkinBlockFunction>& SkinBlockVariants();

}  // namespace pleat
