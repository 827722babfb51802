#include "pleat/skinning/frame_skinning.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <set>
#include <utility>

#include "skin_block.h"

namespace pleat {

FrameSkinning::FrameSkinning(const Rig& rig, std::vector<int> lane_vertices)
    : num_vertices_(rig.weights.num_vertices()), lane_vertices_(std::move(lane_vertices)) {
  for (const Joint& joint : rig.skeleton.joints()) parents_.push_back(joint.parent);
  const size_t num_lanes =
      lane_vertices_.empty() ? static_cast<size_t>(num_vertices_) : lane_vertices_.size();
  blocks_.resize((num_lanes + kSkinningLanes - 1) / kSkinningLanes);
  int v = 0;  // stays where a lane is only filled up
  // Most pairs of bones never share a vertex, so SetMotions() compares the signs of few.
  std::set<std::pair<int, int>> pairs;
  for (size_t i = 0; i < blocks_.size() * kSkinningLanes; ++i) {
    if (lane_vertices_.empty()) {
      v = std::min(static_cast<int>(i), num_vertices_ - 1);
    } else if (lane_vertices_[i] >= 0) {
      v = lane_vertices_[i];
    }
    Block& block = blocks_[i / kSkinningLanes];
    const size_t lane = i % kSkinningLanes;
    const VertexInfluences& influences = rig.weights.vertex(v);
    for (int k = 0; k < kMaxInfluences; ++k) {
      block.weights[k * kSkinningLanes + lane] = influences.weights[k];
      block.bones[k * kSkinningLanes + lane] = influences.bones[k];
      if (influences.weights[k] > 0 && k >= block.num_influences)
        block.num_influences = kMaxInfluences;
      if (k > 0 && influences.weights[k] > 0) {
        pairs.emplace(influences.bones[0], influences.bones[k]);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      block.rest[axis * kSkinningLanes + lane] = static_cast<float>(rig.rest_positions(axis, v));
    }
  }
  for (const auto& [strongest, other] : pairs) pairs_.push_back({strongest, other});
}

size_t FrameSkinning::memory_bytes() const {
  return blocks_.size() * sizeof(Block) + pairs_.size() * sizeof(BonePair) +
         lane_vertices_.size() * sizeof(int);
}

void FrameSkinning::Scatter(int block, const float* lanes, const VertexRows& positions) const {
  const int* vertices = lane_vertices_.data() + static_cast<ptrdiff_t>(block) * kSkinningLanes;
  for (int lane = 0; lane < kSkinningLanes && vertices[lane] >= 0; ++lane) {
    std::copy_n(lanes + 3 * lane, 3, positions.row(vertices[lane]));
  }
}

void FrameSkinning::SetMotions(const BoneTransforms& transforms,
                               const std::vector<Eigen::Matrix3d>& axes,
                               BoneMotions* motions) const {
  const size_t num_bones = parents_.size();
  assert(axes.size() == num_bones && transforms.linear.size() == num_bones);
  motions->columns.resize(kMotionParameters * num_bones);
  const auto motion_of = [&](size_t b) {
    return Eigen::Map<Eigen::Matrix4f>(motions->columns.data() + kMotionParameters * b);
  };
  for (size_t b = 0; b < num_bones; ++b) {
    auto motion = motion_of(b);
    motion.topLeftCorner<3, 3>() = transforms.linear[b].cast<float>();
    motion.topRightCorner<3, 1>() = transforms.translation[b].cast<float>();
    motion.row(3) = Eigen::Quaterniond(axes[b]).coeffs().transpose().cast<float>();
    // Of q and -q the one nearer to the parent's is taken. Neighbors along the skeleton then agree,
    // so that few frames need signs.
    if (parents_[b] >= 0 && motion.row(3).dot(motion_of(parents_[b]).row(3)) < 0) {
      motion.row(3) *= -1;
    }
  }
  motions->signs.clear();
  motions->signs.reserve(num_bones * num_bones);
  for (const auto& [strongest, other] : pairs_) {
    if (!(motion_of(strongest).row(3).dot(motion_of(other).row(3)) < 0)) continue;
    if (motions->signs.empty()) motions->signs.assign(num_bones * num_bones, 1);
    motions->signs[strongest * num_bones + other] = -1;
  }
  motions->tables.clear();
  if (num_bones > kLookupBones) return;
  motions->tables.resize(kMotionParameters * kLookupBones);
  for (size_t b = 0; b < num_bones; ++b) {
    for (int p = 0; p < kMotionParameters; ++p) {
      motions->tables[p * kLookupBones + b] = motions->columns[kMotionParameters * b + p];
    }
  }
}

void FrameSkinning::SkinBlocks(const BoneMotions& motions, int first_block, int num_blocks,
                               const float* details, const VertexRows& positions) const {
  SkinBlocksWith(SkinBlockVariants().front().kernel, motions, first_block, num_blocks, details,
                 positions);
}

void FrameSkinning::SkinBlocksWith(SkinBlockFunction skin_block, const BoneMotions& motions,
                                   int first_block, int num_blocks, const float* details,
                                   const VertexRows& positions) const {
  constexpr int kLanes = kSkinningLanes;
  assert(positions.stride >= 3 && first_block >= 0 &&
         first_block + num_blocks <= this->num_blocks());
  // The kernels write whole blocks. What reaches beyond the last row, or whose vertices do not
  // follow each other, goes here first.
  float last[3 * kLanes];
  float signed_weights[kMaxInfluences * kLanes];
  SkinBlockInputs inputs{.columns = motions.columns.data(),
                         .tables = motions.tables.empty() ? nullptr : motions.tables.data(),
                         .details = details};
  for (int i = first_block; i < first_block + num_blocks; ++i) {
    const Block& block = blocks_[i];
    inputs.block = &block;
    inputs.quaternion_weights = block.weights;
    // The slow way, for the few frames in which the quaternions of two bones of a vertex disagree
    // although neighbors along the skeleton agree.
    if (!motions.signs.empty() && details != nullptr) {
      for (int place = 0; place < block.num_influences * kLanes; ++place) {
        const size_t strongest = block.bones[place % kLanes];
        const size_t other = block.bones[place];
        signed_weights[place] =
            motions.signs[strongest * parents_.size() + other] * block.weights[place];
      }
      inputs.quaternion_weights = signed_weights;
    }
    const int begin = i * kLanes, count = std::min(kLanes, num_vertices_ - begin);
    if (lane_vertices_.empty()) {
      const bool in_place = count == kLanes && positions.is_packed();
      skin_block(inputs, in_place ? positions.row(begin) : last);
      for (int lane = 0; !in_place && lane < count; ++lane) {
        std::copy_n(last + 3 * lane, 3, positions.row(begin + lane));
      }
    } else {
      skin_block(inputs, last);
      Scatter(i, last, positions);
    }
    if (inputs.details != nullptr) inputs.details += 3 * kLanes;
  }
}

}  // namespace pleat
