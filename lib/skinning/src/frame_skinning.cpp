#include "pleat/skinning/frame_skinning.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>

#include "skin_block.h"

namespace pleat {

void BoneMotions::Set(const BoneTransforms& transforms, const std::vector<Eigen::Matrix3d>& axes) {
  assert(axes.size() == transforms.linear.size());
  columns.resize(16 * transforms.linear.size());
  for (size_t b = 0; b < transforms.linear.size(); ++b) {
    Eigen::Map<Eigen::Matrix4f> motion(columns.data() + 16 * b);
    motion.topLeftCorner<3, 3>() = transforms.linear[b].cast<float>();
    motion.topRightCorner<3, 1>() = transforms.translation[b].cast<float>();
    motion.row(3) = Eigen::Quaterniond(axes[b]).coeffs().transpose().cast<float>();
  }
}

void SkinBlocks(const Rig& rig, const BoneMotions& motions, int first_block, int num_blocks,
                const float* details, Eigen::Matrix3Xf* positions) {
  constexpr int kLanes = kSkinningLanes;
  const int num_vertices = rig.weights.num_vertices();
  assert(positions->cols() == num_vertices && first_block >= 0 &&
         (first_block + num_blocks - 1) * kLanes < num_vertices);
  const SkinBlockFunction skin_block = ChosenSkinBlock();
  float last[3 * kLanes];
  for (int block = first_block; block < first_block + num_blocks; ++block) {
    const int begin = block * kLanes, count = std::min(kLanes, num_vertices - begin);
    float* target = positions->data() + 3 * static_cast<ptrdiff_t>(begin);
    skin_block(rig.weights.influences().data() + begin, rig.rest_positions.data() + 3 * begin,
               count, motions.columns.data(), details, count == kLanes ? target : last);
    if (count < kLanes) std::copy_n(last, 3 * count, target);
    if (details != nullptr) details += 3 * kLanes;
  }
}

}  // namespace pleat
