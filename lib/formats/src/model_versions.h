// What the versions of the model file differ in (docs/formats/model_file.md, "Versions").
#pragma once

#include <cstdint>

namespace pleat {

inline constexpr uint32_t kModelFileVersion = 5;
// Before it there is one scale for all inputs, in front of the matrices.
inline constexpr uint32_t kFirstWithInputScales = 3;
// Before it there is one basis for all regions and all vertices.
inline constexpr uint32_t kFirstWithParts = 4;
inline constexpr uint32_t kFirstWithSkinFeatures = 4;
// Before it the weights of the fold and of the skin's features are floats.
inline constexpr uint32_t kFirstWithPlanes = 5;
// Before it every vertex has four influences, no option says how many, and there are no fit
// weights.
inline constexpr uint32_t kFirstWithInfluences = 5;

}  // namespace pleat
