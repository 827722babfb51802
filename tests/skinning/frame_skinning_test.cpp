#include "pleat/skinning/frame_skinning.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <numeric>
#include <string>
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
    ComputeBoneTransforms(figure_.rig.skeleton, MakeSmoothPoses(figure_.rig.skeleton, 6, 4).pose(5),
                          {}, &transforms_);
    skinning_.SetMotions(transforms_, transforms_.rotation, &motions_);
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
    skinning_.SkinBlocks(motions_, 0, num_blocks_, details, RowsOf(&positions));
    return positions;
  }

  Eigen::Matrix3Xd Expected(bool with_details) const {
    Eigen::Matrix3Xd expected;
    SkinVertices(figure_.rig.weights, figure_.rig.rest_positions, transforms_, &expected);
    if (!with_details) return expected;
    std::vector<int> all(num_vertices());
    std::iota(all.begin(), all.end(), 0);
    std::vector<Eigen::Quaterniond> rotations;
    BlendRotations(figure_.rig.weights, all, transforms_, &rotations);
    for (int v = 0; v < num_vertices(); ++v) expected.col(v) += rotations[v] * DetailOf(v);
    return expected;
  }
  // All kernels, and those that look up bones in tables also without them.
  void CompareKernels() const {
    for (const float* details : {static_cast<const float*>(nullptr), details_.data()}) {
      const Eigen::Matrix3Xf expected = Skin(details);
      for (const bool with_tables : {true, false}) {
        BoneMotions motions = motions_;
        if (!with_tables) motions.tables.clear();
        for (const auto& [set, skin_block] : SkinBlockVariants()) {
          Eigen::Matrix3Xf positions(3, num_vertices());
          skinning_.SkinBlocksWith(skin_block, motions, 0, num_blocks_, details,
                                   RowsOf(&positions));
          EXPECT_EQ(
              0, std::memcmp(positions.data(), expected.data(), positions.size() * sizeof(float)))
              << NameOf(set);
        }
      }
    }
  }

  // 595 vertices: the last block has three.
  SkinnedFigure figure_ = MakeSkinnedFigure({.num_rings = 7, .num_sides = 5});
  FrameSkinning skinning_{figure_.rig};
  int num_blocks_ = skinning_.num_blocks();
  BoneTransforms transforms_;
  BoneMotions motions_;
  std::vector<float> details_;
};

TEST_F(FrameSkinningTest, AgreesWithSkinningInDoublePrecision) {
  EXPECT_LT((Skin(nullptr).cast<double>() - Expected(false)).cwiseAbs().maxCoeff(), 2e-6);
}

TEST_F(FrameSkinningTest, TurnsDetailsWithTheBlendedRotation) {
  EXPECT_LT((Skin(details_.data()).cast<double>() - Expected(true)).cwiseAbs().maxCoeff(), 2e-6);
}

// Bones from all over the figure on each vertex, turned so far against each other that no choice of
// signs suits them all.
class FarBonesTest : public FrameSkinningTest {
 protected:
  FarBonesTest() {
    const int num_joints = figure_.rig.skeleton.num_joints(), num_bones = num_joints - 1;
    std::vector<VertexInfluences> influences(num_vertices());
    for (int v = 0; v < num_vertices(); ++v) {
      // Every third block has up to eight bones on a vertex.
      const int count = v / kSkinningLanes % 3 == 0 ? kMaxInfluences - v % 3 : 4;
      for (int k = 0; k < count; ++k) {
        influences[v].bones[k] = static_cast<uint16_t>(1 + (v / 3 + 5 * k) % num_bones);
        influences[v].weights[k] = static_cast<float>(2 * (count - k)) / float(count * (count + 1));
      }
    }
    figure_.rig.weights = SkinWeights::Create(num_joints, influences).value();
    skinning_ = FrameSkinning(figure_.rig);
    for (int b = 0; b < num_joints; ++b) {
      transforms_.rotation[b] =
          Eigen::AngleAxisd(.8 * b, Eigen::Vector3d(1, .2 * b, -.5).normalized())
              .toRotationMatrix();
    }
    skinning_.SetMotions(transforms_, transforms_.rotation, &motions_);
  }
};

