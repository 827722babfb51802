// The positions that the sum of a mesh and a morph target rounds, beside it in files that Pleat
// wrote (docs/formats/glb.md).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "glb_container.h"
#include "glb_mesh.h"

namespace pleat {

struct GlbRemainders {
  std::vector<size_t> begins;    // of each target in the two lists, and the end of the last
  std::vector<int64_t> indices;  // 3 * vertex + axis
  std::vector<float> values;
};

// Those of the mesh of a part. None when the file has none, or when they do not fit the part: then
// the sums are as good as for any other file.
std::optional<GlbRemainders> ReadGlbRemainders(const GlbContainer& glb, const GlbPart& part);

// Sets the exact positions where one target has the weight 1 and the others 0. A value that is
// further off than rounding is left: another program changed the mesh. base: the positions of the
// part, of which `frame` is the shape.
void ApplyGlbRemainders(const GlbRemainders& remainders, const std::vector<float>& weights,
                        const Eigen::Matrix3Xd& base, Eigen::Matrix3Xf* frame);

}  // namespace pleat
