#include "pleat/skinning/skin_weights.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(SkinWeightsTest, FromDenseKeepsTheFourLargestAndNormalizes) {
  Eigen::MatrixXd dense(2, 7);
  dense << 9, .1, .5, .05, .2, .15, .3,  // column 0 (no bone) is ignored
      0, 0, 0, 2, 0, -1, 0;              // one bone; negative weights are none
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinWeights weights, SkinWeights::FromDense(dense));
  EXPECT_EQ(weights.num_vertices(), 2);
  EXPECT_EQ(weights.num_joints(), 7);
  const VertexInfluences& first = weights.vertex(0);
  EXPECT_EQ(first.bones, (std::array<uint16_t, 4>{2, 6, 4, 5}));
  EXPECT_NEAR(first.weights[0], .5 / 1.15, 1e-6);
  EXPECT_NEAR(first.weights[3], .15 / 1.15, 1e-6);
  EXPECT_EQ(weights.vertex(1).bones[0], 3);
  EXPECT_EQ(weights.vertex(1).weights, (std::array<float, 4>{1, 0, 0, 0}));
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
  auto create = [](std::array<uint16_t, 4> bones, std::array<float, 4> weights) {
    return SkinWeights::Create(5, {{{1}, {1}}, {bones, weights}});
  };
  EXPECT_THAT(create({1, 4, 2, 3}, {.4f, .3f, .2f, .1f}), IsOk());
  EXPECT_THAT(create({1, 99}, {1, 0}), IsOk());  // the bone of an unused entry does not matter
  auto refused = HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex 1"));
  EXPECT_THAT(create({0}, {1}), refused);              // the root has no bone
  EXPECT_THAT(create({5}, {1}), refused);              // out of range
  EXPECT_THAT(create({1, 2}, {1.5f, -.5f}), refused);  // negative
  EXPECT_THAT(create({1}, {nan}), refused);            // not a number
  EXPECT_THAT(create({1, 2}, {.5f, .4f}), refused);    // sum
  EXPECT_THAT(create({}, {}), refused);                // nothing
}

}  // namespace
}  // namespace pleat
