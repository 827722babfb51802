// Skinning of whole frames in float32, details included, 16 vertices at a time: what a query runs.
// rig.h has the same in double precision, vertex by vertex, for training.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/skeleton/pose.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// What moves the vertices of one frame: for each bone b 16 floats, four columns of four. The first
// three rows are [linear_b | translation_b], the fourth holds the unit quaternion (x, y, z, w) of
// the axes in which the bone's details are written.
struct BoneMotions {
  std::vector<float> columns;  // 16 J

  // axes: J rotations. No allocation once `columns` has the right size.
  void Set(const BoneTransforms& transforms, const std::vector<Eigen::Matrix3d>& axes);
};

inline constexpr int kSkinningLanes = 16;  // vertices of a block

// Vertices of the blocks first_block to first_block + num_blocks - 1 (block i: vertices 16 i to
// 16 i + 15, fewer in the last):
//   position_v = sum_b w_vb (linear_b rest_v + translation_b) + R(q_v) detail_v
// with q_v the normalised mean of the quaternions of its bones, signs aligned with the strongest.
// details: for each block x of its 16 vertices, y, z; or null for none. positions: 3 x V.
void SkinBlocks(const Rig& rig, const BoneMotions& motions, int first_block, int num_blocks,
                const float* details, Eigen::Matrix3Xf* positions);

}  // namespace pleat
