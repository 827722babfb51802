#include "body_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "support/skinned_figure.h"

namespace pleat {
namespace {

class BodyRegionsTest : public testing::Test {
 protected:
  BodyRegionsTest() {
    all_.resize(static_cast<size_t>(figure_.rig.weights.num_vertices()));
    std::iota(all_.begin(), all_.end(), 0);
  }
  // The sum of the shares of every vertex; also that vertices ascend and shares are positive.
  std::vector<float> Sums(const std::vector<BodyRegion>& regions) const {
    std::vector<float> sums(all_.size(), 0);
    for (const BodyRegion& region : regions) {
      EXPECT_EQ(region.vertices.size(), region.weights.size());
      EXPECT_TRUE(std::is_sorted(region.vertices.begin(), region.vertices.end()));
      EXPECT_FALSE(region.bones.empty());
      for (size_t i = 0; i < region.vertices.size(); ++i) {
        EXPECT_GT(region.weights[i], 0);
        sums[region.vertices[i]] += region.weights[i];
      }
    }
    return sums;
  }

  const SkinnedFigure figure_ = MakeSkinnedFigure({.num_rings = 6, .num_sides = 6});
  std::vector<int> all_;
};

TEST_F(BodyRegionsTest, BonesShareOutTheirSkinningWeights) {
  const std::vector<BodyRegion> regions = BoneRegions(figure_.rig, all_);
  ASSERT_EQ(regions.size(), 17u);
  for (const float sum : Sums(regions)) EXPECT_NEAR(sum, 1, 1e-5);
  for (size_t b = 0; b < 17; ++b) {
    EXPECT_EQ(regions[b].bones, std::set<int>{static_cast<int>(b) + 1});
  }
}

TEST_F(BodyRegionsTest, PatchesCoverTheBodyWithFewSharesEach) {
  const std::vector<BodyRegion> patches = PatchRegions(figure_.rig, all_, 40);
  EXPECT_EQ(patches.size(), 40u);
  for (const float sum : Sums(patches)) EXPECT_NEAR(sum, 1, 1e-5);
  std::vector<int> num_shares(all_.size(), 0);
  for (const BodyRegion& patch : patches) {
    for (const int v : patch.vertices) ++num_shares[v];
    // A patch is local: it lies within a tube and its neighbors.
    Eigen::AlignedBox3d box;
    for (size_t i = 0; i < patch.vertices.size(); ++i) {
      if (patch.weights[i] > .5) box.extend(figure_.rig.rest_positions.col(patch.vertices[i]));
    }
    if (!box.isEmpty()) {
      EXPECT_LT(box.diagonal().norm(), .6);
    }
  }
  EXPECT_LE(*std::max_element(num_shares.begin(), num_shares.end()), 4);
}

TEST_F(BodyRegionsTest, PatchesAreTheSameEveryTime) {
  const std::vector<BodyRegion> a = PatchRegions(figure_.rig, all_, 20);
  const std::vector<BodyRegion> b = PatchRegions(figure_.rig, all_, 20);
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].vertices, b[i].vertices);
    EXPECT_EQ(a[i].weights, b[i].weights);
    EXPECT_EQ(a[i].bones, b[i].bones);
  }
}

TEST_F(BodyRegionsTest, RegionsWithoutAControlVertexAreLeftOut) {
  std::vector<int> one_tube(36);
  std::iota(one_tube.begin(), one_tube.end(), 0);
  EXPECT_LT(BoneRegions(figure_.rig, one_tube).size(), 17u);
  EXPECT_LT(PatchRegions(figure_.rig, one_tube, 40).size(), 40u);
}

TEST_F(BodyRegionsTest, MorePatchesThanVerticesAreAsManyAsPlaces) {
  Rig rig{figure_.rig.skeleton, {}, figure_.rig.rest_positions.leftCols(5)};
  const std::vector<VertexInfluences>& influences = figure_.rig.weights.influences();
  rig.weights = SkinWeights::Create(18, {influences.begin(), influences.begin() + 5}).value();
  const std::vector<BodyRegion> patches = PatchRegions(rig, {0, 1, 2, 3, 4}, 60);
  EXPECT_EQ(patches.size(), 5u);
}

}  // namespace
}  // namespace pleat
