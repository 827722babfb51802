// Skins one block of 16 vertices, on the widest registers of this processor.
#pragma once

#include "pleat/simd/dispatch.h"
#include "pleat/skinning/frame_skinning.h"

namespace pleat {

inline constexpr int kMotionParameters = 16;  // numbers of a bone

// The processor can look up numbers of up to this many bones in registers.
inline constexpr int kLookupBones = 32;

// The inputs of a kernel. columns: 16 numbers of each bone. tables: kMotionParameters x
// kLookupBones, the parameters of all bones; null where there are more bones. quaternion_weights:
// those of `block` with signs (8 x 16). details: 48 values, x of all vertices, then y, then z; or
// null. The output has 48 values, x, y, z of each vertex. All kernels give the same bits.
struct SkinBlockInputs {
  const FrameSkinning::Block* block = nullptr;
  const float* columns = nullptr;
  const float* tables = nullptr;
  const float* quaternion_weights = nullptr;
  const float* details = nullptr;
};

// Returns the kernels that this processor can run, the fastest first.
const KernelVariants<SkinBlockFunction>& SkinBlockVariants();

}  // namespace pleat
