// One block of 16 vertices, on the widest registers of this processor.
#pragma once

#include <span>

#include "pleat/skinning/skin_weights.h"

namespace pleat {

// influences, rest (xyz of each, metres): of `count` <= 16 vertices. columns: as in BoneMotions.
// details: 48 values, x of all, y, z; or null. positions: 48 values, xyz of each vertex; beyond
// `count` undefined. All kernels give the same bits.
using SkinBlockFunction = void (*)(const VertexInfluences* influences, const double* rest,
                                   int count, const float* columns, const float* details,
                                   float* positions);

// Those this processor can run, the fastest first.
std::span<const SkinBlockFunction> UsableSkinBlocks();
SkinBlockFunction ChosenSkinBlock();

}  // namespace pleat
