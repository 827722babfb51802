// Skinning of whole frames in float32, details included, 16 vertices at a time: what a query runs
// (docs/method/prediction.md#skinning-with-details). rig.h has the same in double precision, vertex
// by vertex, for training.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pleat/mesh/vertex_rows.h"
#include "pleat/skeleton/pose.h"
#include "pleat/skinning/rig.h"

namespace pleat {

inline constexpr int kSkinningLanes = 16;  // vertices of a block

struct SkinBlockInputs;  // src/skin_block.h
using SkinBlockFunction = void (*)(const SkinBlockInputs& inputs, float* positions);

// What moves the vertices of one frame. Each bone has 16 numbers, four columns of four: the first
// three rows are [linear_b | translation_b], the fourth holds the unit quaternion (x, y, z, w) of
// the axes in which the bone's details are written.
struct BoneMotions {
  std::vector<float> columns;  // 16 J: bone by bone
  std::vector<float> tables;  // the same for a lookup: parameter by parameter, see src/skin_block.h
  // J x J, empty unless needed: the sign that turns bone b's quaternion towards that of the
  // strongest bone s of a vertex, at s J + b.
  std::vector<float> signs;
};

// The vertices of a rig in the order in which a query reads them. Immutable; threads may skin
// different blocks of one frame at the same time.
class FrameSkinning {
 public:
  FrameSkinning() = default;
  // lane_vertices: which vertex every lane of every block holds, each vertex once, -1 where a block
  // is only filled up; empty when vertices follow each other in their order.
  explicit FrameSkinning(const Rig& rig, std::vector<int> lane_vertices = {});

  int num_blocks() const { return static_cast<int>(blocks_.size()); }
  size_t memory_bytes() const;

  // Fills `motions` for one frame. axes: J rotations. It does not allocate after the first call.
  void SetMotions(const BoneTransforms& transforms, const std::vector<Eigen::Matrix3d>& axes,
                  BoneMotions* motions) const;

  // Skins the vertices of the blocks first_block to first_block + num_blocks - 1 (block i: those of
  // the lanes 16 i to 16 i + 15):
  //
  //   position_v = sum_b w_vb (linear_b rest_v + translation_b) + R(q_v) detail_v
  //
  // where q_v is the normalized mean of the quaternions of its bones, with signs aligned with the
  // strongest. details: x of the 16 vertices of a block, then y, then z, block by block, beginning
  // with first_block; or null for none. positions: V rows.
  void SkinBlocks(const BoneMotions& motions, int first_block, int num_blocks, const float* details,
                  const VertexRows& positions) const;
  // Does the same with a given kernel, so that tests can compare all that a processor can run.
  void SkinBlocksWith(SkinBlockFunction skin_block, const BoneMotions& motions, int first_block,
                      int num_blocks, const float* details, const VertexRows& positions) const;

  // The data of 16 vertices. The last one of a block fills the lanes left over.
  struct alignas(64) Block {
    float rest[3 * kSkinningLanes];  // x of all, y, z; meters
    float weights[kMaxInfluences * kSkinningLanes];
    uint16_t bones[kMaxInfluences * kSkinningLanes];  // the strongest of each vertex first
    // What its vertices have, rounded up to one of the two counts for which kernels are unrolled:
    // entries without weight, which add zero, change no bit of a sum.
    // It is last, because kernels load the lists above as whole, aligned registers.
    int num_influences = kStandardInfluences;
  };

 private:
  // Copies the lanes of a block to their vertices.
  void Scatter(int block, const float* lanes, const VertexRows& positions) const;

  int num_vertices_ = 0;
  std::vector<int> lane_vertices_;  // empty: in their order
  std::vector<int> parents_;        // J
  // A bone that moves a vertex together with its strongest bone; each pair is listed once.
  struct BonePair {
    int strongest, other;
  };
  std::vector<BonePair> pairs_;
  std::vector<Block> blocks_;
};

}  // namespace pleat
