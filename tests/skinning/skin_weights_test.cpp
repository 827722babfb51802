#include "pleat/skinning/skin_weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "pleat/base/random.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using Bones = std::array<uint16_t, kMaxInfluences>;
using Weights = std::array<float, kMaxInfluences>;

TEST(SkinWeightsTest, FromDenseKeepsTheFourLargestAndNormalizes) {
  Eigen::MatrixXd dense(2, 7);
  dense << 9, .1, .5, .05, .2, .15, .3,  // column 0 (no bone) is ignored
      0, 0, 0, 2, 0, -1, 0;              // one bone; negative weights are none
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinWeights weights, SkinWeights::FromDense(dense));
  EXPECT_EQ(weights.num_vertices(), 2);
  EXPECT_EQ(weights.num_joints(), 7);
  const VertexInfluences& first = weights.vertex(0);
  EXPECT_EQ(first.bones, (Bones{2, 6, 4, 5}));
  EXPECT_NEAR(first.weights[0], .5 / 1.15, 1e-6);
  EXPECT_NEAR(first.weights[3], .15 / 1.15, 1e-6);
  EXPECT_EQ(weights.vertex(1).bones[0], 3);
  EXPECT_EQ(weights.vertex(1).weights, (Weights{1}));
  EXPECT_EQ(weights.most_influences(), 4);
  EXPECT_LT((weights.ToDense().rowwise().sum().array() - 1).abs().maxCoeff(), 1e-6);
}

TEST(SkinWeightsTest, DenseRoundTrip) {
  Eigen::MatrixXd dense(1, 4);
  dense << 0, .25, .5, .25;
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinWeights weights, SkinWeights::FromDense(dense));
  EXPECT_EQ(weights.ToDense(), dense);
}

TEST(SkinWeightsTest, FromDenseNamesTheVertexWithoutWeight) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Constant(3, 3, .5);
  dense.row(2) << 1, 0, 0;
  EXPECT_THAT(SkinWeights::FromDense(dense),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex 2")));
  dense.row(2) << 0, std::numeric_limits<double>::infinity(), 0;
  EXPECT_THAT(SkinWeights::FromDense(dense),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex 2")));
  EXPECT_FALSE(SkinWeights::FromDense(Eigen::MatrixXd::Ones(2, 1)).ok());  // no bone at all
}

TEST(SkinWeightsTest, CreateChecksEveryInfluence) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  auto create = [](Bones bones, Weights weights) {
    return SkinWeights::Create(5, {{{1}, {1}}, {bones, weights}});
  };
  EXPECT_THAT(create({1, 4, 2, 3}, {.4f, .3f, .2f, .1f}), IsOk());
  EXPECT_THAT(create({1, 99}, {1, 0}), IsOk());  // the bone of an unused entry does not matter
  EXPECT_EQ(create({1, 99}, {1, 0})->vertex(1).bones[1], 0);  // but kernels read it
  auto refused = HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex 1"));
  EXPECT_THAT(create({0}, {1}), refused);              // the root has no bone
  EXPECT_THAT(create({5}, {1}), refused);              // out of range
  EXPECT_THAT(create({1, 2}, {1.5f, -.5f}), refused);  // negative
  EXPECT_THAT(create({1}, {nan}), refused);            // not a number
  EXPECT_THAT(create({1, 2}, {.5f, .4f}), refused);    // sum
  EXPECT_THAT(create({}, {}), refused);                // nothing
  EXPECT_THAT(create({1, 2}, {0, 1}), refused);        // the strongest is not the first
  EXPECT_THAT(create({1, 2, 3}, {.5f, 0, .5f}), refused);
  EXPECT_THAT(create({1}, {1 + 2e-4f}), refused);
  EXPECT_THAT(create({1}, {1 + 5e-5f}), IsOk());
}

TEST(SkinWeightsTest, FromDenseRefusesANanWhereverItStands) {
  for (int bone = 1; bone < 9; ++bone) {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Constant(2, 9, .1);
    dense(1, bone) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(SkinWeights::FromDense(dense),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex 1")))
        << bone;
  }
}

TEST(SkinWeightsTest, EqualWeightsGoToTheLowerBones) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinWeights weights,
                             SkinWeights::FromDense(Eigen::MatrixXd::Constant(1, 8, .3)));
  EXPECT_EQ(weights.vertex(0).bones, (Bones{1, 2, 3, 4}));
  std::map<int, double> equal;
  for (const int bone : {12, 9, 8, 7, 6, 5, 3, 2, 1}) equal[bone] = .2;
  EXPECT_EQ(StrongestInfluences(equal).bones, (Bones{1, 2, 3, 5, 6, 7, 8, 9}));
}

// Whatever is pruned: what stays is what was strongest, in its old proportions.
TEST(SkinWeightsTest, PruningKeepsTheLargestInTheirProportions) {
  Random random(5);
  for (int round = 0; round < 100; ++round) {
    const int num_joints = 2 + random.UniformInt(12);
    Eigen::MatrixXd dense(1, num_joints);
    std::map<int, double> by_bone;
    for (int b = 0; b < num_joints; ++b) {
      dense(0, b) = random.UniformInt(3) == 0 ? 0 : random.Uniform();
      if (b > 0 && dense(0, b) > 0) by_bone[b] = dense(0, b);
    }
    if (by_bone.empty()) continue;
    PLEAT_ASSERT_OK_AND_ASSIGN(const SkinWeights weights, SkinWeights::FromDense(dense));
    const VertexInfluences& kept = weights.vertex(0);
    const size_t count = std::min<size_t>(kStandardInfluences, by_bone.size());
    if (by_bone.size() <= kStandardInfluences) {
      EXPECT_EQ(kept.bones, StrongestInfluences(by_bone).bones);
      EXPECT_EQ(kept.weights, StrongestInfluences(by_bone).weights);
    }
    float sum = 0;
    for (size_t k = 0; k < kMaxInfluences; ++k) {
      sum += kept.weights[k];
      EXPECT_EQ(kept.weights[k] > 0, k < count);
      EXPECT_EQ(kept.bones[k] == 0, k >= count);
      EXPECT_LE(kept.weights[k], kept.weights[k == 0 ? 0 : k - 1]);
      if (k > 0 && k < count) {
        EXPECT_NEAR(kept.weights[k] / kept.weights[0],
                    by_bone[kept.bones[k]] / by_bone[kept.bones[0]], 1e-6);
      }
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    for (const auto& [bone, weight] : by_bone) {
      if (std::find(kept.bones.begin(), kept.bones.end(), bone) != kept.bones.end()) continue;
      EXPECT_LE(weight, by_bone[kept.bones[kStandardInfluences - 1]]);
    }
    EXPECT_THAT(SkinWeights::Create(num_joints, {kept}), IsOk());
  }
}

}  // namespace
}  // namespace pleat
