#include "pleat/learner/regional_gp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pleat {
namespace {

// Two limbs with three features each; output 0 hangs on the first limb, output 1 on the second, and
// a little of both on their product. In training the limbs move together.
struct TwoLimbs {
  Eigen::MatrixXd inputs;
  std::vector<GpRegion> regions;
  Eigen::MatrixXd outputs;
};

TwoLimbs MakeTwoLimbs(int rows, double phase_between_limbs) {
  TwoLimbs data;
  data.inputs.resize(rows, 6);
  data.outputs.resize(rows, 2);
  for (int t = 0; t < rows; ++t) {
    const double first = .25 * t, second = .25 * t + phase_between_limbs;
    data.inputs.row(t) << std::sin(first), std::cos(first), .3 * std::sin(2 * first),
        std::sin(second), std::cos(second), .3 * std::sin(2 * second);
    data.outputs(t, 0) = std::sin(2 * first) + .5 * std::cos(first);
    data.outputs(t, 1) = std::cos(2 * second) - .5 * std::sin(second);
  }
  for (int limb = 0; limb < 2; ++limb) {
    GpRegion region{{{0, 1, 2, 3, 4, 5}, {3 * limb, 3 * limb + 1, 3 * limb + 2}}, data.outputs};
    region.outputs.col(1 - limb).setZero();
    data.regions.push_back(std::move(region));
  }
  return data;
}

double RmsError(const RegionalGp& gp, const TwoLimbs& data) {
  RegionalGp::Workspace workspace;
  Eigen::VectorXd mean(2);
  double squares = 0;
  for (Eigen::Index t = 0; t < data.inputs.rows(); ++t) {
    gp.Predict(data.inputs.row(t).transpose(), &workspace, mean);
    squares += (mean - data.outputs.row(t).transpose()).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(data.outputs.size()));
}

TEST(RegionalGpTest, ReproducesItsTrainingRows) {
  const TwoLimbs data = MakeTwoLimbs(60, 0);
  const absl::StatusOr<RegionalGp> gp = RegionalGp::Train(data.inputs, data.regions);
  ASSERT_TRUE(gp.ok()) << gp.status();
  EXPECT_LT(RmsError(*gp, data), .01);
}

TEST(RegionalGpTest, NearFeaturesCarryOverToNewCombinationsOfLimbs) {
  TwoLimbs data = MakeTwoLimbs(80, 0);
  // A second phase, so that the likelihood can tell which limb explains which output.
  const TwoLimbs other = MakeTwoLimbs(80, 1.3);
  data.inputs.conservativeResize(160, Eigen::NoChange);
  data.inputs.bottomRows(80) = other.inputs;
  for (int limb = 0; limb < 2; ++limb) {
    data.regions[limb].outputs.conservativeResize(160, Eigen::NoChange);
    data.regions[limb].outputs.bottomRows(80) = other.regions[limb].outputs;
  }
  const TwoLimbs unseen = MakeTwoLimbs(60, 3);
  const absl::StatusOr<RegionalGp> gp = RegionalGp::Train(data.inputs, data.regions);
  ASSERT_TRUE(gp.ok()) << gp.status();
  std::vector<GpRegion> only_all = data.regions;
  for (GpRegion& region : only_all) region.feature_sets.resize(1);
  const absl::StatusOr<RegionalGp> without = RegionalGp::Train(data.inputs, only_all);
  ASSERT_TRUE(without.ok()) << without.status();
  EXPECT_LT(RmsError(*gp, unseen), .05);
  EXPECT_LT(RmsError(*gp, unseen), .3 * RmsError(*without, unseen));
}

TEST(RegionalGpTest, SameBytesForAnyThreadCount) {
  const TwoLimbs data = MakeTwoLimbs(40, .5);
  RegionalGpOptions options;
  options.num_threads = 1;
  const absl::StatusOr<RegionalGp> one = RegionalGp::Train(data.inputs, data.regions, options);
  options.num_threads = 7;
  const absl::StatusOr<RegionalGp> seven = RegionalGp::Train(data.inputs, data.regions, options);
  ASSERT_TRUE(one.ok() && seven.ok());
  for (size_t r = 0; r < data.regions.size(); ++r) {
    EXPECT_EQ(one->parameters().regions[r].alpha, seven->parameters().regions[r].alpha);
  }
}

TEST(RegionalGpTest, FewerRowsThanGivenStillPredict) {
  const TwoLimbs data = MakeTwoLimbs(120, .5);
  RegionalGpOptions options;
  options.max_hyperparameter_rows = 30;
  options.max_rows = 60;
  const absl::StatusOr<RegionalGp> gp = RegionalGp::Train(data.inputs, data.regions, options);
  ASSERT_TRUE(gp.ok()) << gp.status();
  EXPECT_EQ(gp->parameters().inputs.rows(), 60);
  EXPECT_LT(RmsError(*gp, data), .05);
}

TEST(RegionalGpTest, RestoredFromItsParametersPredictsTheSame) {
  const TwoLimbs data = MakeTwoLimbs(40, .5);
  const absl::StatusOr<RegionalGp> gp = RegionalGp::Train(data.inputs, data.regions);
  ASSERT_TRUE(gp.ok());
  const absl::StatusOr<RegionalGp> restored = RegionalGp::FromParameters(gp->parameters());
  ASSERT_TRUE(restored.ok()) << restored.status();
  RegionalGp::Workspace workspace;
  Eigen::VectorXd a(2), b(2);
  gp->Predict(data.inputs.row(7).transpose(), &workspace, a);
  restored->Predict(data.inputs.row(7).transpose(), &workspace, b);
  EXPECT_EQ(a, b);
}

TEST(RegionalGpTest, ScalesOfTheInputsAreUnitsOnly) {
  // The same data with every input in another unit, and the scales that undo it.
  const TwoLimbs data = MakeTwoLimbs(40, .5);
  RegionalGpOptions options;
  options.input_scales = Eigen::VectorXd::LinSpaced(data.inputs.cols(), .5, 3);
  const Eigen::MatrixXd in_other_units = data.inputs * options.input_scales.asDiagonal();
  const absl::StatusOr<RegionalGp> plain = RegionalGp::Train(data.inputs, data.regions);
  const absl::StatusOr<RegionalGp> scaled =
      RegionalGp::Train(in_other_units, data.regions, options);
  ASSERT_TRUE(plain.ok() && scaled.ok());
  RegionalGp::Workspace workspace;
  Eigen::VectorXd a(2), b(2);
  for (const int row : {3, 20, 33}) {
    plain->Predict(data.inputs.row(row).transpose(), &workspace, a);
    scaled->Predict(in_other_units.row(row).transpose(), &workspace, b);
    EXPECT_LT((a - b).norm(), 1e-4);
  }
  options.input_scales[1] = 0;
  EXPECT_EQ(RegionalGp::Train(data.inputs, data.regions, options).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(RegionalGpTest, RefusesWhatDoesNotFitTogether) {
  TwoLimbs data = MakeTwoLimbs(20, .5);
  const absl::StatusOr<RegionalGp> gp = RegionalGp::Train(data.inputs, data.regions);
  ASSERT_TRUE(gp.ok());
  RegionalGpParameters p = gp->parameters();
  p.regions[1].scales[0].columns.back() = 6;
  EXPECT_EQ(RegionalGp::FromParameters(p).status().code(), absl::StatusCode::kInvalidArgument);
  p = gp->parameters();
  p.regions[0].alpha.conservativeResize(19, Eigen::NoChange);
  EXPECT_EQ(RegionalGp::FromParameters(p).status().code(), absl::StatusCode::kInvalidArgument);
  p = gp->parameters();
  p.regions[0].bias = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(RegionalGp::FromParameters(p).status().code(), absl::StatusCode::kInvalidArgument);
  data.regions[1].feature_sets[0] = {3, 2};
  EXPECT_EQ(RegionalGp::Train(data.inputs, data.regions).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(RegionalGpTest, CancellationStops) {
  const TwoLimbs data = MakeTwoLimbs(60, 0);
  const Progress cancelled(nullptr, [] { return true; });
  EXPECT_EQ(RegionalGp::Train(data.inputs, data.regions, {}, cancelled).status().code(),
            absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace pleat