TEST_F(FarBonesTest, QuaternionsAreAlignedWithTheStrongest) {
  EXPECT_FALSE(motions_.signs.empty());
  EXPECT_LT((Skin(details_.data()).cast<double>() - Expected(true)).cwiseAbs().maxCoeff(), 3e-6);
}

TEST_F(FarBonesTest, NothingIsLeftOfTheFrameBefore) {
  const Eigen::Matrix3Xf expected = Skin(details_.data());
  const BoneMotions before = motions_;
  skinning_.SetMotions(transforms_, std::vector<Eigen::Matrix3d>(18, Eigen::Matrix3d::Identity()),
                       &motions_);
  EXPECT_TRUE(motions_.signs.empty());
  skinning_.SetMotions(transforms_, transforms_.rotation, &motions_);
  EXPECT_EQ(motions_.signs, before.signs);
  EXPECT_EQ(Skin(details_.data()), expected);
}

TEST_F(FarBonesTest, EveryKernelGivesTheSameBits) { CompareKernels(); }

// The vertices of an interleaved buffer, with what belongs to others between them.
TEST_F(FrameSkinningTest, RowsWithAStrideHoldTheSameAndNothingElseIsTouched) {
  const Eigen::Matrix3Xf expected = Skin(details_.data());
  constexpr int kStride = 8;
  std::vector<float> buffer(static_cast<size_t>(kStride) * num_vertices(), -1);
  const VertexRows rows{.data = buffer.data() + 1, .stride = kStride};
  skinning_.SkinBlocks(motions_, 0, num_blocks_, details_.data(), rows);
  for (int v = 0; v < num_vertices(); ++v) {
    EXPECT_EQ(Eigen::Map<Eigen::Vector3f>(rows.row(v)), expected.col(v)) << v;
    for (const int other : {0, 4, 5, 6, 7}) EXPECT_EQ(buffer[kStride * v + other], -1);
  }
}

TEST_F(FrameSkinningTest, PartsGiveTheWhole) {
  const Eigen::Matrix3Xf expected = Skin(details_.data());
  Eigen::Matrix3Xf positions(3, num_vertices());
  for (int block = 0; block < num_blocks_; ++block) {
    skinning_.SkinBlocks(motions_, block, 1, details_.data() + 3 * kSkinningLanes * block,
                         RowsOf(&positions));
  }
  EXPECT_EQ(positions, expected);
}

TEST_F(FrameSkinningTest, EveryKernelGivesTheSameBits) { CompareKernels(); }

TEST_F(FrameSkinningTest, EveryNumberOfVerticesFillsItsMatrixAndNothingElse) {
  for (const int count : {1, 15, 16, 17, 31, 32, 33}) {
    Rig rig{figure_.rig.skeleton, {}, figure_.rig.rest_positions.leftCols(count)};
    const std::vector<VertexInfluences>& all = figure_.rig.weights.influences();
    rig.weights = SkinWeights::Create(18, {all.begin(), all.begin() + count}).value();
    const FrameSkinning skinning(rig);
    EXPECT_EQ(skinning.num_blocks(), (count + 15) / 16);
    for (const bool with_details : {false, true}) {
      const float* details = with_details ? details_.data() : nullptr;
      const Eigen::Matrix3Xf expected = Skin(details).leftCols(count);
      for (const auto& [set, skin_block] : SkinBlockVariants()) {
        Eigen::Matrix3Xf positions(3, count);
        skinning.SkinBlocksWith(skin_block, motions_, 0, skinning.num_blocks(), details,
                                RowsOf(&positions));
        EXPECT_EQ(positions, expected) << NameOf(set) << " " << count;
      }
    }
  }
}

