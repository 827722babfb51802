#include "detail_regions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "support/skinned_figure.h"

namespace pleat {
namespace {

class DetailRegionsTest : public ::testing::TestWithParam<RotationRepresentation> {
 protected:
  DetailRegionsTest() {
    options_.rotations = GetParam();
    options_.history = 3;
    control_.resize(static_cast<size_t>(figure_.rig.weights.num_vertices()));
    std::iota(control_.begin(), control_.end(), 0);
  }
  int num_columns() const { return 3 * 17 * NumCoordinates(GetParam()); }
  std::vector<DetailRegion> Regions(const std::vector<int>& control, double share = 1) const {
    return DetailRegions(BoneRegions(figure_.rig, control), figure_.rig.skeleton, control, share,
                         options_);
  }

  const SkinnedFigure figure_ = MakeSkinnedFigure({.num_rings = 3, .num_sides = 4});
  TrainOptions options_;
  std::vector<int> control_;
};

TEST_P(DetailRegionsTest, WeightsAreASharingOutOfEveryDetail) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(control_.size()));
  const std::vector<DetailRegion> regions = Regions(control_, .75);
  EXPECT_EQ(regions.size(), 17u);  // every bone has a tube of its own
  for (const DetailRegion& region : regions) {
    EXPECT_GT(region.weights.minCoeff(), 0);
    ASSERT_EQ(region.weights.size(), static_cast<Eigen::Index>(region.rows.size()));
    sum(region.rows) += region.weights;
  }
  EXPECT_LT((sum.array() - .75).abs().maxCoeff(), 1e-6);
}

// From all features to those of the nearest bones: each set holds the next.
TEST_P(DetailRegionsTest, FeatureSetsAreNestedAndHoldEveryPoseOfTheHistory) {
  for (const DetailRegion& region : Regions(control_)) {
    ASSERT_EQ(region.feature_sets.size(), 3u);
    EXPECT_EQ(static_cast<int>(region.feature_sets[0].size()), num_columns());
    for (size_t i = 0; i < 3; ++i) {
      const std::set<int> columns(region.feature_sets[i].begin(), region.feature_sets[i].end());
      EXPECT_EQ(columns.size(), region.feature_sets[i].size());
      EXPECT_GE(*columns.begin(), 0);
      EXPECT_LT(*columns.rbegin(), num_columns());
      // Whole bones, in every pose of the history.
      EXPECT_EQ(columns.size() % static_cast<size_t>(3 * NumCoordinates(GetParam())), 0u);
      if (i == 0) continue;
      for (const int column : columns) {
        EXPECT_THAT(region.feature_sets[i - 1], testing::Contains(column));
      }
      EXPECT_LE(columns.size(), region.feature_sets[i - 1].size());
    }
  }
}

TEST_P(DetailRegionsTest, ABoneThatMovesNoControlVertexHasNoRegion) {
  std::vector<int> one_tube(12);  // the vertices around bone 1
  std::iota(one_tube.begin(), one_tube.end(), 0);
  const auto regions = Regions(one_tube);
  EXPECT_GE(regions.size(), 1u);
  EXPECT_LT(regions.size(), 17u);
  for (const DetailRegion& region : regions) {
    EXPECT_LE(region.weights.size(), 36);
    EXPECT_GT(region.weights.maxCoeff(), 0);
  }
}

TEST_P(DetailRegionsTest, GroupsShareOutTheColumnsInOrder) {
  std::vector<int> all;
  const auto groups = FeatureGroups(18, options_);
  EXPECT_EQ(groups.size(), 3u * 17u);
  for (const std::vector<int>& group : groups) {
    EXPECT_EQ(static_cast<int>(group.size()), NumCoordinates(GetParam()));
    all.insert(all.end(), group.begin(), group.end());
  }
  std::vector<int> expected(static_cast<size_t>(num_columns()));
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(all, expected);
}

INSTANTIATE_TEST_SUITE_P(Rotations, DetailRegionsTest,
                         ::testing::Values(RotationRepresentation::kExponentialMap,
                                           RotationRepresentation::kEuler,
                                           RotationRepresentation::kQuaternion));

}  // namespace
}  // namespace pleat
