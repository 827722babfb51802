#include "pleat/skinning/frame_skinning.h"

#include <gtest/gtest.h>

#include <numeric>
#include <utility>
#include <vector>

#include "pleat/math/rotations.h"
#include "skin_block.h"
#include "support/skinned_figure.h"

namespace pleat {
namespace {

class FrameSkinningTest : public ::testing::Test {
 protected:
  FrameSkinningTest() {
    ComputeBoneTransforms(figure_.rig.skeleton,
                          MakeSmoothPoses(figure_.rig.skeleton, 6, 4).poses[5], {}, &transforms_);
    motions_.Set(transforms_, transforms_.rotation);
    details_.resize(3 * num_blocks_ * kSkinningLanes);
    for (size_t i = 0; i < details_.size(); ++i) {
      details_[i] = .02f * static_cast<float>(std::sin(.7 * static_cast<double>(i)));
    }
  }
  int num_vertices() const { return figure_.rig.weights.num_vertices(); }
  Eigen::Vector3d DetailOf(int v) const {
    const float* block = details_.data() + v / kSkinningLanes * 3 * kSkinningLanes;
    const int lane = v % kSkinningLanes;
    return {block[lane], block[kSkinningLanes + lane], block[2 * kSkinningLanes + lane]};
  }
  Eigen::Matrix3Xf Skin(const float* details) const {
    Eigen::Matrix3Xf positions = Eigen::Matrix3Xf::Constant(3, num_vertices(), 1e9f);
    SkinBlocks(figure_.rig, motions_, 0, num_blocks_, details, &positions);
    return positions;
  }

  // 595 vertices: the last block has three.
  SkinnedFigure figure_ = MakeSkinnedFigure({.num_rings = 7, .num_sides = 5});
  int num_blocks_ = (num_vertices() + kSkinningLanes - 1) / kSkinningLanes;
  BoneTransforms transforms_;
  BoneMotions motions_;
  std::vector<float> details_;
};

TEST_F(FrameSkinningTest, AgreesWithSkinningInDoublePrecision) {
  Eigen::Matrix3Xd expected;
  SkinVertices(figure_.rig.weights, figure_.rig.rest_positions, transforms_, &expected);
  EXPECT_LT((Skin(nullptr).cast<double>() - expected).cwiseAbs().maxCoeff(), 2e-6);
}

TEST_F(FrameSkinningTest, TurnsDetailsWithTheBlendedRotation) {
  Eigen::Matrix3Xd expected;
  SkinVertices(figure_.rig.weights, figure_.rig.rest_positions, transforms_, &expected);
  std::vector<int> all(num_vertices());
  std::iota(all.begin(), all.end(), 0);
  std::vector<Eigen::Quaterniond> rotations;
  BlendRotations(figure_.rig.weights, all, transforms_, &rotations);
  for (int v = 0; v < num_vertices(); ++v) expected.col(v) += rotations[v] * DetailOf(v);
  EXPECT_LT((Skin(details_.data()).cast<double>() - expected).cwiseAbs().maxCoeff(), 2e-6);
}

TEST_F(FrameSkinningTest, SignsOfTheQuaternionsDoNotMatter) {
  const Eigen::Matrix3Xf expected = Skin(details_.data());
  for (const int bone : {2, 5, 6, 11}) {
    for (int column = 0; column < 4; ++column) motions_.columns[16 * bone + 4 * column + 3] *= -1;
  }
  EXPECT_LT((Skin(details_.data()) - expected).cwiseAbs().maxCoeff(), 1e-7f);
}

TEST_F(FrameSkinningTest, PartsGiveTheWhole) {
  const Eigen::Matrix3Xf expected = Skin(details_.data());
  Eigen::Matrix3Xf positions(3, num_vertices());
  for (int block = 0; block < num_blocks_; ++block) {
    SkinBlocks(figure_.rig, motions_, block, 1, details_.data() + 3 * kSkinningLanes * block,
               &positions);
  }
  EXPECT_EQ(positions, expected);
}

TEST_F(FrameSkinningTest, EveryKernelGivesTheSameBits) {
  for (const float* details :
       {static_cast<const float*>(nullptr), std::as_const(details_).data()}) {
    for (const int count : {kSkinningLanes, 3}) {
      std::vector<float> expected;
      for (const SkinBlockFunction skin_block : UsableSkinBlocks()) {
        std::vector<float> positions(3 * kSkinningLanes);
        const int v = num_vertices() - count;
        skin_block(figure_.rig.weights.influences().data() + v,
                   figure_.rig.rest_positions.data() + 3 * v, count, motions_.columns.data(),
                   details, positions.data());
        positions.resize(3 * count);
        if (expected.empty()) expected = positions;
        EXPECT_EQ(positions, expected);
      }
    }
  }
}

}  // namespace
}  // namespace pleat
