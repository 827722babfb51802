#include "pleat/character/skin_features.h"

#include <gtest/gtest.h>

#include <numeric>

#include "skin_features_train.h"
#include "support/allocation_counter.h"
#include "support/skinned_figure.h"
#include "support/smooth_poses.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class SkinFeaturesTest : public testing::Test {
 protected:
  SkinFeaturesTest() {
    std::vector<int> all(static_cast<size_t>(figure_.rig.weights.num_vertices()));
    std::iota(all.begin(), all.end(), 0);
    regions_ = BoneRegions(figure_.rig, all);
    for (BodyRegion& region : regions_) region.max_skin_features = 6;
  }
  absl::StatusOr<SkinFeatures> Train(int num_threads = 0) const {
    return TrainSkinFeatures(figure_.topology, figure_.rig, track_, regions_,
                             {.num_points = 120, .num_threads = num_threads});
  }

  const SkinnedFigure figure_ = MakeSkinnedFigure();
  const PoseTrack track_ = MakeSmoothPoses(figure_.rig.skeleton, 40, 7);
  std::vector<BodyRegion> regions_;
};

TEST_F(SkinFeaturesTest, TrainingGivesCenteredFeaturesOfOneUnit) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinFeatures features, Train());
  ASSERT_EQ(features.num_regions(), 17);
  const Eigen::MatrixXd rows = features.ComputeTrack(figure_.rig.skeleton, track_, 1);
  ASSERT_EQ(rows.cols(), features.num_features());
  EXPECT_LT(rows.colwise().mean().cwiseAbs().maxCoeff(), 1e-3);
  for (int r = 0; r < 17; ++r) {
    const int begin = features.region_begin(r), count = features.region_end(r) - begin;
    ASSERT_GT(count, 0);
    ASSERT_LE(count, 6);
    const double mean_square = rows.middleCols(begin, count).squaredNorm() / 40;
    EXPECT_TRUE(std::abs(mean_square - 1) < 1e-2 || mean_square < 1e-6) << r << " " << mean_square;
  }
}

TEST_F(SkinFeaturesTest, ParametersGiveTheSameBitsForAnyNumberOfThreads) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinFeatures one, Train(1));
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinFeatures many, Train(3));
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinFeatures restored,
                             SkinFeatures::FromParameters(figure_.rig, one.parameters()));
  const Eigen::MatrixXd expected = one.ComputeTrack(figure_.rig.skeleton, track_, 1);
  EXPECT_EQ(many.ComputeTrack(figure_.rig.skeleton, track_, 3), expected);
  EXPECT_EQ(restored.ComputeTrack(figure_.rig.skeleton, track_, 2), expected);
  const SkinFeatures first = one.FirstRegions(figure_.rig, 5);
  EXPECT_EQ(first.num_features(), one.region_end(4));
  EXPECT_EQ(first.ComputeTrack(figure_.rig.skeleton, track_, 1),
            expected.leftCols(first.num_features()));
}

TEST_F(SkinFeaturesTest, TheCenterOnlyMakesTheProductMoreExact) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinFeatures features, Train());
  SkinFeaturesParameters p = features.parameters();
  p.center.resize(0);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinFeatures without,
                             SkinFeatures::FromParameters(figure_.rig, p));
  const Eigen::MatrixXd expected = features.ComputeTrack(figure_.rig.skeleton, track_, 1);
  const Eigen::MatrixXd found = without.ComputeTrack(figure_.rig.skeleton, track_, 1);
  EXPECT_LT((found - expected).norm(), 2e-3 * expected.norm());
}

TEST_F(SkinFeaturesTest, ARegionWithoutEdgesHasNoFeatures) {
  regions_[3].vertices.clear();
  regions_[3].weights.clear();
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinFeatures features, Train());
  EXPECT_EQ(features.region_begin(3), features.region_end(3));
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinFeatures restored,
                             SkinFeatures::FromParameters(figure_.rig, features.parameters()));
  EXPECT_EQ(restored.num_features(), features.num_features());
}

TEST_F(SkinFeaturesTest, ComputingDoesNotAllocate) {
  if (NumAllocations() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinFeatures features, Train());
  SkinFeatures::Workspace workspace;
  BoneTransforms transforms;
  ComputeBoneTransforms(figure_.rig.skeleton, track_.pose(3), {}, &transforms);
  Eigen::VectorXd row(features.num_features());
  features.Compute(transforms, &workspace, row);
  const long before = NumAllocations();
  features.Compute(transforms, &workspace, row);
  EXPECT_EQ(NumAllocations(), before);
}

TEST_F(SkinFeaturesTest, RefusesHostileParameters) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinFeatures features, Train());
  const auto refused = [&](auto change, const std::string& words) {
    SkinFeaturesParameters p = features.parameters();
    change(p);
    EXPECT_THAT(SkinFeatures::FromParameters(figure_.rig, p),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  refused([](auto& p) { p.regions[2].edges.back() = 1 << 20; }, "do not ascend");
  refused([](auto& p) { std::swap(p.regions[2].edges[0], p.regions[2].edges[1]); }, "ascend");
  refused([](auto& p) { p.regions[2].edges.pop_back(); }, "weights are");
  refused([](auto& p) { p.regions[2].offset.conservativeResize(1); }, "offsets");
  refused([](auto& p) { p.regions[2].offset[0] = std::nanf(""); }, "weights are");
  refused([](auto& p) { p.regions[2].weights.scales[0] = std::nanf(""); }, "not finite");
  refused([](auto& p) { p.center.conservativeResize(4); }, "the center has 4");
  refused([](auto& p) { p.center[1] = std::nanf(""); }, "not finite");
  refused([](auto& p) { p.edges.lengths[0] = -1; }, "edge 0");
}

}  // namespace
}  // namespace pleat