TEST_F(FrameSkinningTest, LanesInAnotherOrderGiveTheSamePositions) {
  // The vertices backwards, with a block of five that is only filled up.
  std::vector<int> lanes;
  for (int i = 0; i < num_vertices(); ++i) {
    if (i == 5) lanes.resize(16, -1);
    lanes.push_back(num_vertices() - 1 - i);
  }
  lanes.resize((lanes.size() + 15) / 16 * 16, -1);
  const FrameSkinning skinning(figure_.rig, lanes);
  ASSERT_EQ(skinning.num_blocks(), static_cast<int>(lanes.size() / 16));
  std::vector<float> details(3 * lanes.size(), 0);
  for (size_t lane = 0; lane < lanes.size(); ++lane) {
    if (lanes[lane] < 0) continue;
    const size_t v = static_cast<size_t>(lanes[lane]);
    for (size_t axis = 0; axis < 3; ++axis) {
      details[lane / 16 * 48 + axis * 16 + lane % 16] =
          details_.data()[v / 16 * 48 + axis * 16 + v % 16];
    }
  }
  Eigen::Matrix3Xf positions(3, num_vertices());
  skinning.SkinBlocks(motions_, 0, skinning.num_blocks(), details.data(), RowsOf(&positions));
  EXPECT_EQ(positions, Skin(details_.data()));
}

// The bone of an unused entry may be anything in a file, and kernels read the bones of all entries.
TEST_F(FrameSkinningTest, BonesOfUnusedEntriesDoNotMatter) {
  std::vector<VertexInfluences> odd = figure_.rig.weights.influences();
  for (VertexInfluences& vertex : odd) {
    for (int k = 0; k < kMaxInfluences; ++k) {
      if (vertex.weights[k] == 0) vertex.bones[k] = 65535;
    }
  }
  const Eigen::Matrix3Xf expected = Skin(details_.data());
  figure_.rig.weights = SkinWeights::Create(18, odd).value();
  skinning_ = FrameSkinning(figure_.rig);
  skinning_.SetMotions(transforms_, transforms_.rotation, &motions_);
  EXPECT_EQ(Skin(details_.data()), expected);
  CompareKernels();
}

// More bones than the processor can look up in registers.
TEST(ManyBonesTest, KernelsAgreeWithDoublePrecisionBeyondTheTables) {
  for (const int num_joints : {kLookupBones, kLookupBones + 1, 200}) {
    std::vector<Joint> joints = {{"root", -1, {0, 0, 0}}};
    for (int j = 1; j < num_joints; ++j) {
      joints.push_back({std::to_string(j), j - 1, {0, .1 * j, 0}});
    }
    Rig rig{Skeleton::Create(joints).value(), {}, Eigen::Matrix3Xd::Random(3, 40)};
    std::vector<VertexInfluences> influences(40);
    for (int v = 0; v < 40; ++v) {
      for (int k = 0; k < 3; ++k) {
        influences[v].bones[k] = static_cast<uint16_t>(num_joints - 1 - (v + 7 * k) % 25);
        influences[v].weights[k] = std::array{.5f, .25f, .25f}[k];
      }
    }
    rig.weights = SkinWeights::Create(num_joints, influences).value();
    Pose pose = Pose::Rest(rig.skeleton);
    for (Eigen::Quaterniond& rotation : pose.rotations) {
      rotation = QuaternionFromExponentialMap({.02, -.01, .03});
    }
    BoneTransforms transforms;
    ComputeBoneTransforms(rig.skeleton, pose, {}, &transforms);
    Eigen::Matrix3Xd expected;
    SkinVertices(rig.weights, rig.rest_positions, transforms, &expected);
    const FrameSkinning skinning(rig);
    BoneMotions motions;
    skinning.SetMotions(transforms, transforms.rotation, &motions);
    EXPECT_EQ(motions.tables.empty(), num_joints > kLookupBones);
    for (const auto& [set, skin_block] : SkinBlockVariants()) {
      Eigen::Matrix3Xf positions(3, 40);
      skinning.SkinBlocksWith(skin_block, motions, 0, skinning.num_blocks(), nullptr,
                              RowsOf(&positions));
      EXPECT_LT((positions.cast<double>() - expected).cwiseAbs().maxCoeff(), 2e-5)
          << NameOf(set) << " " << num_joints;
    }
  }
}

}  // namespace
}  // namespace pleat
